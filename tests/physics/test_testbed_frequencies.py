"""The stand-in tube's published frequency tables: at the stated mesh every row within 0.1 %."""

from pathlib import Path

import numpy as np
import pytest
from scipy import linalg

from vibroimpact.config import load_config
from vibroimpact.structure import build_structure

STUDY = load_config(Path(__file__).resolve().parents[2] / "config" / "study.yaml")

# (theory, bend elements, k N/m per support): Hz; O out of plane, I in plane
TABLE = {
    ("euler_bernoulli", 80, 1.0): "15.98O 29.02I 45.10O 104.94I 105.12O 172.23O 173.04I",
    ("timoshenko", 80, 1.0): "15.97O 28.96I 45.03O 104.45I 104.68O 171.12O 171.75I",
    ("timoshenko", 40, 1.0e4): "16.78O 30.11I 46.24O 106.38I 106.61O 173.17O 173.95I",
    ("timoshenko", 40, 1.0e5): "20.96O 37.06I 53.84O 120.45I 120.96O 190.06O 191.78I",
    ("timoshenko", 40, 1.0e6): "26.71O 50.31I 68.81O 161.98I 165.43O 275.63O 279.23I",
    ("timoshenko", 40, 4.0e6): "27.99O 53.94I 72.83O 175.26I 179.92O 316.52O 320.16I",
    ("timoshenko", 40, 1.0e9): "33.33O 64.58I 85.21O 198.91I 206.12O 368.72O 372.01I",
}
FIRST_BY_POINTS = {(4.0e6, 1): 27.751, (4.0e6, 2): 28.215, (4.0e6, 3): 28.069, (4.0e6, 5): 27.993, (4.0e6, 9): 27.954,
                   (1.0e9, 1): 28.186, (1.0e9, 2): 33.621, (1.0e9, 3): 33.516, (1.0e9, 5): 33.331, (1.0e9, 9): 33.173}


def tube(theory="timoshenko", bend_elements=40, points=5):
    """Return the Structure of the study's tube with another theory, bend mesh or number of contact points."""
    mesh = STUDY.structure.mesh.model_copy(update={"elements_per_bend": bend_elements})
    supports = tuple(support.model_copy(update={"points": points}) for support in STUDY.supports)
    return build_structure(STUDY.model_copy(update={
        "structure": STUDY.structure.model_copy(update={"theory": theory, "mesh": mesh}), "supports": supports}))


def modes_on_springs(structure, k, count):
    """Return (frequency (count,) Hz, out_of_plane (count,) share of the motion along y) with bilateral k N/m per support."""
    rows = structure.contact_rows().reshape(-1, structure.dofs)
    springs = k * (rows.T * np.repeat(structure.contact.weight, 2)) @ rows
    squares, shapes = linalg.eigh(structure.stiffness.toarray() + springs, structure.mass.toarray(), subset_by_index=[0, count - 1])
    along = np.einsum("dm,dm->m", shapes, structure.mass @ (shapes * (np.arange(structure.dofs) % 6 == 1)[:, None]))
    return np.sqrt(squares) / (2.0 * np.pi), along


@pytest.mark.parametrize("case", TABLE, ids=lambda case: f"{case[0]}-{case[1]}-k{case[2]:g}")
def test_frequency_table(case):
    theory, bend_elements, k = case
    frequency, out_of_plane = modes_on_springs(tube(theory, bend_elements), k, 7)
    expected = TABLE[case].split()
    assert frequency == pytest.approx([float(entry[:-1]) for entry in expected], rel=1e-3)
    assert ["O" if share > 0.5 else "I" for share in out_of_plane] == [entry[-1] for entry in expected]


@pytest.mark.parametrize("points", [1, 2, 3, 5, 9])
def test_first_frequency_by_number_of_contact_points(points):
    structure = tube(points=points)
    for k in (4.0e6, 1.0e9):
        frequency, _ = modes_on_springs(structure, k, 1)
        assert frequency[0] == pytest.approx(FIRST_BY_POINTS[k, points], rel=1e-4)


def test_mass_of_the_tube_in_its_first_out_of_plane_motion():
    # Moved as one along y, the nodes that the roots leave free carry all but what the first and last element hand to the clamp.
    structure = tube(bend_elements=80)
    along = (np.arange(structure.dofs) % 6 == 1).astype(float)
    total = 8330.0 * np.pi * (0.02222 - 0.00127) * 0.00127 * (1.4 + 0.3 * np.pi)
    assert along @ (structure.mass @ along) == pytest.approx(total, rel=0.02)
