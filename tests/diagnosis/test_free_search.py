"""What only free motion shows is looked for by free runs; what can not be run is refused."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.config.reading import check_config
from vibroimpact.diagnosis import free_runs as module
from vibroimpact.diagnosis.coordinates import effect_coordinates
from vibroimpact.diagnosis.decision import decide
from vibroimpact.diagnosis.explanations import Point, Structure, Term
from vibroimpact.diagnosis.free_runs import free_runs
from vibroimpact.diagnosis.free_search import far, free_search
from vibroimpact.diagnosis.gauss_newton import Fit
from vibroimpact.diagnosis.measurement.usable import Refused
from vibroimpact.diagnosis.screening import Screened
from vibroimpact.diagnosis.search import Hypothesis, Search, search
from vibroimpact.effects.registry import EFFECTS

HIDDEN = Point((Term("quadratic_drag", "tube", (60.0,)),))
TRIED = (
    Point((Term("dry_friction", "all", (0.3,)),)),
    Point((Term("quadratic_drag", "tube", (40.0,)),)),
    Point((Term("mode_frequency_error", "mode_3", (1.001,)),)),
    Point((Term("gap", "all", (1.0e4,)),)),  # wider than the tube: it makes no model
)


@pytest.fixture(scope="module")
def played(comparison):
    """(Comparison, FreeRuns of the model as given) beside a free run of the model with drag."""
    structure, signals = comparison.structure, comparison.signals
    response = module._simulated(structure, signals, HIDDEN)[:, 0]
    played = replace(comparison, signals=replace(signals, response=response))
    return played, free_runs(structure, played.signals)


def searched(*points, nuisances=Point()):
    """A search in which nothing gains, and the points that were screened."""
    nothing = Hypothesis(SimpleNamespace(point=nuisances), 0.0, 0.0, 0.0)
    return Search(nothing, (), screened={"nothing": tuple(Screened(p, 0.0) for p in points)})


def test_what_closes_the_spectra_of_free_runs_is_named(played):
    comparison, runs = played
    search_of_nothing = searched(*TRIED)
    none = decide(search_of_nothing, 5.0, 5.0)
    found, after = free_search(comparison, search_of_nothing, none, runs)
    assert none.verdict == "none" and found.verdict == "named" and found.by_free_runs
    assert found.best.ids == ("quadratic_drag",) and found.nothing == 0.0
    assert (after.after != runs.after).any() and (after.before == runs.before).all()
    fit = found.best.fit
    assert abs(fit.rows[0].from_value(60.0) - fit.x[0]) < 1.645 * fit.deviation[0]


@pytest.mark.slow
def test_free_runs_add_an_effect_to_one_that_leaves_spectra_off(played):
    """The first effect, a gap as it is, is what the holding force shows."""
    comparison, runs = played
    rows = effect_coordinates((gap := Term("gap", "all", (1.0,)),), comparison.sizes)
    fit = Fit(Point((gap,)), tuple(rows), np.zeros(1), np.zeros(1), 0.0, np.eye(1))
    base = Hypothesis(fit, 1.0, 1.0, 0.01)
    known = replace(searched(*TRIED), hypotheses=(base,))
    named = replace(decide(known, 5.0, 5.0), surely_off=True)
    runs = replace(runs, after=runs.before.copy())
    found, after = free_search(comparison, known, named, runs)
    assert named.best.ids == ("gap",) and found.verdict == "named"
    assert found.best.point.ids == ["gap", "quadratic_drag"]
    assert found.surely_off == bool(after.surely_off())
    near = replace(named, surely_off=False)
    assert free_search(comparison, known, near, runs) == (near, runs)


def test_nothing_is_named_where_no_trial_closes_the_spectra(played):
    comparison, runs = played
    search_of_nothing = searched(TRIED[2])
    none = decide(search_of_nothing, 5.0, 5.0)
    found, after = free_search(comparison, search_of_nothing, none, runs)
    assert found == none and after.after is runs.before


def test_no_free_trial_is_made_where_spectra_agree(played):
    comparison, runs = played
    agreed = replace(runs, measured=runs.before[:, 0])
    none = decide(searched(*TRIED), 5.0, 5.0)
    found, after = free_search(comparison, searched(*TRIED), none, agreed)
    assert found == none and after.after is runs.before


def test_nothing_is_sought_where_nuisances_close_spectra(comparison):
    """The mean of free runs is measured: whether a single one whirls is chance."""
    structure, signals = comparison.structure, comparison.signals
    louder = Point(gain=(2.0,) * len(signals.names))
    given = free_runs(structure, signals).completed(louder)
    runs = replace(given, measured=given.after.mean(axis=1), after=given.before)
    known = searched(*TRIED, nuisances=louder)
    none = decide(known, 5.0, 5.0)
    found, after = free_search(comparison, known, none, runs)
    assert far(runs) and not far(after)
    assert found == none and (after.before == runs.before).all()
    unknown = replace(none, verdict="unknown")
    assert free_search(comparison, known, unknown, runs)[1].after is runs.before


def test_a_model_that_can_not_be_run_is_refused(comparison):
    """A spring that pulls ever harder to one side has no bounded motion."""
    values, effect = comparison.structure.values, EFFECTS["quadratic_stiffness"]
    values = effect.apply(values, {"coefficient": -4.0e12}, effect.locations(values)[0])
    leaning = Structure(check_config(values, "leaning"), comparison.structure.campaign)
    with pytest.raises(Refused, match="can not be integrated") as refusal:
        search(replace(comparison, structure=leaning))
    assert [row["level"] for row in refusal.value.checks] == ["refuse"]
