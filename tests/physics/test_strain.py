"""Strains of the outer fibre against the bending theory of beams."""

import numpy as np
import pytest

from tests.support.straight_path import straight_path
from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.config.reading import check_config
from vibroimpact.diagnosis.measurement.attached_model import attach
from vibroimpact.diagnosis.measurement.sensed_motion import displacement_scale
from vibroimpact.diagnosis.measurement.simulated_records import simulate_records
from vibroimpact.diagnosis.measurement.stretches import rates_of
from vibroimpact.structure.beam_elements import section_beam

LENGTH, RADIUS, WALL, YOUNG = 1.2, 0.01, 0.001, 2.0e11
INERTIA = 0.25 * np.pi * (RADIUS**4 - (RADIUS - WALL) ** 4)
TIP, ROOT, MIDDLE = (LENGTH, 0.0, 0.0), (0.0, 0.0, 0.0), (0.5 * LENGTH, 0.0, 0.0)
Y, Z = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
SLANTED = (0.0, np.sqrt(0.5), -np.sqrt(0.5))
RATE = 1024.0
# Share of the strain at the root that the modes left out would add: at the force, where the moment
# has a kink, strains converge slower than displacements.
LEFT_OUT = 7e-3


@pytest.fixture(scope="module")
def cantilever(study_config):
    """A straight tube that is clamped at its start, without supports."""
    return cantilever_of(study_config, {"outer_diameter_m": 2.0 * RADIUS, "wall_thickness_m": WALL})


def cantilever_of(study_config, section):
    values = study_config.model_dump(mode="json")
    values["structure"] = straight_path(
        LENGTH, [1.0, 0.0, 0.0], section, (YOUNG, 0.3, 7800.0), mesh={"elements_per_span": 20}
    )
    values |= {"points": {"tip": list(TIP)}, "supports": [], "masses": [], "elements": []}
    values["excitation"] = {
        "kind": "band_limited",
        "band_Hz": [5.0, 200.0],
        "point": "tip",
        "direction": list(Y),
    }
    values["record"]["sensors"] = {"points": ["tip"], "directions": ["y"]}
    values["identification"] = None
    return check_config(values, "a cantilever")


def campaign_of(gauges, force=None, units="um/m"):
    """A campaign of strain gauges (place, normal) and a force (time,) at the tip along y."""
    force = np.ones(512) if force is None else force
    channels = [
        Channel(f"gauge {number}", place, normal, units, "strain")
        for number, (place, normal) in enumerate(gauges)
    ]
    drive = Channel("force", TIP, Y, "N", "generic")
    response = np.zeros((1, len(channels), len(force)))
    return campaign_dataset(
        force[None, None], response, channels, [drive], [Level("only", np.nan)], RATE
    )


def static(model):
    """(sensor,) response to 1 N that does not vary."""
    return model.sensor_shapes.T @ (model.drive_shapes[:, 0] / model.omega**2)


def test_end_force_bends_a_cantilever(cantilever):
    """Strain F (L - s) r / (E I); the side that faces the force's way is shortened."""
    down = (0.0, -1.0, 0.0)
    gauges = [(ROOT, Y), (ROOT, down), (MIDDLE, Y), (ROOT, Z), (ROOT, SLANTED), (TIP, Y)]
    found = static(attach(cantilever, campaign_of(gauges)))
    root = LENGTH * RADIUS / (YOUNG * INERTIA)
    expected = root * np.array([-1.0, 1.0, -0.5, 0.0, -np.sqrt(0.5), 0.0])
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=LEFT_OUT * root)


def test_slow_force_in_a_simulated_record(cantilever):
    """The whole way from a campaign to a record: 1 Hz where the first mode is at ten times that."""
    time = np.arange(4096) / RATE
    force = 30.0 * np.sin(2.0 * np.pi * time)
    campaign = campaign_of([(ROOT, Y), (MIDDLE, Y)], force)
    model = attach(cantilever, campaign)
    integration, runs = cantilever.integration, [(0, np.nan, 0)]
    schedule = rates_of(RATE, integration.steps_per_second).schedule(4.0, integration.scheme)
    found = simulate_records(model, schedule, force[None, None], runs, ["strain"] * 2)[0]
    wave = np.sin(2.0 * np.pi * time)[2048:]
    amplitude = found[:, 2048:] @ wave / (wave @ wave)
    slow = 1.0 / (1.0 - (2.0 * np.pi / model.omega[0]) ** 2)
    root = 30.0 * LENGTH * RADIUS / (YOUNG * INERTIA)
    np.testing.assert_allclose(amplitude, [-slow * root, -0.5 * slow * root], rtol=0.01)


def test_face_of_a_rectangle_is_as_far_as_it_is(study_config):
    """F L (h/2) / (E I) of each axis of a section whose first axis is along y."""
    section = {"kind": "rectangle", "sides_m": [0.03, 0.01], "first_axis": list(Y)}
    config = cantilever_of(study_config, section)
    found = static(attach(config, campaign_of([(ROOT, Y), (ROOT, Z)])))
    root = LENGTH * 0.015 / (YOUNG * 0.01 * 0.03**3 / 12.0)
    np.testing.assert_allclose(found, [-root, 0.0], rtol=0.0, atol=LEFT_OUT * root)


def test_strain_beside_the_speed_that_goes_with_it(cantilever):
    """Of a free bending wave speed = strain E I^(1/2) m^(-1/2) / r; at the tip of a mode of a
    cantilever the speed is that of the root's strain.
    """
    model = attach(cantilever, campaign_of([(ROOT, Y)]))
    tip = np.abs(static_shapes(cantilever))
    rooted = np.abs(model.sensor_shapes[:, 0])
    driven = np.abs(model.drive_shapes[:, 0]) > 1e-6
    modes = np.flatnonzero(driven)[:3]
    speed = tip[modes] * model.omega[modes] / rooted[modes]
    structure = cantilever.structure
    plane = section_beam(structure.section, structure.material, structure.theory).planes[0]
    per_strain = np.sqrt(plane.bending_stiffness / plane.mass_per_length) / plane.outer_fibre
    np.testing.assert_allclose(speed, per_strain, rtol=0.02)


def static_shapes(config):
    """(mode,) displacement of the tip along y."""
    drive = Channel("force", TIP, Y, "N", "generic")
    tip = [Channel("tip", TIP, Y, "m", "displacement")]
    silent = np.zeros((1, 1, 64))
    levels = [Level("only", np.nan)]
    return attach(
        config, campaign_dataset(silent, silent, tip, [drive], levels, RATE)
    ).sensor_shapes[:, 0]


def test_a_strain_is_scaled_to_the_largest_displacement(cantilever):
    model = attach(cantilever, campaign_of([(ROOT, Y), (MIDDLE, Y)]))
    strain, scale = model.sensor_shapes[:, 0], displacement_scale(model, ["strain", "velocity"])
    moved = np.abs(model.sensor_shapes[:, 1]).max()
    assert scale[0] * np.abs(strain).max() == pytest.approx(moved)
    assert scale[1] == 1.0
