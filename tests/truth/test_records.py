"""Records of the truth generator: channels of any kind, starts, more supports than two, drifts, and
the search for an amount.
"""

import numpy as np
import pytest

from evidence.truth.campaign import Plan, forces, judged_levels, simulate_records
from evidence.truth.geometry import Holder, Straight
from evidence.truth.reduction import reduce_rig
from evidence.truth.rig import Rig
from evidence.truth.scene import sizes
from evidence.truth.strength import strength_by_channel
from evidence.truth.tune import WIDE, amount_for

Y = (0.0, 1.0, 0.0)
KINDS = ("displacement", "velocity", "acceleration")
PLATES = {
    name: Holder(name, at, 0.02, 1.0e6, 3) for name, at in (("a", 0.5), ("b", 1.0), ("c", 1.6))
}


def beam(names="abc", axis="x"):
    """A straight tube through plates, in the order of their names."""
    return Straight(
        outer_diameter=0.016,
        wall=0.0012,
        length=2.1,
        axis=axis,
        holders=tuple(PLATES[name] for name in names),
        drive=0.8,
    )


def run(tube, **plan):
    """(channel, time) of half a second of a tube at 3 N."""
    common = {"levels": ((3.0, 1.0, "fit"),), "duration": 0.5, "steps_per_second": 81920}
    channels = tuple((at, Y, kind) for at in (0.83, 1.31) for kind in KINDS)
    plan = Plan((1,), tube=tube, **(common | {"channels": channels} | plan))
    return simulate_records(plan, forces(plan))


def test_kinds_of_channels_are_derivatives_of_each_other():
    found, _ = run(beam(), levels=((0.02, 1.0, "fit"),), sampling=8192.0)
    displacement, velocity, acceleration = found[0][:3]
    middle = slice(200, -200)
    for lower, higher in ((displacement, velocity), (velocity, acceleration)):
        slope = np.gradient(lower, 1.0 / 8192.0)[middle]
        np.testing.assert_allclose(slope, higher[middle], atol=0.03 * np.abs(higher).max())


def test_order_of_three_supports_does_not_matter():
    one, touched = run(beam("abc"))
    other, _ = run(beam("cab"))
    assert (touched > 0.0).sum() >= 2
    early = slice(0, 400)  # before round-off is amplified by the impacts
    np.testing.assert_allclose(
        other[0][:, early], one[0][:, early], atol=1e-6 * np.abs(one[0][0]).max()
    )


def test_a_tube_along_x_moves_as_one_along_z():
    # before round-off is amplified by the impacts
    one, other = (run(beam(axis=axis))[0][0][:, :80] for axis in ("x", "z"))
    for row in range(6):
        np.testing.assert_allclose(other[row], one[row], atol=1e-3 * np.abs(one[row]).max())


def test_a_stationary_record_begins_in_motion():
    """Below contact: impacts scatter more than the beginning differs from the rest."""
    linear = {"duration": 1.0, "levels": ((0.02, 1.0, "fit"),)}
    rest, moving = (
        run(beam(), start_up=start, **linear)[0][0][2] for start in ("rest", "stationary")
    )
    assert np.std(rest[:100]) < 0.3 * np.std(rest[500:])
    assert np.std(moving[:100]) > 0.7 * np.std(moving[500:])


def test_frequencies_drift_with_the_time_of_the_campaign():
    rig = Rig.bare(beam())
    rig.frequency_drift = 1.0e-3
    reduced = reduce_rig(rig, [("drive", Y)], highest=2000.0)
    step, first = 1.0e-5, int(np.argmin(np.where(reduced.real, reduced.omega2, np.inf)))
    for elapsed in (0.0, 40.0):
        cosine = reduced.propagator(step, elapsed)[[0, 3], first].mean()
        decay = np.exp(-0.5 * reduced.rate[first] * (1.0 + 1.0e-3 * elapsed) * step)
        turned = np.arccos(cosine / decay) / step
        expected = np.sqrt(reduced.omega2[first]) * (1.0 + 1.0e-3 * elapsed)
        assert turned == pytest.approx(expected, rel=1e-3)


def test_a_drift_of_nothing_is_integrated_as_none():
    plain, drifting = (
        run(beam(), effects=effects)[0][0][:, :400]
        for effects in ((), (("frequency_drift", {"rate": 1.0e-15}),))
    )
    np.testing.assert_allclose(drifting, plain, atol=1e-6 * np.abs(plain).max())


def test_motion_per_newton_is_that_of_a_long_linear_record():
    tube, band = beam(), (10.0, 150.0)
    expected = sizes(tube, band, Y).motion
    channels = tuple((holder.arc, Y, "displacement") for holder in tube.holders)
    found, touched = run(
        tube,
        channels=channels,
        levels=((0.01, 1.0, "fit"),),
        band=band,
        duration=20.0,
        start_up="stationary",
        frequency_scatter=0.0,
        damping_scatter=0.0,
    )
    assert touched.max() == 0.0
    assert found[0].std(axis=1).max() / 0.01 == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0])
def test_amount_is_found_whatever_its_power(power):
    found = amount_for(4.0, lambda amount: 60.0 * amount**power)
    assert 4.0 / WIDE**2 < 60.0 * found**power < 4.0 * WIDE**2


def test_a_rig_that_breaks_gets_less():
    assert amount_for(4.0, lambda amount: np.inf if amount > 0.3 else 4.0) == 0.25


def test_a_silenced_channel_counts():
    # a channel that only the bare rig moves: 40 dB above what is audible, then below it
    bare = np.full((3, 1, 1, 24), 1.0e4)
    silent = np.full((1, 1, 24), 0.25)
    strength = strength_by_channel(silent, bare, bare, np.ones((1, 24)))
    assert strength == pytest.approx(46.02 / 0.5, rel=1e-3)  # in floors of half a dB


def test_strength_is_judged_on_held_out_records():
    levels = ((1.0, 1.0, "fit"), (9.0, 1.0, "fit"), (5.0, 1.0, "holdout"), (3.0, 1.0, "holdout"))
    assert judged_levels(Plan((1,), levels=levels)) == [3, 2]
    assert judged_levels(Plan((1,), levels=levels[:2])) == [1]


def test_one_channel_of_chance_does_not_hide_the_others():
    # powers of three starts in two channels: one repeats and has doubled, one scatters by a decade
    rng = np.random.default_rng(5)
    bare = np.ones((3, 1, 2, 24))
    bare[:, :, 1] = 10.0 ** rng.normal(0.0, 1.0, (3, 1, 1))
    seen = np.array([[np.full(24, 2.0), np.full(24, bare[0, 0, 1, 0])]])
    strength = strength_by_channel(seen, bare, bare, np.zeros((2, 24)))
    assert strength == pytest.approx(6.02 / np.sqrt(2.0), rel=0.1)
