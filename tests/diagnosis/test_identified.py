"""A user's campaign of two masses without a model: named, none, or not testable, never a wrong
name.
"""

import functools
import json
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
import yaml
from scipy import linalg

from docs.examples import two_masses as example
from tests.support import two_masses
from vibroimpact import diagnose
from vibroimpact.campaign.file import write_campaign
from vibroimpact.campaign.importing.assemble import import_folder
from vibroimpact.cli import main
from vibroimpact.config.measured_structure import MeasuredStructure
from vibroimpact.config.reading import ConfigError, check_config
from vibroimpact.diagnosis.diagnose import run_diagnosis
from vibroimpact.diagnosis.identified.identified import identified
from vibroimpact.diagnosis.identified.levels import long_record_lines
from vibroimpact.diagnosis.identified.records import unsettled_periods
from vibroimpact.diagnosis.identified.trial import Trial
from vibroimpact.diagnosis.verdict.content import read_verdict
from vibroimpact.io.records import read_record, read_table
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.reports.figures.diagnosis.sheets import diagnosis_figures
from vibroimpact.reports.figures.drawing import drawn

FEW = ("cubic_stiffness", "clearance", "single_friction", "saturation_stiffness", "quadratic_drag")
STATED = MeasuredStructure(
    kind="identified", candidates=[f"{law}.upper-lower" for law in FEW], additions=[]
)


@functools.cache
def campaign_of(law, periodic=True):
    return two_masses.campaign(law, periodic, 4 if periodic else 8)


@functools.cache
def judged(law, periodic=True):
    """The Diagnosis of a law, with the laws of FEW at the joint."""
    return run_diagnosis(campaign_of(law, periodic), STATED)


def linear(turned=False):
    """A campaign without a law at the joint, free to be changed; turned: the sensor at the drive
    counts against the force.
    """
    campaign = campaign_of("nothing").copy(deep=True)
    if turned:
        campaign["response"].values[:, 0] *= -1.0
        campaign["channel_direction"].values[0] *= -1.0
    return campaign


def masses():
    """(frequency (mode,), shapes (mode, channel)) of the two masses by hand."""
    ground, joint = two_masses.GROUND[0], two_masses.JOINT[0]
    stiffness = np.array([[ground + joint, -joint], [-joint, joint]])
    squares, shapes = linalg.eigh(stiffness, np.diag(two_masses.MASS))
    return np.sqrt(squares) / (2.0 * np.pi), shapes.T * np.sign(shapes[0])[:, None]


@pytest.mark.parametrize("periodic", [True, False])
def test_modes_from_periodic_and_random_records(periodic):
    own, _ = identified(campaign_of("nothing", periodic), MeasuredStructure(kind="identified"))
    frequency, shapes = masses()
    base, (low, high) = own.linear.base, own.everything.band_Hz
    assert base.names[base.drive] == "upper" and not base.residual.any()
    assert base.frequency == pytest.approx(frequency, rel=3.0e-3)
    assert base.shapes == pytest.approx(shapes, abs=0.03)
    assert low == pytest.approx(3.0, abs=0.2) and 25.0 < high < 46.0


def test_cubic_spring_is_named_and_located():
    found = judged("cubic")
    verdict = found.verdict
    assert next(iter(found.grounds.own.ranking)) == "upper-lower"
    assert (verdict.verdict, verdict.ambiguity_set) == ("named", [["cubic_stiffness"]])
    effect = verdict.effects[0]
    assert effect.location == "upper-lower: between upper and lower"
    value = effect.parameters["cubic_stiffness"]
    assert value.value == pytest.approx(two_masses.CUBIC, rel=0.05) and value.low < value.high
    held = [
        row
        for row in found.grounds.own.prediction(found.grounds.chosen)
        if row["split"] == "holdout"
    ]
    assert len(held) == 2
    assert all(row["error_completed"] < 0.1 < row["error_linear"] for row in held)
    assert verdict.misfit.holdout.closed_fraction > 0.7


def test_completed_model_runs():
    config = check_config(yaml.safe_load(judged("cubic").completed), "updated")
    assert build_model(config).sensor_names == ("upper.x", "lower.x")


def test_linear_structure_gets_verdict_none():
    verdict = judged("nothing").verdict
    assert (verdict.verdict, verdict.effects, verdict.regions) == ("none", [], [])


@pytest.mark.slow
def test_bouc_wen_hysteresis_is_at_most_called_friction():
    verdict = judged("bouc_wen").verdict
    assert verdict.verdict in ("named", "partly_explained", "ambiguous", "unknown")
    named = {each for ids in verdict.ambiguity_set for each in ids}
    assert named <= {"coulomb_friction", "saturation_stiffness"}


@pytest.mark.slow
def test_cubic_spring_is_found_in_random_records():
    verdict = judged("cubic", periodic=False).verdict
    assert verdict.verdict in ("named", "partly_explained")
    assert verdict.effects[0].id == "cubic_stiffness"
    value = verdict.effects[0].parameters["cubic_stiffness"].value
    assert value == pytest.approx(two_masses.CUBIC, rel=0.1)


def test_stated_places_hold_for_sensors_as_recorded():
    """With a turned sensor a sum of channels is the joint; a place to the ground keeps its sign,
    also in the completed model.
    """
    stated = MeasuredStructure(
        kind="identified",
        places={"joint": {"upper": 1.0, "lower": 1.0}, "upper": {"upper": 1.0}},
        candidates=["cubic_stiffness.joint", "cubic_stiffness.upper"],
        additions=[],
    )
    own, _ = identified(linear(turned=True), stated)
    assert own.places == {"joint": {"upper": -1.0, "lower": 1.0}, "upper": {"upper": -1.0}}
    terms = tuple(replace(term, values=np.ones(1)) for term in own.candidates)
    assert [term.location for term in terms] == [
        "joint: between upper and lower",
        "upper: at upper, to the ground",
    ]
    trial = Trial(own.linear.base, terms)
    model = build_model(check_config(yaml.safe_load(own.model_text(trial, "two")), "updated"))
    assert model.element_shapes == pytest.approx(trial.along)
    assert model.sensor_shapes == pytest.approx(trial.modes.shapes)


def test_sensor_opposite_to_the_force_is_reversed():
    own, _ = identified(linear(turned=True), STATED)
    assert own.linear.base.frequency == pytest.approx(masses()[0], rel=3.0e-3)
    assert own.campaign["channel_direction"].values[0].tolist() == [0.0, 0.0, 1.0]


@pytest.mark.parametrize(("kind", "unit"), [("acceleration", "m s-2"), ("velocity", "m s-1")])
def test_a_mean_without_static_response_is_refused(kind, unit):
    campaign = linear()
    for name, value in (("channel_kind", kind), ("channel_units", unit)):
        campaign[name].values[0] = value
    stated = MeasuredStructure(kind="identified", mean=True)
    with pytest.raises(ConfigError, match=f"structure.mean = true .* 'upper' is '{kind}'"):
        diagnose(campaign, stated)


def test_no_law_is_tried_where_no_mode_moves():
    campaign = linear()
    twin = campaign.isel(channel=[1]).assign(channel_name=("channel", np.array(["twin"], object)))
    both = xr.concat([campaign, twin], "channel", data_vars="minimal")
    stated = MeasuredStructure(
        kind="identified",
        places={"joint": {"upper": -1.0, "lower": 1.0}, "still": {"lower": -1.0, "twin": 1.0}},
        candidates=["cubic_stiffness.joint", "cubic_stiffness.still"],
        additions=[f"quadratic_stiffness.{place}" for place in ("joint", "still", "elsewhere")],
    )
    setting = identified(both, stated)[0]
    assert list(setting.ranking) == ["joint"]
    assert [term.place for term in setting.candidates] == ["joint"]
    assert [term.place for term in setting.additions] == ["joint", "elsewhere"]


def refusal(campaign):
    """The sentences with which a campaign is refused."""
    verdict = diagnose(campaign, "identified")
    assert verdict.verdict == "not_testable"
    return " ".join(row.message for row in verdict.checks if row.level == "refuse")


def test_two_levels_are_not_testable():
    assert "record a third level" in refusal(linear().isel(record=[0, 2]))


def test_response_unrelated_to_the_force_is_refused():
    campaign = linear()
    random = np.random.default_rng(3).standard_normal(campaign["response"].shape)
    assert refusal(campaign.assign(response=campaign["response"].copy(data=random)))


def test_transient_periods_are_counted():
    steady = np.random.default_rng(1).standard_normal((2, 500))
    signal = np.tile(steady, 6) + 1.0e-3 * np.random.default_rng(2).standard_normal((2, 3000))
    signal[:, :900] += 5.0 * np.exp(-np.arange(900) / 100.0)
    noise = 0.01 * np.random.default_rng(4).standard_normal((2, 2000))
    assert unsettled_periods(signal, 500) == 2
    assert unsettled_periods(np.tile(steady, 4) + noise, 500) == 0


def test_transient_is_removed_from_a_random_record():
    rate, count = 100.0, 4096
    force = np.random.default_rng(8).standard_normal(2 * count)
    lines = 2j * np.pi * np.fft.rfftfreq(2 * count, 1.0 / rate)
    receptance = 1.0 / (lines**2 + 2.0 * 0.02 * 60.0 * lines + 60.0**2)
    answer = np.fft.irfft(np.fft.rfft(force) * receptance, 2 * count)
    level = long_record_lines("one", "fit", force[-count:], answer[None, -count:], rate)
    kept = (level.frequency > 5.0) & (level.frequency < 20.0)
    laplace = 2j * np.pi * level.frequency[kept]
    wanted = level.force[kept] / (laplace**2 + 2.0 * 0.02 * 60.0 * laplace + 60.0**2)
    plain_lines = np.fft.rfft(answer[-count:])[kept] / count
    missed, before = (
        np.linalg.norm(each - wanted) / np.linalg.norm(wanted)
        for each in (level.response[0, kept], plain_lines)
    )
    assert missed < 0.03 < 0.1 < before


def diagnosed(folder, model):
    """The folder of results of the documented example, by the command."""
    example.main(folder / "raw")
    write_campaign(import_folder(folder / "raw")[0], folder / "masses.nc")
    asked = ["diagnose", str(folder / "masses.nc"), "--model", str(model)]
    assert main([*asked, "--folder", str(folder / "results")]) == 0
    return folder / "results"


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Those with three laws between the masses."""
    folder = tmp_path_factory.mktemp("example")
    laws = [f"{law}.upper-lower" for law in ("clearance", "cubic_stiffness", "single_friction")]
    stated = {"kind": "identified", "candidates": laws, "additions": []}
    (folder / "own.yaml").write_text(yaml.safe_dump({"structure": stated}))
    return diagnosed(folder, folder / "own.yaml")


@pytest.mark.slow
def test_the_documented_stop_is_named_among_all_laws(tmp_path):
    verdict = read_verdict(diagnosed(tmp_path, "identified") / "verdict.json")
    assert (verdict.verdict, verdict.ambiguity_set) == ("named", [["clearance"]])


def test_the_documented_stop_is_named(results):
    verdict = read_verdict(results / "verdict.json")
    assert (verdict.verdict, verdict.ambiguity_set) == ("named", [["clearance"]])
    values = {name: each.value for name, each in verdict.effects[0].parameters.items()}
    assert values["half_gap"] == pytest.approx(example.CLEARANCE, rel=0.01)
    assert values["stiffness"] == pytest.approx(example.STOP, rel=0.02)
    held = [row for row in read_table(results / "prediction.csv") if row["split"] == "holdout"]
    assert all(float(row["error_completed"]) < 0.1 * float(row["error_refitted"]) for row in held)
    cost = json.loads((results / "verdict.json").read_text())["cost"]
    assert cost["simulations"] > 10
    assert sum(stage["simulations"] for stage in cost["by_stage"].values()) == cost["simulations"]


def test_the_records_demand_the_law_of_the_stop(results):
    """Of linear modes the sensors demand a force; the fitted law has it, in the band."""
    evidence = read_record(results / "evidence.nc")
    assert evidence["place_name"].values.tolist() == ["upper-lower"]
    demanded = evidence["demanded_force"].values[-1, 0]
    law = evidence["model_force"].values[1, -1, 0]
    assert np.std(demanded - law) < 0.3 * np.std(demanded)
    assert evidence["resolution"].values[-1, 0] > 0.99 > evidence["resolution"].values[0, 0]
    before, after = np.linalg.norm(evidence["holding_force"].values[:, -1], axis=(-2, -1))
    assert after < 0.4 * before


def test_the_figures_of_any_diagnosis_are_drawn(results):
    content = [read_record(results / f"{name}.nc") for name in ("evidence", "spectra")]
    plots = diagnosis_figures(*content, read_verdict(results / "verdict.json"))
    sheets = [*map(drawn, plots)]
    assert [sheet.name for sheet in sheets if not sheet.tables] == []
