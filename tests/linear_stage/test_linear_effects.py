"""Linear effects are read off a lowest record: one, two at once, modes that moved far, a record
that touches.
"""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import xarray as xr

from vibroimpact.campaign.file import (
    Channel,
    Level,
    campaign_dataset,
    read_campaign,
    write_campaign,
)
from vibroimpact.config.reading import check_config
from vibroimpact.effects.places import between
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.linear_stage.candidates import Pair, candidate_named
from vibroimpact.linear_stage.effect_fit import LinearChanges
from vibroimpact.linear_stage.linear_analysis import adopt, prepare, workbench
from vibroimpact.linear_stage.lowest_record import suffices, told_apart
from vibroimpact.linear_stage.nearest_model import translated
from vibroimpact.linear_stage.spring_in_record import SpringInRecord
from vibroimpact.linear_stage.workbench import Workbench, corrected_nuisance
from vibroimpact.observation.attached_model import attach
from vibroimpact.observation.simulated_records import Forces, schedule_of, simulate_records

RATE, SECONDS, GAP = 2048.0, 12.0, 2.8886e-4
PLACES = {
    "apex_y": ([0.0, 0.0, 1.0], [0, 1, 0]),
    "bend_y": ([0.2121, 0.0, 0.9121], [0, 1, 0]),
    "leg_y": ([-0.3, 0.0, 0.55], [0, -1, 0]),
    "lower_y": ([0.3, 0.0, 0.33], [0, 1, 0]),
    "apex_x": ([0.0, 0.0, 1.0], [1, 0, 0]),
}
ROOTS = ("root_stiffness@roots", {"translation": 1.0e8, "rotation": 6000.0})
MASS = (
    "added_mass@apex_y",
    {"mass": 0.3},
)
STINGER = ("lateral_stinger@along_y", {"stiffness": 5000.0, "damping": 0.0})
TURNED = (
    "force_misalignment@about_tube",
    {"angle": -0.4},
)
DAMPED = ("modal_damping@all", {"factor": 3.0})
FLUID = ("fluid_added_mass_damping@tube", {"mass": 0.25, "damping": 5.0})
CROSSED = (
    "mode_frequency_error@mode_5",
    {"factor": 0.85},
)


def file_of(config, path, *effects, loads=(0.02, 0.03), gains=(1.0,) * len(PLACES)):
    """Write the campaign of a tube with effects (candidate's name, parameters in SI)."""
    samples = int(RATE * SECONDS)
    force = np.array(
        [
            load
            * band_limited_noise(np.random.default_rng([5, number]), samples, RATE, (5.0, 200.0))
            for number, load in enumerate(loads)
        ]
    )[:, None]
    channels = [
        Channel(name, tuple(point), tuple(direction), "m s-2", "acceleration")
        for name, (point, direction) in PLACES.items()
    ]
    drive = Channel("shaker", (-0.2121, 0.0, 0.9121), (0.0, 1.0, 0.0), "N", "generic")
    levels = [Level("low", GAP), Level("high", GAP)]
    blank = campaign_dataset(
        force, np.zeros((2, len(PLACES), samples)), channels, [drive], levels, RATE, start_up="rest"
    )
    points = dict(config.points) | {"apex_y": (0.0, 0.0, 1.0)}
    values = config.model_copy(update={"points": points}).model_dump(mode="json")
    for name, physical in effects:
        values = candidate_named(name).variant(values, physical)
    model = attach(check_config(values, "hidden"), blank)
    schedule = schedule_of(blank, config.integration, SECONDS)
    response = simulate_records(
        model,
        schedule,
        Forces(force, schedule),
        [(record, GAP, 0) for record in range(2)],
        ["acceleration"] * len(PLACES),
    )
    response = response * np.array(gains)[:, None]
    response = response + 0.01 * response[0].std(axis=-1).max() * np.random.default_rng(
        6
    ).standard_normal(response.shape)
    write_campaign(
        campaign_dataset(force, response, channels, [drive], levels, RATE, start_up="rest"), path
    )
    return path


def read(prepared):
    """{effect id: {parameter: (value, low, high)}} of what was adopted."""
    candidate = candidate_named(prepared.adopted["name"])
    interval = np.array(prepared.adopted["interval"])
    sides = zip(
        candidate.parts(np.array(prepared.adopted["unit"])),
        candidate.parts(interval[:, 0]),
        candidate.parts(interval[:, 1]),
        strict=True,
    )
    return {
        part.effect_id: part.estimate(own, np.stack([low, high], axis=1), prepared.scales)
        for (part, own), (_, low), (_, high) in sides
    }


def rows_of(*gains):
    """Rows of linear effects, {name: gain}."""
    return [{"name": name, "unit": [0.5], "gain": gain} for name, gain in gains]


def test_turned_force_is_a_gain_to_the_modes_it_drives():
    turned, gain = ("force_misalignment@about_z", 2003.2), ("sensor_gain@force", 2003.1)
    assert not told_apart(rows_of(turned, gain))
    assert told_apart(rows_of(turned, ("sensor_gain@force", 1900.0)))
    # another place of the same effect, and a pair that holds it, are no other effect
    other = ("force_misalignment@about_tube", 2003.2)
    assert told_apart(rows_of(turned, other, ("added_mass@apex+sensor_gain@force", 2010.0)))


@pytest.mark.slow
@pytest.mark.parametrize("effects", [(MASS,), (MASS, DAMPED)], ids=["alone", "of two"])
def test_one_effect_suffices_where_it_is_alone(study_config, tmp_path, effects):
    path = file_of(study_config, tmp_path / "a.nc", *effects)
    prepared = prepare(study_config, path)
    masses = [row for row in prepared.linear if row["name"].startswith("added_mass")]
    prepared.adopted, prepared.fit = next(row for row in masses if "+" not in row["name"]), None
    fresh = partial(Workbench, study_config, read_campaign(path))
    moved = fresh()
    adopt(moved, prepared)
    assert suffices(moved, fresh, prepared.adopted) is (len(effects) == 1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effects", "wanted"),
    [
        ((CROSSED,), {"mode_frequency_error": ("factor", 0.85, 0.005)}),
        ((FLUID,), {"fluid_added_mass_damping": ("mass", 0.25, 0.02)}),
        (
            (ROOTS, MASS),
            {"root_stiffness": ("rotation", 6000.0, 0.02), "added_mass": ("mass", 0.3, 0.02)},
        ),
        (
            (STINGER, DAMPED),
            {
                "lateral_stinger": ("stiffness", 5000.0, 0.02),
                "modal_damping": ("factor", 3.0, 0.06),
            },
        ),
        (
            (TURNED, DAMPED),
            {"force_misalignment": ("angle", -0.4, 0.03), "modal_damping": ("factor", 3.0, 0.06)},
        ),
    ],
    ids=[
        "a mode below its neighbour",
        "a fluid that moves every mode",
        "roots and mass",
        "stinger and damping",
        "turned force and damping",
    ],
)
def test_linear_effects_are_read_back(study_config, tmp_path, effects, wanted):
    prepared = prepare(study_config, file_of(study_config, tmp_path / "campaign.nc", *effects))
    found = read(prepared)
    assert set(found) == set(wanted)
    assert not prepared.nonlinear_low
    for effect, (parameter, value, tolerance) in wanted.items():
        best, low, high = found[effect][parameter]
        assert best == pytest.approx(value, rel=tolerance)
        assert low < best < high


@pytest.mark.slow
def test_single_effect_is_not_split_in_two(study_config, tmp_path):
    prepared = prepare(study_config, file_of(study_config, tmp_path / "campaign.nc", MASS))
    assert (
        prepared.adopted["name"].split("@")[0] == "added_mass"
        and "+" not in prepared.adopted["name"]
    )


@pytest.mark.slow
def test_mass_is_placed_between_named_points(study_config, tmp_path):
    at_m = 1.21  # 12 cm from the next point that has a name
    hidden = (f"added_mass@{between(at_m)}", {"mass": 0.3})
    prepared = prepare(study_config, file_of(study_config, tmp_path / "campaign.nc", hidden))
    best, low, high = read(prepared)["added_mass"]["mass"]
    assert best == pytest.approx(0.3, rel=0.05)
    location = candidate_named(prepared.adopted["name"]).location
    assert float(location[4:-2].replace("_", ".")) == pytest.approx(1e3 * at_m, abs=15.0)
    assert not prepared.nonlinear_low


@pytest.mark.slow
def test_contact_in_lowest_record_defers_linear_effects(study_config, tmp_path):
    soft = ("root_stiffness@roots", {"translation": 1.0e8, "rotation": 420.0})
    prepared = prepare(
        study_config, file_of(study_config, tmp_path / "campaign.nc", soft, loads=(0.5, 1.0))
    )
    assert not prepared.linear_stage and prepared.adopted is None
    assert "root_stiffness@roots" in prepared.screened
    assert any(row["check"] == "lowest level" for row in prepared.checks)
    untouched = prepare(study_config, file_of(study_config, tmp_path / "other.nc"))
    assert untouched.linear_stage and untouched.adopted is None
    assert "root_stiffness@roots" not in untouched.screened and set(untouched.screened) < set(
        prepared.screened
    )


def test_adopted_gain_error_explains_the_lowest_record(study_config, tmp_path):
    path = file_of(study_config, tmp_path / "campaign.nc", gains=(1.5, 1.0, 1.0, 1.0, 1.0))
    prepared = prepare(study_config, path)
    assert prepared.adopted["name"] == "sensor_gain@apex_y"
    bench = workbench(study_config, path, prepared, SECONDS)
    known = corrected_nuisance(bench)[1]
    bench.measuring = None
    assert corrected_nuisance(bench)[1] < known - 15.0


@pytest.mark.slow
def test_gain_error_and_stinger_are_separated(study_config, tmp_path):
    path = file_of(study_config, tmp_path / "campaign.nc", STINGER, gains=(1.0, 1.4, 1.0, 1.0, 1.0))
    prepared = prepare(study_config, path)
    found = read(prepared)
    assert isinstance(candidate_named(prepared.adopted["name"]), Pair) and set(found) == {
        "lateral_stinger",
        "sensor_gain",
    }
    assert found["sensor_gain"]["factor"][0] == pytest.approx(1.4, rel=0.03)
    bench = workbench(study_config, path, prepared, SECONDS)
    adopt(bench, prepared)
    assert bench.measuring.gain[1] == pytest.approx(found["sensor_gain"]["factor"][0])
    assert bench.bare.omega[0] > 1.05 * attach(study_config, bench.campaign).omega[0]


@pytest.mark.slow
def test_nonlinear_substitutes_sit_where_a_spring_would(study_config, tmp_path):
    """A rod at the shaker may be a friction or a stop on the tube, whose place is searched; what
    acts all along it is never ruled out by a place.
    """
    prepared = prepare(study_config, file_of(study_config, tmp_path / "campaign.nc", STINGER))
    assert prepared.adopted["name"] == "lateral_stinger@along_y"
    assert {"coulomb_friction@along_tube", "clearance@along_tube", "quadratic_drag@tube"} <= set(
        prepared.in_place
    )
    assert set(prepared.in_place) < set(prepared.screened) and "gap@all" not in prepared.in_place
    bench = workbench(study_config, tmp_path / "campaign.nc", prepared, SECONDS)
    assert prepared.still_linear and bench.reads_lowest
    assert not workbench(
        study_config,
        tmp_path / "campaign.nc",
        replace(prepared, still_linear=False),
        SECONDS,
    ).reads_lowest  # as the linear stage saw it
    bare = Workbench(study_config, bench.campaign, SECONDS)
    bare.measured_fit = translated(bench.measured_fit, bench.bare, bare.bare)
    there, elsewhere = (
        SpringInRecord(bare, LinearChanges(bare), place, 6600.0).along_force().gain
        for place in ("shaker", "lower_y")
    )
    assert (
        there == pytest.approx(prepared.adopted["gain"], abs=3.0) and elsewhere < 0.5 * there
    )  # that rod is a spring between that point and the ground


def test_held_out_record_is_fitted_where_it_is_named(study_config, tmp_path):
    path = file_of(study_config, tmp_path / "campaign.nc")
    with xr.open_dataset(path) as campaign:
        held = campaign.load().assign(split=("record", np.array(["fit", "holdout"], object)))
    held.to_netcdf(path)
    prepared = prepare(study_config, path)
    bench = workbench(study_config, path, prepared, SECONDS)
    assert (bench.signals.fit().tolist(), bench.signals.holdout().tolist()) == ([0], [1])
    fitted = replace(prepared, fitted=[bench.signals.record_names[1]])
    bench = workbench(study_config, path, fitted, SECONDS)
    assert (bench.signals.fit().tolist(), bench.signals.holdout().tolist()) == ([0, 1], [])
