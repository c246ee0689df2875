"""The recommended k and c of a study, of one group and of several directions."""

import pytest

from tests.support.made_up_study import GAPS, LOADS, rows_of_two_directions, summary_rows
from vibroimpact.reports.equivalent_answer import answers, unmoved
from vibroimpact.study.reasons import NOT_MOVED


def found(rows, gap, load, direction="y"):
    """The Answer of a gap, load and direction."""
    return next(
        row for row in rows if (row.gap_m, row.load_rms_N, row.direction) == (gap, load, direction)
    )


def test_table_of_recommended_values_is_taken_as_it_is():
    rows = answers(summary_rows(), rows_of_two_directions())
    assert len(rows) == len(GAPS) * len(LOADS) * 2
    row = found(rows, 5.0e-5, 10.0, "y")
    # Twice 10 x 10 N / 0.05 mm.
    assert row.group == "plates"
    assert (row.k.value, row.k.low) == pytest.approx((4.0e6, 3.6e6))
    assert (row.c.agreement, row.c.high) == ("spread", pytest.approx(1000.0))
    lowest = found(rows, 5.0e-5, 0.1, "x")
    assert lowest.k.reason == "k = 10 N/m is too small" and lowest.c.reason == "no pole"


def test_curves_are_in_order_of_gap_group_direction_and_load():
    rows = answers(summary_rows(), rows_of_two_directions()[::-1])
    assert [row.place for row in rows[:: len(LOADS)]] == [
        (gap, "plates", direction) for gap in GAPS for direction in "xy"
    ]
    assert [row.load_rms_N for row in rows[: len(LOADS)]] == list(LOADS)


def test_directions_that_nothing_moves_are_named_not_judged():
    both = rows_of_two_directions()
    still = [row | {"reason_k": NOT_MOVED} for row in both if row["direction"] == "x"]
    rows = [row for row in both if row["direction"] == "y"]
    assert unmoved(rows + still) == [("plates", "x")]
    assert {row.direction for row in answers(summary_rows(), rows + still)} == {"y"}
