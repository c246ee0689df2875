"""Coordinates, and Gauss-Newton on the holding force of a played measurement."""

import numpy as np
import pytest

from tests.diagnosis.played import played
from vibroimpact.diagnosis.coordinates import (
    NUISANCES,
    effect_coordinates,
    nuisance_coordinates,
    to_point,
    to_vector,
)
from vibroimpact.diagnosis.explanations import Point, Term
from vibroimpact.diagnosis.gauss_newton import fit, fits
from vibroimpact.diagnosis.run_cost import SIMULATED


def test_coordinates_come_back(comparison):
    terms = (
        Term("gap", "left", (0.8,)),
        Term("support_offset", "right", (3e-5, -2e-5)),
        Term("cubic_stiffness", "arc_355_6mm_turned_m9_5deg", (2e9,)),
    )
    point = Point(terms, (0.001, -0.002), (0.1,), (0.0, 0.01), (0.02,))
    nuisances = nuisance_coordinates(2, 2, True)
    rows = [*effect_coordinates(terms, comparison.sizes), *nuisances]
    back = to_point(to_vector(point, rows), rows, point)
    assert [term.location for term in back.terms] == [term.location for term in terms]
    for one, other in zip(back.terms, terms, strict=True):
        assert one.values == pytest.approx(other.values)
    for kind in NUISANCES:
        own = getattr(point, kind)
        assert getattr(back, kind)[: len(own)] == pytest.approx(own)


@pytest.mark.parametrize(
    ("hidden", "start", "tolerance"),
    [
        (Term("gap", "all", (0.8,)), (1.0,), 0.01),
        (Term("support_offset", "left", (4e-5, -6e-5)), (0.0, 0.0), 0.03),
        (Term("contact_damping", "all", (400.0,)), (0.0,), 0.05),
    ],
    ids=["gap", "offset", "damping"],
)
def test_hidden_contact_is_measured_from_remote_sensors(comparison, hidden, start, tolerance):
    """From the model as given; none of the sensors is at a support."""
    bench = played(comparison.fitted(), Point((hidden,)))
    begun = Point((Term(hidden.effect_id, hidden.location, start),))
    found = fit(bench, begun, effect_coordinates(begun.terms, comparison.sizes), 8)
    size = max(map(abs, hidden.values))
    np.testing.assert_allclose(found.point.terms[0].values, hidden.values, atol=tolerance * size)


@pytest.mark.slow
def test_a_coordinate_that_nothing_shows_holds_no_other(comparison):
    """The translation of a root, as good as clamped beside its rotation."""
    size = comparison.sizes["tube_rotation"]
    hidden = Term("root_stiffness", "roots", (1.0e8, size))
    bench = played(comparison.fitted(), Point((hidden,)))
    begun = Point((Term("root_stiffness", "roots", (1.0e8, 1.3 * size)),))
    found = fit(bench, begun, effect_coordinates(begun.terms, comparison.sizes), 12)
    assert found.point.terms[0].values[1] == pytest.approx(size, rel=0.02)


def test_a_mass_is_found_where_it_sits(comparison):
    bench = played(comparison.fitted(), Point((Term("added_mass", "arc_800_0mm", (0.06,)),)))
    begun = Point((Term("added_mass", "arc_900_0mm", (0.02,)),))
    found = fit(bench, begun, effect_coordinates(begun.terms, comparison.sizes), 12)
    (term,) = found.point.terms
    place = float(term.location.removeprefix("arc_").removesuffix("mm").replace("_", "."))
    assert place == pytest.approx(800.0, abs=5.0) and term.values[0] == pytest.approx(
        0.06, rel=0.02
    )


def test_a_named_gain_holds_all_of_the_gain_of_its_channel():
    point = Point((Term("sensor_gain", "b", (1.3,)),), gain=(0.01, 0.08))
    found = point.with_own_gains(["a", "b"])
    assert found.terms[0].values[0] == pytest.approx(1.3 * np.exp(0.08))
    assert found.gain == (0.01, 0.0)
    assert Point(gain=(0.01,)).with_own_gains(["a", "b"]).gain == (0.01,)


def test_the_direction_of_the_force_is_fitted(comparison):
    hidden = Point(turn=(0.05,))
    rows = [row for row in comparison.nuisances() if row.kind == "turn"]
    found = fit(played(comparison.fitted(), hidden), Point(), rows, 6)
    assert found.point.turn[0] == pytest.approx(0.05, abs=0.005)
    completed = comparison.structure.configuration(comparison.structure.terms(hidden))
    assert completed.excitation.turn_deg == pytest.approx(np.rad2deg(0.05))


def test_a_turned_force_is_turned_about_one_axis(comparison):
    structure = comparison.structure
    turned = Point((Term("force_misalignment", "about_z", (0.1,)),), turn=(0.02,))
    whole = Point((Term("force_misalignment", "about_z", (0.12,)),))
    np.testing.assert_allclose(
        structure.model(turned).drive_shapes, structure.model(whole).drive_shapes, atol=1e-12
    )


def test_fits_side_by_side_are_those_of_one_at_a_time(comparison):
    bench = comparison.screened()
    begun = [
        Point((Term("gap", "left", (0.7,)),)),
        Point((Term("added_mass", "arc_900_0mm", (0.05,)),)),
    ]
    starts = [(point, effect_coordinates(point.terms, comparison.sizes)) for point in begun]
    for start, together in zip(starts, fits(bench, starts, 2), strict=True):
        alone = fit(bench, *start, 2)
        assert together.objective == alone.objective
        np.testing.assert_array_equal(together.x, alone.x)


def test_a_fit_that_can_not_reach_the_best_is_given_up(comparison):
    bench = played(comparison.screened(), Point((Term("gap", "all", (0.8,)),)))
    terms = Term("gap", "all", (0.9,)), Term("added_mass", "arc_900_0mm", (0.2,))
    begun = [Point((term,)) for term in terms]
    starts = [(point, effect_coordinates(point.terms, comparison.sizes)) for point in begun]

    def runs(*chosen):
        before = SIMULATED["records"]
        return fits(bench, chosen, 12), SIMULATED["records"] - before

    (best, _), together = runs(*starts)
    alone = [runs(start) for start in starts]
    assert best.objective == alone[0][0][0].objective
    assert together < sum(number for _, number in alone)
