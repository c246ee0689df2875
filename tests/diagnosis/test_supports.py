"""Virtual sensors at the supports, against the contact forces of the independent code."""

import csv

import numpy as np
import pytest

import vibroimpact as vi
from tests.support.contact_truth import contact_campaign
from vibroimpact.cli import main
from vibroimpact.diagnosis.explanations import Point, Structure
from vibroimpact.diagnosis.measurement.signals import signals_of
from vibroimpact.diagnosis.measurement.stretches import stretches_of
from vibroimpact.diagnosis.whole_records import Holder
from vibroimpact.integration.held_run import HeldLane, hold

RISING = ((0.5, 1.3, "fit"), (4.0, 1.3, "fit"), (12.0, 1.3, "fit"), (35.0, 1.3, "fit"))
SIDES = ("left", "right")
Y_ALONE = ("apex_y", "bend45_right_y", "left_leg_upper_y", "right_leg_upper_y")


@pytest.fixture(scope="module")
def found(measured):
    """The VirtualSupports of that campaign, with forces."""
    path, model, _ = measured
    return vi.virtual_supports(vi.read_campaign(path), vi.load_config(model), with_forces=True)


def named(found, record, support, channel=""):
    """{quantity: SupportValue} of a support in the record of a number."""
    records = list(dict.fromkeys(row.record for row in found.values))
    return {
        row.quantity: row
        for row in found.values
        if (row.record, row.support, row.channel) == (records[record], support, channel)
    }


def correlation(one, other):
    """The correlation of two series about zero."""
    return np.sum(one * other) / np.sqrt(np.sum(one**2) * np.sum(other**2))


@pytest.mark.parametrize("side", [0, 1], ids=SIDES)
def test_contact_forces_follow_those_of_the_other_code(measured, found, side):
    truth, forces = measured[2], found.forces[1]
    first = round(forces.first_s * truth.rate)
    virtual = forces.force[side]
    true = truth.measured[1, 2 * side : 2 * side + 2, first : first + virtual.shape[-1]]
    assert correlation(virtual, true) > 0.985
    assert np.sqrt(np.mean(virtual**2) / np.mean(true**2)) == pytest.approx(1.0, abs=0.05)
    assert np.quantile(np.hypot(*virtual), 0.999) == pytest.approx(
        np.quantile(np.hypot(*true), 0.999), rel=0.05
    )


@pytest.mark.parametrize("side", [0, 1], ids=SIDES)
def test_statistics_are_those_of_the_other_code(measured, found, side):
    forces = found.forces[1]
    last = forces.first_s + forces.force.shape[-1] / forces.sampling_frequency
    truth = measured[2].of(1, side, forces.first_s, last)
    rows = named(found, 1, SIDES[side])
    for quantity, within in (
        ("rms_force", 0.05),
        ("contact_fraction", 0.05),
        ("impact_rate", 0.06),
        ("wear_work_rate", 0.08),
        ("peak_force", 0.12),
    ):
        assert rows[quantity].value == pytest.approx(truth[quantity], rel=within), quantity
    assert rows["agreement"].value > 0.98
    assert {row.remark for row in rows.values()} == {""}


def test_below_contact_there_is_no_force(found):
    rows = named(found, 0, "left")
    for quantity in ("rms_force", "peak_force", "contact_fraction", "secant_stiffness_y"):
        assert rows[quantity].value == 0.0


def test_intervals_hold_the_value_and_are_not_empty(found):
    for row in named(found, 1, "left").values():
        if row.quantity not in ("peak_force", "agreement"):
            assert row.low < row.value < row.high


def test_secant_values_are_those_of_the_force_and_motion(measured, found):
    truth, forces = measured[2], found.forces[1]
    rate = truth.force.shape[-1] / (truth.measured.shape[-1] / truth.rate)
    last = forces.first_s + forces.force.shape[-1] / forces.sampling_frequency
    part = slice(int(forces.first_s * rate), int(last * rate))
    force, motion = truth.force[1, 0, 1, part], truth.motion[1, 0, 1, part]
    stiffness = -np.sum(force * motion) / np.sum(motion**2)
    # Two codes: 4 to 5 % apart, with the arithmetic of the processor.
    assert named(found, 1, "left")["secant_stiffness_y"].value == pytest.approx(stiffness, rel=0.08)


def test_measured_contact_forces_stand_beside_and_change_nothing(measured, found):
    path, model, _ = measured
    beside = named(found, 1, "left", "plate_left_y")
    assert beside["rms_force"].value == pytest.approx(beside["rms_force"].measured, rel=0.06)
    assert beside["correlation"].value > 0.95
    campaign = vi.read_campaign(path)
    without = campaign.isel(channel=np.flatnonzero(campaign.channel_kind != "contact_force"))
    alone = vi.virtual_supports(without, vi.load_config(model))
    assert [row.value for row in alone.values] == [
        row.value for row in found.values if not row.channel
    ]


def test_a_contact_force_at_no_support_is_told(measured):
    path, model, _ = measured
    campaign = vi.read_campaign(path).isel(record=[0])
    place = campaign.channel_point.values.copy()
    place[campaign.channel_kind == "contact_force"] = (0.0, 0.0, 1.0)
    moved = campaign.assign(channel_point=campaign.channel_point.copy(data=place))
    found = vi.virtual_supports(moved, vi.load_config(model))
    assert any("at no support of the model" in note for note in found.notes)


def test_a_direction_that_no_sensor_sees_is_named(measured):
    path, model, _ = measured
    campaign = vi.read_campaign(path).isel(record=[1])
    chosen = np.flatnonzero(np.isin(campaign.channel_name.values, Y_ALONE))
    found = vi.virtual_supports(campaign.isel(channel=chosen), vi.load_config(model))
    rows = named(found, 0, "left")
    for quantity in ("wear_work_rate", "secant_stiffness_x"):
        assert rows[quantity].remark == "no sensor sees the motion along x"
    assert rows["rms_force"].remark == ""


def test_forces_that_depend_on_the_strength_are_not_trusted(measured):
    # two sensors at the apex: the true correlation is 0.7 to 0.8
    path, model, _ = measured
    campaign = vi.read_campaign(path).isel(record=[1], channel=[0, 1])
    found = vi.virtual_supports(campaign, vi.load_config(model))
    rows = named(found, 0, "left")
    assert rows["agreement"].value < 0.9
    assert rows["rms_force"].remark.startswith("not held: forces under two strengths agree to 0.")


def test_a_model_without_supports_is_refused(measured):
    path, model, _ = measured
    config = vi.load_config(model).model_copy(update={"supports": ()})
    with pytest.raises(vi.CampaignError, match="the model has no supports.*give `supports`"):
        vi.virtual_supports(vi.read_campaign(path), config)


def test_a_campaign_of_contact_forces_alone_is_refused(measured):
    path, model, _ = measured
    campaign = vi.read_campaign(path)
    alone = campaign.isel(channel=np.flatnonzero(campaign.channel_kind == "contact_force"))
    with pytest.raises(vi.CampaignError, match="no channel is left that measures a motion"):
        vi.virtual_supports(alone, vi.load_config(model))


def test_a_record_that_is_too_short_is_refused(measured):
    path, model, _ = measured
    campaign = vi.read_campaign(path).isel(time=slice(0, 600))
    with pytest.raises(vi.CampaignError, match="is too short: its stretches have .* give longer"):
        vi.virtual_supports(campaign, vi.load_config(model))


def test_a_missing_gap_is_refused(measured):
    path, model, _ = measured
    campaign = vi.read_campaign(path)
    campaign["gap"] = campaign["gap"] * [1.0, np.nan]
    with pytest.raises(vi.CampaignError, match=r"gap\[1\] .* is missing: give the radial gap"):
        vi.virtual_supports(campaign, vi.load_config(model))


def test_the_command_prints_and_writes_the_table(measured, found, tmp_path, capsys):
    path, model, _ = measured
    table = tmp_path / "supports.csv"
    assert main(["supports", str(path), "--model", str(model), "--csv", str(table)]) == 0
    output, errors = capsys.readouterr()
    assert "Record L12_G1.3_1: 12 N RMS, gap 0.2889 mm" in output
    row = named(found, 1, "left")["rms_force"]
    assert "contact force, RMS" in output and f"{row.value:.4g} N" in output
    assert "mostly noise" in errors  # across the force below contact
    with open(table, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["value"]) for row in rows] == pytest.approx(
        [row.value for row in found.values], nan_ok=True
    )


@pytest.mark.parametrize(
    "arguments, said",
    [
        (["no.nc", "--model", "{model}"], "no.nc: The file is no file"),
        (["{path}", "--model", "no.yaml"], "no.yaml: cannot be read"),
        (["{path}"], "there is no config/study.yaml here: name the model with --model"),
    ],
)
def test_the_command_says_what_is_missing(measured, tmp_path, monkeypatch, capsys, arguments, said):
    path, model, _ = measured
    monkeypatch.chdir(tmp_path)
    given = [argument.format(path=path, model=model) for argument in arguments]
    assert main(["supports", *given]) == 1
    assert said in capsys.readouterr().err


def assert_told(found, truth, record, close):
    """In a record both supports have the forces and values of the other code, within `close`
    {quantity: relative}; "correlation" is the least of the forces.
    """
    forces = found.forces[record]
    first, count = round(forces.first_s * truth.rate), forces.force.shape[-1]
    last = forces.first_s + count / forces.sampling_frequency
    for side, name in enumerate(SIDES):
        true = truth.measured[record, 2 * side : 2 * side + 2, first : first + count]
        assert correlation(forces.force[side], true) > close["correlation"]
        rows, values = named(found, record, name), truth.of(record, side, forces.first_s, last)
        for quantity in close.keys() - {"correlation"}:
            assert rows[quantity].value == pytest.approx(values[quantity], rel=close[quantity])


@pytest.mark.slow
@pytest.mark.parametrize("channels", [range(7), [3, 4, 5]], ids=["seven", "three"])
def test_a_calibrated_model_tells_forces_to_three_percent(tmp_path, channels):
    path, model, truth = contact_campaign(tmp_path, seed=(20,), levels=RISING, duration=10.0)
    campaign = vi.read_campaign(path).isel(channel=list(channels))
    found = vi.virtual_supports(campaign, vi.load_config(model), calibrate=True, with_forces=True)
    close = {"correlation": 0.97, "rms_force": 0.03, "contact_fraction": 0.05}
    assert_told(found, truth, 1, close)  # the motion across is in the noise
    for record in (2, 3):
        assert_told(found, truth, record, close | {"wear_work_rate": 0.06})


@pytest.mark.slow
@pytest.mark.parametrize("seed", [11, 12])
@pytest.mark.parametrize("load", [4.0, 35.0])
def test_other_structures_and_loads_are_told_too(tmp_path, seed, load):
    levels = ((load, 1.3, "fit"), (0.5, 1.3, "fit"))
    path, model, truth = contact_campaign(tmp_path, seed=(seed,), levels=levels, duration=10.0)
    found = vi.virtual_supports(vi.read_campaign(path), vi.load_config(model), with_forces=True)
    assert_told(found, truth, 0, {"correlation": 0.98, "rms_force": 0.07, "contact_fraction": 0.07})


def test_modes_above_the_highest_frequency_are_not_held(measured):
    path, model, _ = measured
    campaign = vi.read_campaign(path).isel(record=[1], channel=slice(0, 7))
    structure = Structure(vi.load_config(model), campaign)
    holding = Holder(structure, signals_of(campaign), Point())
    schedule = holding.rates.schedule(0.5, "exact")
    (stretch,) = stretches_of(
        holding.signals, [(0, 1.0)], 0.5, holding.band, holding.rates, structure.scale
    )

    def forces(strength, highest_Hz):
        lane = HeldLane(
            holding.model, stretch.gap, stretch.force, stretch.motion, np.full(7, strength)
        )
        return hold([lane], schedule, highest_Hz=highest_Hz).support_force

    free = forces(0.0, np.inf)
    np.testing.assert_array_equal(forces(100.0, 1.0), free)  # there is no mode below 1 Hz
    assert not np.array_equal(forces(100.0, 800.0), free)
    assert not np.array_equal(forces(100.0, 800.0), forces(100.0, np.inf))
