"""The values that the screening tries."""

import numpy as np

from vibroimpact.diagnosis.bench import holding_lines
from vibroimpact.diagnosis.catalogue import far_terms, locations
from vibroimpact.diagnosis.explanations import Point, Term
from vibroimpact.effects.registry import EFFECTS


def test_every_effect_has_trials_that_can_be_run(comparison):
    """At its first place: values that no structure can have would leave it out of the search."""
    structure, bench = comparison.structure, comparison.screened()
    failed = []
    for effect in EFFECTS.values():
        place = locations(effect, structure.values, structure.names, True, 8)[:1]
        terms = [term for each in place for term in far_terms(effect, each, comparison.sizes)]
        lines = holding_lines(bench, [Point((term,)) for term in terms]) if terms else np.zeros(1)
        if not np.isfinite(lines).reshape(len(lines), -1).all(axis=1).any():
            failed.append(effect.id)
    assert failed == []


def test_values_that_make_no_model_have_no_lines(comparison):
    plate = Term("plate_flexibility", "left", (1.0e5, 0.4, 0.9))  # no fraction of critical damping
    lines = holding_lines(comparison.screened(), [Point((plate,)), Point((plate,))])
    assert lines.shape[:2] == (2, 2) and np.isnan(lines).all()
