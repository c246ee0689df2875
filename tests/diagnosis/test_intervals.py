"""Intervals of fitted values."""

import numpy as np
import pytest

from vibroimpact.diagnosis.completed import effect_rows
from vibroimpact.diagnosis.coordinates import effect_coordinates, to_vector
from vibroimpact.diagnosis.explanations import Point, Term
from vibroimpact.diagnosis.gauss_newton import Fit
from vibroimpact.diagnosis.search import Hypothesis


@pytest.mark.parametrize(
    ("term", "least"),
    [
        (Term("contact_damping", "all", (400.0,)), 0.045),  # of two codes, from 0
        (Term("mode_frequency_error", "mode_1", (1.05,)), 0.0022),  # of the change of 5 %
        (Term("gap", "all", (1.0,)), 0.03),  # of a gain common to all, a change of nothing
    ],
    ids=["amount", "factor", "gain"],
)
def test_intervals_hold_what_the_fit_does_not_see(comparison, term, least):
    point = Point((term,))
    rows = tuple(effect_coordinates(point.terms, comparison.sizes))
    certain = 1e12 * np.eye(len(rows))
    fit = Fit(point, rows, to_vector(point, rows), np.zeros(0), 0.0, certain)
    row = effect_rows(Hypothesis(fit, 1.0, 1.0, 0.01), comparison.signals)[0]
    estimate = next(iter(row["parameters"].values()))
    half = (estimate["high"] - estimate["low"]) / 2 / term.values[0]
    assert least < half < 1.5 * least
