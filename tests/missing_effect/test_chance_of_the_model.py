"""How probable a measurement is by chance: with the model as given, and with the completed one."""

from types import SimpleNamespace

import numpy as np

from tests.white_null import white_null
from vibroimpact.missing_effect.verdict import by_chance

VALUES = 40
MEASURED = np.random.default_rng(3).standard_normal((1, VALUES))
NULL = white_null(MEASURED.ravel())


def verified(shift):
    """What is compared of both records, all values off by so much."""
    return SimpleNamespace(compared=np.full((1, VALUES), shift))


def test_model_as_given_lacks_what_the_lowest_record_told():
    """The null holds a mass that was adopted; the model as given does not, and is far off."""
    closed = SimpleNamespace(benches=("given", "whole"), before=verified(5.0), after=verified(0.0))
    before, after = by_chance(NULL, MEASURED.ravel(), MEASURED, closed)
    assert before < 1.0e-6 < 0.05 < after


def test_where_nothing_is_added_both_are_the_same():
    model = verified(0.0)
    closed = SimpleNamespace(benches=("whole", "whole"), before=model, after=model)
    before, after = by_chance(NULL, MEASURED.ravel(), MEASURED, closed)
    assert before == after == NULL.probability()
