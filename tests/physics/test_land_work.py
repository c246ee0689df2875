"""The sliding work by land, of flat lands and of lobes."""

from dataclasses import replace

import numpy as np
import pytest

from tests.support.oscillator import oscillator
from vibroimpact.integration.batch import Schedule, integrate_batch
from vibroimpact.integration.run_statistics import statistics

DURATION = 0.5


def rates(model, duration=DURATION, gap=1e-4):
    """Statistics of a run from the model's initial state, without a force."""
    schedule = Schedule(51200, 2048, 0.0, duration, "newmark")
    still = np.zeros((model.support_of_point.size, 2, 1))
    found = integrate_batch(
        model,
        schedule,
        np.array([gap]),
        still,
        lambda first, count: np.zeros((count, 1, 1)),
    )
    return statistics(found, 0, 51200.0)


def bouncing(angle, **shape):
    """A mass launched in a direction (rad) in a lobed or flat obstacle, a little off that line."""
    speed = 0.2 * np.array([np.cos(angle + 0.02), np.sin(angle + 0.02)])
    return oscillator(1.0, 400.0, contact_stiffness=1e6, velocity=speed, **shape)


@pytest.mark.parametrize(("angle", "land"), [(0.3, 0), (0.3 + np.pi / 2, 1), (0.3 - np.pi / 2, 3)])
def test_lobes_have_their_own_work(angle, land):
    """The mass meets the land ahead and the one opposite, and no other."""
    laws = {"lobes": 4, "lobe_depth": 1e-5, "lobe_angle": 0.3}
    found = rates(bouncing(angle, contact=laws), duration=8 / 2048)
    work, total = found["land_work_rate"][0], found["wear_work_rate"][0]
    assert total > 0.0 and work.sum() == pytest.approx(total, rel=1e-12)
    opposite = (land + 2) % 4
    assert work[land] > 0.0 and work[land] + work[opposite] == pytest.approx(total, rel=1e-12)


def test_a_flat_land_has_its_own_work():
    """Pressed on the second of three lands, a mass slides on that one alone: N |v| T."""
    normal, speed = 10.0, 0.02
    model = oscillator(
        1.0,
        0.0,
        contact_stiffness=1e6,
        lands=[(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0)],
        displacement=(-1e-4 - normal / 1e6, -0.5),
        velocity=(0.0, speed),
        dead_load=(-normal, 0.0),
    )
    found = rates(model)
    assert found["land_work_rate"][0] == pytest.approx([0.0, normal * speed, 0.0], rel=1e-3)


def test_a_round_hole_has_no_lands():
    assert "land_work_rate" not in rates(bouncing(0.0))


def test_a_round_hole_beside_lands_is_one_land(study_model):
    """The hole of the study's first support is round, the second has four flat lands."""
    points = np.flatnonzero(study_model.support_of_point == 1)
    normals = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
    laws = study_model.contact_laws.with_columns(
        land_point=np.repeat(points, 4), land_normal=np.tile(normals, (len(points), 1))
    )
    force = 300.0 * np.random.default_rng(5).normal(size=(52000, 1, 1))
    found = integrate_batch(
        replace(study_model, contact_laws=laws),
        Schedule(51200, 2048, 0.0, DURATION, "newmark"),
        np.array([1e-4]),
        np.full((study_model.support_of_point.size, 2, 1), 1e-5),
        lambda first, count: force[first : first + count],
    )
    values = statistics(found, 0, 51200.0)
    lands, total = values["land_work_rate"], values["wear_work_rate"]
    assert lands.shape == (2, 4) and np.all(total > 0.0)
    assert lands.sum(axis=1) == pytest.approx(total, rel=1e-12)
    assert list(np.count_nonzero(lands, axis=1)) == [1, 4]
