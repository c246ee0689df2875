"""Shards of the suite: which campaigns each judges, and how what was judged in several places
becomes one table.
"""

import pytest

from tests.discrepancy.test_suite_difference import written
from tests.unit.test_suite_page import effect, verdict_of
from vibroimpact.acceptance.rates import rates, read, read_shards, read_table
from vibroimpact.acceptance.shards import numbers_added, numbers_judged, shard_of
from vibroimpact.records import write_table

FOUND = effect("dry_friction", "mu", 0.21, 0.16, 0.24)
VERDICTS = [
    verdict_of("named", [["dry_friction"]], [FOUND]),
    verdict_of("ambiguous", [["dry_friction"], ["gap"]]),
    verdict_of("unknown", before_dB=None),
    verdict_of("none"),
]


@pytest.fixture
def shards(tmp_path):
    """The folder of a suite with four campaigns, and another place's campaigns.csv of the last
    two.
    """
    folder = written(tmp_path / "suite_5", VERDICTS)
    elsewhere = written(tmp_path / "elsewhere" / "suite_5", VERDICTS)
    write_table(read(elsewhere)[2:], tmp_path / "campaigns.csv")
    return folder, tmp_path / "campaigns.csv"


def test_shards_add_up():
    assert sorted([*shard_of(11, "0/3"), *shard_of(11, "1/3"), *shard_of("11", "2/3")]) == list(
        range(11)
    )


@pytest.mark.parametrize(
    ("count", "shard", "named"),
    [
        ("many", "0/1", "count = many"),
        ("0", "0/1", "count = 0"),
        ("-3", "0/1", "count = -3"),
        ("9", "3/3", "shard = 3/3"),
        ("9", "1", "shard = 1"),
        ("9", "0/0", "shard = 0/0"),
        ("9", "a/b", "shard = a/b"),
    ],
)
def test_invalid_shard_is_refused(count, shard, named):
    with pytest.raises(ValueError, match=f"^{named}: give"):
        shard_of(count, shard)


def test_a_table_is_read_as_it_was_written(shards):
    folder, file = shards
    assert repr(read_table(file)) == repr(read(folder)[2:])  # NaN is not equal to itself


def test_imported_verdicts_count_once(shards):
    folder, file = shards
    assert (
        numbers_judged(folder) == [0, 1, 2, 3]
        and numbers_added([file], "suite_5") == {2, 3}
        and numbers_added([], "suite_5") == set()
    )
    whole = read_shards(folder, [])
    assert repr(read_shards(folder, [file])) == repr(whole)
    for number in (2, 3):
        (folder / f"campaign_{number:04d}" / "verdict.json").unlink()
    assert numbers_judged(folder) == [0, 1] and repr(rates(read_shards(folder, [file]))) == repr(
        rates(whole)
    )


def test_the_table_of_another_suite_is_refused(shards, tmp_path):
    with pytest.raises(
        ValueError,
        match=r"campaigns.csv holds campaigns of suite_5: give a campaigns.csv of suite_6",
    ):
        numbers_added([shards[1]], "suite_6")
    with pytest.raises(ValueError, match="nothing.csv is not there"):
        numbers_added([tmp_path / "nothing.csv"], "suite_5")
    (tmp_path / "nothing.csv").write_text("suite,campaign\n")
    with pytest.raises(ValueError, match="nothing.csv holds no campaign"):
        numbers_added([tmp_path / "nothing.csv"], "suite_5")
