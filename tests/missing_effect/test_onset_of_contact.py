"""Records at the onset of contact are told by what a few percent of clearance change in them."""

from dataclasses import replace

import numpy as np

from tests.white_null import white_null
from vibroimpact.missing_effect.null import at_onset

RECORDS, RUNS, VALUES = 3, 8, 40


def null_and_features():
    """Return (Null of records without a difference, features (record, run, value) of its runs)."""
    null = replace(
        white_null(np.zeros(RECORDS * VALUES)),
        records=np.arange(RECORDS),
        mean=np.zeros((RECORDS, VALUES)),
        factor=np.tile(np.eye(VALUES), (RECORDS, 1, 1)),
    )
    return null, np.random.default_rng(5).standard_normal((RECORDS, RUNS, VALUES))


def test_a_record_is_told_by_either_side():
    null, features = null_and_features()
    smaller = np.random.default_rng(6).standard_normal(features.shape)  # chance alone
    larger = np.array(features)
    larger[1] += 1.5
    larger[2] += 0.5
    assert at_onset(null, features, [smaller, features]).tolist() == []
    assert at_onset(null, features, [smaller, larger]).tolist() == [1]
    assert at_onset(null, features, [larger, smaller]).tolist() == [1]


def test_runs_that_were_thrown_off_do_not_count():
    null, features = null_and_features()
    thrown = np.array(features)
    thrown[1, 0] = np.nan
    assert at_onset(null, features, [features, thrown]).tolist() == []
