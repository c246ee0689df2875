"""A user's campaign of two masses, prepared and judged without being told anything: named, none, or
not testable, never a wrong name.
"""

import functools

import numpy as np
import pytest
from scipy import linalg

from tests import two_masses
from vibroimpact.campaign.file import write_campaign
from vibroimpact.completion.candidate import run_candidate
from vibroimpact.completion.conclude import _withdrawn
from vibroimpact.completion.long_records import long_record_lines
from vibroimpact.completion.outcome import outcome
from vibroimpact.completion.own_records import unsettled_periods
from vibroimpact.completion.prepare import prepared
from vibroimpact.completion.store import modes_of
from vibroimpact.completion.structure_file import StructureFile
from vibroimpact.completion.study import study_of
from vibroimpact.completion.updated_model import configuration
from vibroimpact.config.reading import check_config
from vibroimpact.records import plain_values
from vibroimpact.reduction.reduced_model import build_model

KEYS = {
    "verdict",
    "effects",
    "ambiguity_set",
    "ranking",
    "next_measurement",
    "broken_invariances",
    "regions",
    "misfit",
    "p_global_before",
    "p_global_after",
    "checks",
    "seconds",
    "simulations",
    "provenance",
    "cost",
}
FEW = ("cubic_stiffness", "clearance", "single_friction", "saturation_stiffness", "quadratic_drag")


def silent(*_):
    """Say nothing."""


def prepared_of(campaign, folder, asked=None):
    """prepare.prepared of a campaign Dataset."""
    write_campaign(campaign, folder / "own.nc")
    return prepared("own", str(folder / "own.nc"), asked or StructureFile(source="x.yaml"), silent)


@functools.cache
def _campaign(law, periodic=True):
    return two_masses.campaign(law, periodic, 4 if periodic else 8)


def judged(law, folder, periodic=True):
    """(verdict, rows, completed, study, campaign) of a law, with the laws of FEW at the place that
    changes.
    """
    values, campaign, linear, _ = prepared_of(_campaign(law, periodic), folder)
    linear, study = plain_values(linear), study_of(values)
    singles = [
        plain_values(
            run_candidate(campaign, study, linear, f"{name}.{study.mounting}", told=silent)
        )
        for name in FEW
    ]
    return (
        *outcome(campaign, study, values, linear, singles, [], {"versions": "x"}, silent),
        study,
        campaign,
    )


def masses():
    """(frequency (mode,), shapes (mode, channel)) of the two masses by hand."""
    stiffness = np.array(
        [
            [two_masses.GROUND[0] + two_masses.JOINT[0], -two_masses.JOINT[0]],
            [-two_masses.JOINT[0], two_masses.JOINT[0]],
        ]
    )
    squares, shapes = linalg.eigh(stiffness, np.diag(two_masses.MASS))
    return np.sqrt(squares) / (2.0 * np.pi), shapes.T * np.sign(shapes[0])[:, None]


@pytest.mark.parametrize("periodic", [True, False])
def test_modes_from_periodic_and_random_records(tmp_path, periodic):
    values, campaign, linear, _ = prepared_of(_campaign("nothing", periodic), tmp_path)
    frequency, shapes = masses()
    base, study = modes_of(linear["base"]), study_of(values)
    assert (
        values["refused"] is None
        and study.drive == "upper"
        and study.residual_modes == (False, False)
    )
    assert campaign.attrs["period_samples"] == (two_masses.PERIOD if periodic else 0)
    assert base.frequency == pytest.approx(frequency, rel=3.0e-3)
    assert base.shapes == pytest.approx(shapes, abs=0.03)
    assert study.band_Hz[0] == pytest.approx(3.0, abs=0.2) and 25.0 < study.band_Hz[1] < 46.0


def test_cubic_spring_is_named_and_located(tmp_path):
    verdict, rows, completed, study, campaign = judged("cubic", tmp_path)
    assert study.mounting == "upper-lower"
    assert (
        set(verdict.to_values()) == KEYS
        and verdict.verdict == "named"
        and verdict.ambiguity_set == [["cubic_stiffness"]]
    )
    effect = verdict.effects[0]
    assert effect.location == "upper-lower: between upper and lower"
    assert effect.parameters["cubic_stiffness"].value == pytest.approx(two_masses.CUBIC, rel=0.05)
    assert all(
        row["error_completed"] < 0.1 < row["error_linear"]
        for row in rows
        if row["split"] == "holdout"
    )
    assert build_model(
        check_config(configuration(completed, campaign, study), "updated")
    ).sensor_names == ("upper.x", "lower.x")


def test_law_that_makes_held_out_levels_worse_is_withdrawn():
    effects = [{"id": "cubic_stiffness", "location": "a", "parameters": {}}]
    row = {"before_dB": 8.9, "after_dB": 10.5, "floor_dB": 1.0, "closed_fraction": -0.18}
    fitted = row | {"after_dB": 2.0, "closed_fraction": 0.8}
    verdict = {"verdict": "named", "p_global_before": 1.0e-9}
    told = _withdrawn(verdict | {"misfit": {"fit": fitted, "holdout": row}}, effects)
    assert (told["verdict"], told["effects"], told["ambiguity_set"]) == ("unknown", [], [])
    assert told["withdrawn"]["effects"] == effects
    assert told["misfit"]["fit"]["after_dB"] == 8.9  # the model as given: nothing is added
    better = {"fit": fitted, "holdout": fitted}
    assert _withdrawn(verdict | {"misfit": better}, effects) == {}


def test_linear_structure_gets_verdict_none(tmp_path):
    verdict = judged("nothing", tmp_path)[0]
    assert verdict.verdict == "none" and verdict.effects == [] and verdict.ambiguity_set == []
    assert verdict.regions == []


@pytest.mark.slow
def test_bouc_wen_hysteresis_is_at_most_called_friction(tmp_path):
    verdict = judged("bouc_wen", tmp_path)[0]
    assert verdict.verdict in ("named", "partly_explained", "ambiguous", "unknown")
    assert {each for ids in verdict.ambiguity_set for each in ids} <= {
        "coulomb_friction",
        "saturation_stiffness",
    }


@pytest.mark.slow
def test_cubic_spring_is_found_in_random_records(tmp_path):
    verdict, rows, *_ = judged("cubic", tmp_path, periodic=False)
    assert (
        verdict.verdict in ("named", "partly_explained")
        and verdict.effects[0].id == "cubic_stiffness"
    )
    assert verdict.effects[0].parameters["cubic_stiffness"].value == pytest.approx(
        two_masses.CUBIC, rel=0.1
    )


def test_sensor_opposite_to_the_force_is_reversed(tmp_path):
    values, campaign, linear, _ = prepared_of(
        two_masses.campaign("nothing", periods=3, turned=True), tmp_path
    )
    assert modes_of(linear["base"]).frequency == pytest.approx(masses()[0], rel=3.0e-3)
    assert campaign["channel_direction"].values[0].tolist() == [0.0, 0.0, 1.0]


def test_two_levels_are_not_testable(tmp_path):
    campaign = two_masses.campaign("nothing", periods=3, levels=(1.0, 4.0), splits=("fit", "fit"))
    values, kept, linear, _ = prepared_of(campaign, tmp_path)
    verdict, rows, completed = outcome(kept, None, values, plain_values(linear), [], [], {}, silent)
    assert (
        set(verdict.to_values()) == KEYS and verdict.verdict == "not_testable" and completed is None
    )
    assert "record a third level" in next(
        row.message for row in verdict.checks if row.level == "refuse"
    )
    assert len(rows) == 4


def test_response_unrelated_to_the_force_is_refused(tmp_path):
    campaign = two_masses.campaign("nothing", periods=3)
    campaign["response"].values[:] = np.random.default_rng(3).standard_normal(
        campaign["response"].shape
    )
    values, kept, linear, _ = prepared_of(campaign, tmp_path)
    assert (
        values["refused"]
        and linear == {}
        and outcome(kept, None, values, {}, [], [], {}, silent)[0].verdict == "not_testable"
    )


def test_transient_periods_are_counted():
    steady = np.random.default_rng(1).standard_normal((2, 500))
    signal = np.tile(steady, 6) + 1.0e-3 * np.random.default_rng(2).standard_normal((2, 3000))
    signal[:, :900] += 5.0 * np.exp(-np.arange(900) / 100.0)
    assert (
        unsettled_periods(signal, 500) == 2
        and unsettled_periods(
            np.tile(steady, 4) + 0.01 * np.random.default_rng(4).standard_normal((2, 2000)), 500
        )
        == 0
    )


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
