"""OpenSees judges a bar whose section has two axes, along bends in two planes."""

import numpy as np
import pytest
from scipy import linalg

from evidence.validation.judges.opensees import NODES_FROM
from evidence.validation.judges.presence import JudgeAbsent, opensees
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.structure.tube import build_structure

YOUNG, POISSON, DENSITY = 2.0e11, 0.3, 8000.0
AREA, FIRST, SECOND = 4.0e-4, 3.333e-9, 5.333e-8
FIRST_AXIS = np.array([0.0, 0.6, 0.8])
CLAMPED = {"kind": "clamped"}
BAR = {
    "kind": "path",
    "theory": "euler_bernoulli",
    "section": {
        "kind": "general",
        "area_m2": AREA,
        "second_moments_m4": (FIRST, SECOND),
        "torsion_constant_m4": FIRST + SECOND,  # OpenSees takes the inertia of torsion from it
        "shear_coefficients": (0.85, 0.85),
        "outer_fibres_m": (0.005, 0.020),
        "first_axis": tuple(FIRST_AXIS),
        "enclosed_area_m2": None,
    },
    "material": {
        "young_modulus_Pa": YOUNG,
        "poisson_ratio": POISSON,
        "density_kg_per_m3": DENSITY,
    },
    "start_m": (0.0, 0.0, 0.0),
    "start_direction": (1.0, 0.0, 0.0),
    "segments": (
        {"kind": "straight", "length_m": 0.3},
        {"kind": "bend", "radius_m": 0.2, "angle_deg": 90.0, "toward": (0.0, 0.0, 1.0)},
        {"kind": "bend", "radius_m": 0.2, "angle_deg": 90.0, "toward": (0.0, 1.0, 0.0)},
        {"kind": "straight", "length_m": 0.3},
    ),
    "mesh": {"elements_per_span": 40, "elements_per_bend": 60},
    "start": CLAMPED,
    "end": CLAMPED,
}


def first_axes(nodes):
    """Return (element, 3): the first axis of each element between nodes (node, 3), turned from one
    element to the next by the least rotation of its direction.
    """
    tangents = np.diff(nodes, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    axis = FIRST_AXIS - (FIRST_AXIS @ tangents[0]) * tangents[0]
    axes = [axis / np.linalg.norm(axis)]
    for one, other in zip(tangents[:-1], tangents[1:], strict=True):
        across, cosine = np.cross(one, other), one @ other
        axis = axes[-1]
        turned = axis * cosine + np.cross(across, axis)
        axes.append(turned + across * (across @ axis) / (1.0 + cosine))  # Rodrigues
    return tangents, np.array(axes)


def opensees_frequencies(ops, nodes, count):
    """Return (mode,) Hz of the clamped bar between nodes (node, 3) in OpenSees."""
    shear = 0.5 * YOUNG / (1.0 + POISSON)
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for number, position in enumerate(nodes):
        ops.node(NODES_FROM + number, *map(float, position))
    for end in (0, len(nodes) - 1):
        ops.fix(NODES_FROM + end, 1, 1, 1, 1, 1, 1)
    for number, (tangent, axis) in enumerate(zip(*first_axes(nodes), strict=True)):
        tag = NODES_FROM + number
        # OpenSees' local z; its local y, along which Iz resists deflection, is the first axis.
        ops.geomTransf("Linear", tag, *map(float, np.cross(tangent, axis)))
        constants = (AREA, YOUNG, shear, FIRST + SECOND, SECOND, FIRST)
        ops.element(
            *("elasticBeamColumn", tag, tag, tag + 1, *constants, tag),
            *("-mass", DENSITY * AREA, "-cMass"),
        )
    squares = np.array(ops.eigen(count))
    ops.wipe()
    return np.sqrt(squares) / (2.0 * np.pi)


def test_a_bar_with_two_bends_has_the_frequencies_of_opensees():
    structure = build_structure(StageSettings({"structure": BAR, "supports": ()}))
    try:
        judge = opensees_frequencies(opensees(), structure.nodes, 10)
    except JudgeAbsent as absent:
        pytest.skip(str(absent))
    squares = linalg.eigh(
        structure.stiffness.toarray(),
        structure.mass.toarray(),
        eigvals_only=True,
        subset_by_index=[0, 9],
    )
    assert np.sqrt(squares) / (2.0 * np.pi) == pytest.approx(judge, rel=1e-4)
