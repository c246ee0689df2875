"""Lopsided responses: when the skewness of a record breaks the symmetry of a model."""

from types import SimpleNamespace

import numpy as np

from vibroimpact.discrepancy.invariances import one_sided, one_sided_rows

RECORDS, CHANNELS, SEEDS = 3, 7, 16
SPREAD = 3.0  # of a seed's skewness: what two codes differ by plays no part beside it
LAYOUT = SimpleNamespace(kind=np.array(["skewness"] * CHANNELS), channel=np.arange(CHANNELS))
BENCH = SimpleNamespace(
    layout=LAYOUT,
    signals=SimpleNamespace(record_names=("a", "b", "c"), names=tuple("stuvwxy")),
)


def null_of(seeds):
    """A Null of features (record, seed, feature)."""
    return SimpleNamespace(
        records=np.arange(RECORDS),
        mean=seeds.mean(axis=1),
        seed_variance=seeds.var(axis=1, ddof=1),
        seeds=SEEDS,
    )


def draw(random):
    """(Null, measured (record, feature)) of one symmetric model."""
    null = null_of(SPREAD * random.standard_normal((RECORDS, SEEDS, CHANNELS)))
    return null, SPREAD * random.standard_normal((RECORDS, CHANNELS))


def test_symmetric_records_look_lopsided_once_in_a_hundred():
    random, raised = np.random.default_rng(1), 0
    for _ in range(1000):
        null, measured = draw(random)
        raised += one_sided(BENCH, null, measured, null.mean) is not None
    assert 3 <= raised <= 20  # 10 expected, with their Poisson scatter


def test_what_is_told_must_be_lopsided_as_the_record_is():
    null, measured = draw(np.random.default_rng(2))
    assert one_sided_rows(BENCH, null, measured, null.mean) == []
    measured[1, 4] += 12.0 * SPREAD
    (row,) = one_sided_rows(BENCH, null, measured, null.mean)
    assert (row["level"], row["record"], row["channel"]) == ("warn", "b", "w")
    (row,) = one_sided_rows(BENCH, null, measured, measured)
    assert row["level"] == "pass"
