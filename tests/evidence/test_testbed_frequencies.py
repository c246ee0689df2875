"""Frequencies with a reference, and the stand-in tube's first one by its number of contact
points.
"""

from pathlib import Path

import numpy as np
import pytest

from evidence.validation.reference.frequencies import frequency_checks
from vibroimpact.config.reading import load_config
from vibroimpact.structure.tube import build_structure

STUDY = load_config(Path(__file__).resolve().parents[2] / "config" / "study.yaml")

FIRST_BY_POINTS = {
    (4.0e6, 1): 27.751,
    (4.0e6, 2): 28.215,
    (4.0e6, 3): 28.069,
    (4.0e6, 5): 27.993,
    (4.0e6, 9): 27.954,
    (1.0e9, 1): 28.186,
    (1.0e9, 2): 33.621,
    (1.0e9, 3): 33.516,
    (1.0e9, 5): 33.331,
    (1.0e9, 9): 33.173,
}


def tube(theory="timoshenko", bend_elements=40, points=5):
    """Return the Structure of the study's tube with another theory, bend mesh or number of contact
    points.
    """
    mesh = STUDY.structure.mesh.model_copy(update={"elements_per_bend": bend_elements})
    supports = tuple(support.model_copy(update={"points": points}) for support in STUDY.supports)
    return build_structure(
        STUDY.model_copy(
            update={
                "structure": STUDY.structure.model_copy(update={"theory": theory, "mesh": mesh}),
                "supports": supports,
            }
        )
    )


def test_every_frequency_with_a_reference():
    """Beams by their ends, continuous beams, published U-bend, free ring, and all rows of the
    stand-in tube's table.
    """
    checks = frequency_checks(STUDY)
    assert len(checks) == 13 + 9 + 10 + 6 + 49
    assert [check.row() for check in checks if not check.passed] == []


def test_mass_of_the_tube_in_its_first_out_of_plane_motion():
    # Moved as one along y, the nodes that the roots leave free carry all but what the first and
    # last element hand to the clamp.
    structure = tube(bend_elements=80)
    along = (np.arange(structure.dofs) % 6 == 1).astype(float)
    total = 8330.0 * np.pi * (0.02222 - 0.00127) * 0.00127 * (1.4 + 0.3 * np.pi)
    assert along @ (structure.mass @ along) == pytest.approx(total, rel=0.02)
