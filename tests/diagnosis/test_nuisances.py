"""An effect beside nuisances that were fitted without it."""

import numpy as np
import pytest

from tests.diagnosis.played import played
from vibroimpact.diagnosis.bench import misfit
from vibroimpact.diagnosis.coordinates import to_vector
from vibroimpact.diagnosis.explanations import Point, Term
from vibroimpact.diagnosis.gauss_newton import fit
from vibroimpact.diagnosis.nuisances import nuisances_at
from vibroimpact.diagnosis.screening import gains_of, screen
from vibroimpact.effects.registry import EFFECTS


@pytest.fixture(scope="module")
def larger_gap(comparison):
    """The Nuisances about nothing, fitted to the motion with a gap 1.06 times as large: common
    gains take on a part of it.
    """
    lower = comparison.screened().on(slice(1))
    hidden = played(lower, Point((Term("gap", "all", (1.06,)),)))
    nothing = fit(hidden, Point(), comparison.nuisances(), 6).point
    return nuisances_at(hidden, nothing, comparison.nuisances())


def test_gains_take_on_a_part_of_a_gap(larger_gap):
    assert np.mean(larger_gap.base.gain) > 0.02


def test_a_gap_is_found_beside_gains_that_stand_for_it(larger_gap, comparison):
    found = screen(larger_gap, [EFFECTS["gap"]], comparison).ranked[0]
    assert found.point.terms[0].location == "all"
    assert found.point.terms[0].values[0] == pytest.approx(1.06, abs=0.03)
    at_its_gains = found.point.terms[0]
    [alone] = gains_of(larger_gap, [larger_gap.base.beside(at_its_gains)])
    assert found.gain > 2.0 * max(alone, 1.0)


def test_no_step_of_nuisances_makes_a_point_worse(larger_gap):
    lines, bench = larger_gap.lines, larger_gap.bench
    x = to_vector(larger_gap.base, larger_gap.rows)
    assert larger_gap.now <= misfit(bench, lines) + 0.5 * float(x @ x)
    seen = int(np.argmax(np.abs(larger_gap.columns).sum(axis=(1, 2, 3))))
    moved = lines + 4.0 * larger_gap.columns[seen]
    stayed = misfit(bench, moved) + 0.5 * float(x @ x)
    assert larger_gap.objective(moved, larger_gap.base) < stayed - 1.0
    assert larger_gap.objective(np.nan * lines, larger_gap.base) == np.inf
