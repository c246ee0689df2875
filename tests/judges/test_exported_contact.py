"""Exported contact runs in OpenSees: a mass in a hole and between flat lands moves as ours does."""

import numpy as np
import pytest

from evidence.validation.judges.presence import JudgeAbsent, opensees
from tests.support.oscillator import oscillator
from vibroimpact.equivalent_support.contact_points import ContactPoint, ContactSet
from vibroimpact.equivalent_support.export_formats.registry import contacts_text
from vibroimpact.integration.every_step import integrate_every_step

MASS, STIFFNESS, CONTACT, GAP = 2.0, 8.0e3, 1.0e6, 1.0e-3
RATE, STEPS = 100_000, 6000
VELOCITY = (0.30, 0.11)
LANDS = [(1.0, 0.0), (-0.6, 0.8), (-0.6, -0.8)]


def ours(lands):
    """(2, step) m: the path of the mass, launched from the middle."""
    model = oscillator(MASS, STIFFNESS, contact_stiffness=CONTACT, lands=lands, velocity=VELOCITY)
    still = np.zeros((1, 2, 1))
    run = integrate_every_step(
        model,
        RATE,
        STEPS,
        np.array([GAP]),
        still,
        lambda first, count: np.zeros((count, 1, 1)),
        "newmark",
    )
    return run.contact_displacement[0, 0]


def theirs(ops, lands):
    """The same in OpenSees, on exported contact: average acceleration, Newton's iterations."""
    axes = np.eye(3)[:2]
    normals = np.array(lands).reshape(-1, 2) @ axes
    own = ContactPoint("hole_1", np.zeros(3), axes, np.zeros(3), GAP, CONTACT, normals)
    names = {}
    exec(contacts_text(ContactSet((own,)), "opensees")[0], names)  # noqa: S102
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for tag in (1, 2):
        ops.node(tag, 0.0, 0.0, 0.0)
    ops.fix(1, 0, 0, 1, 1, 1, 1)
    ops.fix(2, 1, 1, 1, 1, 1, 1)
    ops.mass(1, MASS, MASS, MASS, 0.0, 0.0, 0.0)
    ops.uniaxialMaterial("Elastic", 1, STIFFNESS)
    ops.element("zeroLength", 1, 2, 1, "-mat", 1, 1, "-dir", 1, 2)
    names["add_contacts"](ops, {"hole_1": 1})
    for direction, speed in enumerate(VELOCITY, 1):
        ops.setNodeVel(1, direction, speed, "-commit")
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("NormDispIncr", 1e-14, 60)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    path = []
    for _ in range(STEPS):
        assert ops.analyze(1, 1.0 / RATE) == 0
        path.append([ops.nodeDisp(1, direction) for direction in (1, 2)])
    ops.wipe()
    return np.array(path).T


@pytest.mark.parametrize("lands", [[], LANDS])
def test_opensees_moves_as_ours(lands):
    try:
        ops = opensees()
    except JudgeAbsent as absent:
        pytest.skip(str(absent))
    mine, other = ours(lands), theirs(ops, lands)
    touching = (np.array(lands) @ mine > GAP).any(axis=0) if lands else np.hypot(*mine) > GAP
    assert np.count_nonzero(np.diff(touching.astype(int)) == 1) >= 4  # impacts
    assert np.abs(mine[:, 1:] - other).max() < 1e-6 * GAP
