"""Records whose contact is at its onset are told from those that touch, and from their scatter."""

import numpy as np

from vibroimpact.missing_effect import constants
from vibroimpact.missing_effect.null import hardly_touching

RUNS, FEATURES = 3, 20


def test_records_that_contact_hardly_changes_are_told():
    untouched = np.random.default_rng(5).standard_normal((4, RUNS, FEATURES))
    features = untouched.copy()
    features[1] += 10.0 * constants.HARDLY_DB
    features[2, :, 0] += 20.0  # one value alone, as after a single touch
    features[3, 0] += 10.0 * constants.HARDLY_DB  # one run of three
    assert hardly_touching(features, untouched).tolist() == [0, 2, 3]


def test_a_run_that_was_thrown_off_is_no_sign_of_none():
    untouched = np.zeros((1, RUNS, FEATURES))
    assert hardly_touching(np.full_like(untouched, np.nan), untouched).tolist() == []
