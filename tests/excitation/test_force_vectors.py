"""Where forces act: several points with signs, line loads against closed-form deflections, and the
inertia of a moving base.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from evidence.validation.reference.frequencies import MATERIAL, SECTION, straight_tube
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.excitation.force_vectors import force_vector, line_load
from vibroimpact.structure.beam_elements import section_beam

X = (1.0, 0.0, 0.0)


def place_on(tube):
    """Function name -> displacement rows; names are heights in metres."""
    return lambda name: tube.displacement_rows(float(name))


def force(**changes):
    """A force along x at 0.5 m."""
    keys = {"kind": "band_limited", "point": "0.5", "direction": X, "turn_deg": 0.0, "factor": 1.0}
    return SimpleNamespace(**{**keys, "also": (), "distributed": (), **changes})


def test_a_line_load_bends_a_pinned_beam_by_5_over_384():
    tube = straight_tube(
        "pinned-pinned", 8, 2.0
    )  # a node at the middle, where the elements are exact
    load = SimpleNamespace(from_m=(0.0, 0.0, 0.0), to_m=(0.0, 0.0, 2.0), direction=X)
    middle = (
        X @ tube.displacement_rows(1.0) @ spsolve(tube.stiffness.tocsc(), line_load(tube, load))
    )
    assert middle == pytest.approx(
        5.0
        * 2.0**4
        / (
            384.0
            * section_beam(StageSettings(SECTION), StageSettings(MATERIAL), "euler_bernoulli")
            .planes[0]
            .bending_stiffness
        ),
        rel=1e-6,
    )


def test_a_line_load_over_part_of_the_tube_sums_to_its_length():
    tube = straight_tube("free-free", 9, 2.0)
    load = SimpleNamespace(
        from_m=(0.0, 0.0, 1.37), to_m=(0.0, 0.0, 0.4), direction=X
    )  # ends between nodes, in any order
    moved = (np.arange(tube.dofs) % 6 == 0).astype(float)
    assert line_load(tube, load) @ moved == pytest.approx(0.97, rel=1e-12)


def test_points_with_signs_add_up():
    tube = straight_tube("clamped-clamped", 10, 2.0)
    one = force(factor=2.0)
    both = force(factor=2.0, also=(SimpleNamespace(point="1.3", direction=X, factor=-0.6),))
    expected = 2.0 * tube.displacement_rows(0.5)[0] - 0.6 * tube.displacement_rows(1.3)[0]
    assert force_vector(tube, place_on(tube), both) == pytest.approx(expected, abs=1e-14)
    assert not np.array_equal(force_vector(tube, place_on(tube), one), expected)


def test_a_turned_force_is_shared_by_the_axes():
    tube = straight_tube("clamped-clamped", 10, 2.0)
    turned = force(turn_deg=30.0)
    rows = tube.displacement_rows(0.5)
    assert force_vector(tube, place_on(tube), turned) == pytest.approx(
        np.sqrt(0.75) * rows[0] + 0.5 * rows[1], abs=1e-14
    )


def test_a_moving_base_pulls_with_the_whole_mass_of_a_free_tube():
    tube = straight_tube("free-free", 9, 2.0)
    row = force_vector(
        tube, None, SimpleNamespace(kind="base_motion", direction=X, obstacles="moving")
    )
    area = np.pi * (0.02222 - 0.00127) * 0.00127
    assert row @ (np.arange(tube.dofs) % 6 == 0) == pytest.approx(-8330.0 * area * 2.0, rel=1e-9)
