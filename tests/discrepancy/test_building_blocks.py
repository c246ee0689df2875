"""Features, their scatter, misfits, names and draws, each against a number from elsewhere."""

import numpy as np
import pytest

from vibroimpact.discrepancy.covariance import shrunk
from vibroimpact.discrepancy.discrepancy_map import clusters
from vibroimpact.discrepancy.misfit import closed_fraction, excess, floor_of
from vibroimpact.discrepancy.next_measurement import next_measurement
from vibroimpact.linear_stage.candidates import PLACES, Candidate, Pair, candidate_named, spread
from vibroimpact.linear_stage.linear_analysis import read_s
from vibroimpact.linear_stage.nuisance import plausible
from vibroimpact.linear_stage.workbench import Workbench
from vibroimpact.observation.features import (
    COARSE,
    FeatureLayout,
    compressed,
    record_features,
)

RATE = 2048.0


def layout(channels=1, pairs=()):
    """A FeatureLayout of 24 bands from 5 to 200 Hz."""
    rows = [("power", c, b) for c in range(channels) for b in range(24)] + [
        ("coherence", c, b) for c in range(channels) for b in range(COARSE)
    ]
    rows += [(kind, a, b) for kind in ("co", "quad") for a, _ in pairs for b in range(COARSE)]
    rows += [(kind, c, -1) for kind in ("skewness", "kurtosis") for c in range(channels)]
    kind, channel, band = map(np.array, zip(*rows, strict=True))
    return FeatureLayout(
        RATE,
        np.geomspace(5.0, 200.0, 25),
        np.geomspace(5.0, 200.0, COARSE + 1),
        list(pairs),
        kind,
        channel,
        band,
    )


def test_band_power_of_white_noise_is_density_times_width():
    force, response = np.random.default_rng(1).standard_normal((2, 60 * 2048))
    found = layout().power(record_features(layout(), force, response[None]))[0]
    expected = 10.0 * np.log10(2.0 / RATE * np.diff(layout().edges))
    assert np.abs(found - expected)[12:].max() < 0.7
    assert abs(np.mean(10 ** (found / 10)) / np.mean(10 ** (expected / 10)) - 1.0) < 0.03


def test_coherence_is_one_for_the_force_zero_for_noise():
    force, other = np.random.default_rng(2).standard_normal((2, 60 * 2048))
    features = record_features(layout(2), force, np.stack([3.0 * force, other]))
    coherence = np.tanh(features[layout(2).kind == "coherence"]).reshape(2, -1)
    assert coherence[0].min() > 0.99 and coherence[1].max() < 0.45


def test_the_sense_of_two_directions_is_seen():
    x = np.random.default_rng(3).standard_normal(40 * 2048)
    chosen = layout(2, [(0, 1)])
    same, against = (
        record_features(chosen, x, np.stack([x, sign * x]))[chosen.kind == "co"]
        for sign in (1.0, -1.0)
    )
    np.testing.assert_allclose(same, -against)
    assert same.min() > 3.0


def test_compression_is_an_asinh_and_linear_near_zero():
    values, blend = np.linspace(-60.0, 60.0, layout().kind.size), layout().blend
    drawn_in = compressed(values, layout())
    np.testing.assert_allclose(blend * np.sinh(drawn_in / blend), values, atol=1e-9)
    assert np.abs(compressed(0.01 * np.ones(layout().kind.size), layout()) - 0.01).max() < 1e-6


def test_shrunk_covariance_keeps_variances_and_can_be_inverted():
    chosen = layout()
    draws = np.random.default_rng(4).standard_normal((12, chosen.kind.size)) * np.linspace(
        0.1, 1.0, chosen.kind.size
    )
    rows = draws - draws.mean(axis=0)
    covariance = shrunk(rows, 11)
    assert np.linalg.eigvalsh(covariance).min() > 0.0
    np.testing.assert_allclose(np.diag(covariance), np.sum(rows**2, axis=0) / 11.0)


def test_neutral_point_is_known_if_in_range():
    scales = {"gap": 2.0e-4, "one": 1.0}
    offset, friction = Candidate("support_offset", "all"), Candidate("dry_friction", "all")
    np.testing.assert_allclose(
        offset.physical(offset.neutral_unit(scales), scales)["offset_x"], 0.0, atol=1e-12
    )
    assert np.isnan(friction.neutral_unit(scales)).all()


def test_closed_fraction_is_that_of_the_excess():
    assert excess(5.0, 3.0) == pytest.approx(4.0)
    assert closed_fraction(5.0, np.hypot(3.0, 1.0), 3.0) == pytest.approx(0.75)
    assert closed_fraction(3.1, 3.0, 3.0) is None
    # a model whose own runs differ by as much says nothing of what is added
    assert closed_fraction(2.23, 2.25, 1.52, 2.13) is None
    assert closed_fraction(5.0, np.hypot(3.0, 1.0), 3.0, 4.0) == pytest.approx(1.0 - 1.0 / 3.0)


def test_floor_of_independent_seeds_is_root_two_of_their_scatter():
    power = np.random.default_rng(5).standard_normal((2, 8, 3, 24))
    assert floor_of(power, np.ones((2, 3, 24), bool)) == pytest.approx(np.sqrt(2.0), rel=0.1)


def test_names_of_candidates_come_back():
    for name in ("gap@all", "gap@left+dry_friction@all"):
        assert candidate_named(name).name == name
    pair = Pair(Candidate("gap", "all"), Candidate("foliate_obstacle", "all"))
    assert pair.split == 1 and pair.periodic == (2,) and len(pair.effect.parameters) == 3


def test_exact_alias_comes_with_a_measurement_to_break_it():
    assert "clearance" in next_measurement([["gap"], ["sensor_gain"]])
    assert next_measurement([["gap"]]) is None


def test_draws_share_no_seed():
    class Bench:
        draw = 0
        signals = type("Signals", (), {"gap": [1e-4, 2e-4]})

    seeds = []
    for draw in (0, 1, 2):
        Bench.draw = draw
        seeds.append(
            {
                seed
                for first in (0, 900, 20000)
                for _, _, seed in Workbench.runs(Bench, [0, 1], 16, first)
            }
        )
    assert seeds[0] & set(range(16)) and not seeds[0] & seeds[1] and not seeds[1] & seeds[2]


def test_clusters_end_at_half_the_peak_difference():
    difference = np.array([0.5, 6.0, 10.0, 7.0, 3.0, 3.5, -4.0, 0.2])
    found = clusters(difference, np.abs(difference) > 0.3)
    assert [row.tolist() for row in found] == [[1, 2, 3], [6], [4, 5], [0]]


def test_closed_fraction_without_bands_is_undefined():
    assert closed_fraction(0.0, 0.0, 0.0) is None


def test_estimate_allows_for_a_common_gain():
    """Lengths and forces are known no better than such a gain: 2 %, one sigma; a friction
    coefficient is.
    """
    gap, friction = candidate_named("gap@all"), candidate_named("dry_friction@all")
    unit = np.array([0.5])
    value, low, high = gap.estimate(unit, np.array([[0.5, 0.5]]), {"one": 1.0})["gap_factor"]
    assert (value / low, high / value) == pytest.approx(
        (1.0 / (1.0 - 1.645 * 0.02), 1.0 + 1.645 * 0.02)
    )
    mu, narrow, _ = friction.estimate(unit, np.array([[0.49, 0.51]]), {"one": 1.0})["mu"]
    assert narrow == pytest.approx(friction.physical([0.49], {"one": 1.0})["mu"]) and narrow < mu


def test_nonlinear_record_pulls_many_nuisances():
    """A faulty gain pulls one far; what bends the record pulls many."""
    faulty_gain = np.append(np.tile([1.4, -1.7, 0.6, 0.2, 1.8, 0.1, 0.4], 2), -70.8)
    bent = np.array([2.9, 1.6, 1.0, -0.3, 2.6, -1.6, 1.6, 0.9, 3.3, 0.0, -0.3, 0.4, 0.0, -1.1])
    assert plausible(faulty_gain)
    assert not plausible(bent)


def test_screened_places_are_spread_over_the_tube():
    chosen = spread([f"place_{number}" for number in range(25)])
    assert len(chosen) == PLACES and chosen[0] == "place_0" and chosen[-1] == "place_24"
    assert spread(["a", "b"]) == ["a", "b"]


@pytest.mark.parametrize(
    ("records", "duration", "expected"),
    [(4, 49.0, 24.0), (8, 49.0, 24.0), (9, 49.0, 12.0), (40, 49.0, 12.0), (4, 8.0, 8.0)],
)
def test_seconds_that_are_read_follow_the_batch(records, duration, expected):
    assert read_s(records, duration) == expected
