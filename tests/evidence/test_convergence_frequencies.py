"""Frequencies converge with mesh and contact points at the orders that theory gives."""

import numpy as np
import pytest

from evidence.validation.convergence import contact_points
from evidence.validation.convergence import mesh as convergence_mesh
from evidence.validation.convergence.rate import extrapolated, fitted_order, successive_changes
from vibroimpact.config.reading import changed_config
from vibroimpact.structure.tube import build_structure


def failed(checks):
    """Return what did not pass."""
    return [check.row() for check in checks if not check.passed]


@pytest.fixture(scope="module")
def mesh_rows(study_config):
    """Return the rows of both refinements at the contact's stiffness."""
    return convergence_mesh.mesh_rows(study_config, refined=("legs", "bend"), stiffness=(4.0e6,))


def test_convergence_order_of_a_known_sequence():
    sizes = 0.5 ** np.arange(5)
    values = 3.0 + 0.7 * sizes**4
    assert fitted_order(sizes[:-1], successive_changes(values)) == pytest.approx(4.0)
    assert extrapolated(values, 4.0) == pytest.approx(3.0, abs=1e-12)
    with pytest.raises(ValueError, match="2 or more sizes"):
        fitted_order(sizes[:1], values[:1])


def test_frequencies_converge_at_the_theoretical_order(mesh_rows):
    checks = convergence_mesh.mesh_checks(mesh_rows)
    assert len(checks) == 6 and failed(checks) == []


def test_bend_error_is_that_of_chords_for_arcs(mesh_rows):
    # theta²/24 is the share by which a chord is shorter than its arc; a shorter bend is stiffer.
    own = {
        row["elements_per_bend"]: row["frequency_Hz"]
        for row in mesh_rows
        if (row["refined"], row["theory"], row["mode"]) == ("bend", "timoshenko", 1)
    }
    limit = extrapolated([own[80], own[160]], 2.0)
    assert 0.5 < (own[20] / limit - 1.0) / ((np.pi / 20) ** 2 / 24) < 2.5


@pytest.mark.parametrize("points", [2, 3, 5, 9])
def test_equal_points_turn_stiffer_than_the_layer(study_config, points):
    contact = build_structure(changed_config(study_config, {"supports.points": points})).contact
    place = contact.arc_length[contact.support == 0]
    moment = contact.weight[contact.support == 0] @ (place - place.mean()) ** 2
    height = study_config.supports[0].height_m
    assert moment / (height**2 / 12.0) == pytest.approx((points + 1) / (points - 1))


def test_published_first_frequencies_by_number_of_points(study_config):
    assert failed(contact_points.published_checks(study_config)) == []


def test_first_frequency_converges_with_contact_points(
    study_config,
):
    checks = contact_points.order_checks(
        contact_points.refinement_rows(study_config, stiffness=(4.0e6,))
    )
    assert len(checks) == 2 and failed(checks) == []


def test_one_contact_point_never_clamps_the_tube(study_config):
    rows = contact_points.contact_point_rows(
        study_config,
        sharing=(("equal", 1), ("equal", 5)),
        stiffness=np.array([1.0, 1e5, 4e6, 1e8, 1e9]),
    )
    (to_contact,) = contact_points.five_points_checks(study_config, rows)
    assert to_contact.passed, to_contact.row()
    farthest = max((row["from_layer"] for row in rows if row["points"] == 5), key=abs)
    assert (
        0.015 < farthest < 0.025
    )  # the layer is left by 2 % at 1e8 N/m: the equal points turn 1.5 times too stiff
    one = next(
        row["from_layer"] for row in rows if (row["points"], row["stiffness_N_per_m"]) == (1, 1e9)
    )
    assert one < -0.14
