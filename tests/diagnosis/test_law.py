"""The law that records demand: made-up laws come back from the motion of remote sensors."""

from dataclasses import replace

import numpy as np
import pytest

from vibroimpact.diagnosis.law import (
    SEEN,
    Places,
    demanded,
    element_force,
    places_of,
    receptances,
)
from vibroimpact.structure.contact.laws import LocalLaws

STIFFNESS = 3.0e4  # N/m, of a spring along each direction of each support
DAMPING = 20.0  # N s/m
FREQUENCY = np.arange(8.0, 400.0, 0.25)


@pytest.fixture(scope="module")
def model(study_model):
    """The reduced model of the study."""
    return study_model


def sprung(model, sensors, noise=0.0, seed=1):
    """((drive, sensors (sensor, line)), variance, force (place, line), motion) of a linear
    structure with a spring and a damper at every support, under a white force; noise: over the RMS.
    """
    rng = np.random.default_rng(seed)
    places = places_of(model)
    lines = len(FREQUENCY)
    drive = rng.standard_normal((model.drive_shapes.shape[1], lines)) + 0j
    own = receptances(model, FREQUENCY)
    driven = own * (model.drive_shapes @ drive).T
    at = np.einsum("lm,mp,mq->lpq", own, places.shapes, places.shapes)
    law = (STIFFNESS + 2j * np.pi * FREQUENCY * DAMPING)[:, None]
    matrix = np.eye(len(places.names)) + at * law[..., None]
    motion = np.linalg.solve(matrix, (driven @ places.shapes)[..., None])[..., 0]
    force = -law * motion
    measured = ((driven + own * (force @ places.shapes.T)) @ sensors).T
    size = noise * np.sqrt(np.mean(np.abs(measured) ** 2))
    white = rng.standard_normal(measured.shape) + 1j * rng.standard_normal(measured.shape)
    level = max(size, 1e-9 * np.abs(measured).max())
    variance = np.full(measured.shape, level**2)
    return (drive, measured + size * white / np.sqrt(2.0)), variance, force.T, motion.T


def sensors_along(model, count):
    """(mode, sensor): sensors along the whole tube, in all directions."""
    shapes = model.line_shapes
    return shapes[:, np.linspace(3, shapes.shape[1] - 4, count).round().astype(int)]


def test_a_resultant_and_its_motion_are_collocated(model):
    places = places_of(model)
    assert len(places.names) == 2 * len(model.support_names)
    first = model.contact_shapes[:, model.support_of_point == 0].mean(axis=1)
    np.testing.assert_allclose(places.shapes[:, :2], first)


def test_a_spring_at_the_supports_comes_back_exactly(model):
    sensors = sensors_along(model, 12)
    lines, variance, force, motion = sprung(model, sensors)
    places = places_of(model)
    seen = with_sensors(model, sensors)
    found, there, resolution, explained, _ = demanded(seen, places, FREQUENCY, lines, variance)
    acting = np.std(force, axis=1) > 1e-3 * np.std(force, axis=1).max()
    assert acting.any() and (resolution[acting] > 0.999).all() and explained > 0.999999
    np.testing.assert_allclose(
        found[acting], force[acting], rtol=0, atol=2e-3 * np.abs(force).max()
    )
    stiffness, damping = slope(there[acting], found[acting])
    assert stiffness == pytest.approx(STIFFNESS, rel=2e-3)
    assert damping == pytest.approx(DAMPING, rel=2e-2)
    np.testing.assert_allclose(there[acting], motion[acting], atol=1e-3 * np.abs(motion).max())


def test_stiffness_survives_noise_of_one_per_cent(model):
    sensors = sensors_along(model, 12)
    lines, variance, _, _ = sprung(model, sensors, noise=0.01)
    found, there, resolution, *_ = demanded(
        with_sensors(model, sensors), places_of(model), FREQUENCY, lines, variance
    )
    known = resolution > 0.9
    assert known.any()
    assert slope(there[known], found[known])[0] == pytest.approx(STIFFNESS, rel=0.05)


def test_too_few_sensors_say_that_the_law_is_not_seen(model):
    sensors = sensors_along(model, 12)[:, :1]
    lines, variance, _, _ = sprung(model, sensors, noise=0.01)
    _, _, resolution, *_ = demanded(
        with_sensors(model, sensors), places_of(model), FREQUENCY, lines, variance
    )
    assert resolution.sum() < 1.05 and (resolution < SEEN).sum() >= len(resolution) - 1


def test_without_a_law_no_force_is_demanded(model):
    sensors = sensors_along(model, 12)
    (drive, measured), variance, force, _ = sprung(model, sensors)
    free = ((receptances(model, FREQUENCY) * (model.drive_shapes @ drive).T) @ sensors).T
    found, *_ = demanded(
        with_sensors(model, sensors), places_of(model), FREQUENCY, (drive, free), variance
    )
    assert np.abs(found).max() < 1e-4 * np.abs(force).max()


def test_a_structure_without_supports_has_no_places(model):
    nowhere = Places((), (), np.zeros((model.modes, 0)))
    lines, variance, _, _ = sprung(model, sensors_along(model, 3))
    found, there, resolution, explained, _ = demanded(
        with_sensors(model, sensors_along(model, 3)), nowhere, FREQUENCY, lines, variance
    )
    assert found.shape == there.shape == (0, len(FREQUENCY)) and resolution.shape == (0,)
    assert explained == 0.0


def slope(motion, force):
    """(stiffness N/m, damping N s/m) of lines (place, line), by least squares."""
    ratio = -np.sum(force * motion.conj(), axis=0) / np.sum(np.abs(motion) ** 2, axis=0)
    weight = np.sum(np.abs(motion) ** 2, axis=0) ** 0.5
    omega = 2.0 * np.pi * FREQUENCY
    stiffness = np.sum(weight * ratio.real) / weight.sum()
    return stiffness, np.sum(weight * omega * ratio.imag) / np.sum(weight * omega**2)


def with_sensors(model, shapes):
    """The model with sensors of shapes (mode, sensor) in place of its own."""
    count = shapes.shape[1]
    return replace(
        model,
        sensor_shapes=shapes,
        sensor_names=tuple(f"s{number}" for number in range(count)),
        sensor_positions=np.zeros((count, 3)),
        sensor_directions=np.tile([1.0, 0.0, 0.0], (count, 1)),
    )


@pytest.mark.parametrize(
    ("columns", "motion", "force"),
    [
        ({"stiffness": 2.0e3}, [0.0, 1e-3, 2e-3], [0.0, -2.0, -4.0]),
        ({"cubic": 1.0e9}, [0.0, 1e-3, -1e-3], [0.0, -1.0, 1.0]),
        (
            {"saturation_stiffness": 1.0e3, "saturation_limit": 1.5},
            [0.0, 1e-3, 4e-3],
            [0.0, -1.0, -1.5],
        ),
        (
            {"stick_stiffness": 1.0e3, "slip_limit": 1.0},  # it slips, and sticks as it turns
            [0.0, 3e-3, 2.5e-3],
            [0.0, -1.0, -0.5],
        ),
    ],
)
def test_force_of_an_element_is_that_of_its_law(columns, motion, force):
    laws = LocalLaws.neutral(1)
    values = vars(laws) | {name: np.array([value]) for name, value in columns.items()}
    found = element_force(LocalLaws(**values), 0, np.array(motion), 1000.0)
    np.testing.assert_allclose(found, force, atol=1e-12)
