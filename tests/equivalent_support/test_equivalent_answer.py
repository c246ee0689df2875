"""The recommended k and c of a study, from the tables of today and from those with directions."""

import math

import numpy as np
import pytest

from tests.support.made_up_study import GAPS, LOADS, equivalent_rows, summary_rows
from vibroimpact.reports.equivalent_answer import answers, unmoved, with_places
from vibroimpact.study.reasons import NOT_MOVED


def found(rows, gap, load, direction="y"):
    """The Answer of a gap, load and direction."""
    return next(
        row for row in rows if (row.gap_m, row.load_rms_N, row.direction) == (gap, load, direction)
    )


def test_recommended_value_is_the_median_of_the_methods():
    row = found(answers(summary_rows(), None, "y"), 2.0e-4, 1.0)
    # Methods: 50, 45 and 55 kN/m, each with 5 % over seeds.
    assert row.k.value == pytest.approx(50e3)
    assert (row.k.low, row.k.high) == pytest.approx((0.95 * 45e3, 1.05 * 55e3))
    assert row.k.agreement == "agree" and row.k.reason == ""
    assert row.c.value == pytest.approx(50.0) and row.c.agreement == "agree"


def test_damping_that_differs_is_never_said_to_agree():
    # 500 and 1000 N s/m lie 33 % from their median; the k of the same case agree.
    row = found(answers(summary_rows(), None, "y"), 5.0e-5, 10.0)
    assert (row.k.agreement, row.c.agreement) == ("agree", "spread")
    assert row.c.value == pytest.approx(750.0)


def test_missing_value_names_the_methods_that_lack_it():
    row = found(answers(summary_rows(), None, "y"), 2.0e-4, 0.1)
    assert math.isnan(row.k.value) and not row.k.resolved
    assert row.k.reason == row.c.reason == "no method resolves k; LSCF pole: no value"


def test_one_missing_method_leaves_a_value_of_two():
    rows = summary_rows()
    for row in rows:
        if row["method"] == "ods" and row["load_rms_N"] == 10.0:
            row["k_median"] = np.nan
    row = found(answers(rows, None, "y"), 2.0e-4, 10.0)
    assert row.k.agreement == "partial"
    assert row.k.reason == "two of three methods resolve k; deflection shape: no value"
    assert row.k.apart == pytest.approx(0.05 / 1.05)


def test_table_of_recommended_values_is_taken_as_it_is():
    rows = answers(summary_rows(), equivalent_rows(), "y")
    assert len(rows) == len(GAPS) * len(LOADS) * 2
    row = found(rows, 5.0e-5, 10.0, "y")
    # Twice 10 x 10 N / 0.05 mm.
    assert row.group == "plates"
    assert (row.k.value, row.k.low) == pytest.approx((4.0e6, 3.6e6))
    assert (row.c.agreement, row.c.high) == ("spread", pytest.approx(1000.0))
    lowest = found(rows, 5.0e-5, 0.1, "x")
    assert lowest.k.reason == "k = 10 N/m is too small" and lowest.c.reason == "no pole"


def test_curves_are_in_order_of_gap_group_direction_and_load():
    rows = answers(summary_rows(), equivalent_rows()[::-1], "y")
    assert [row.place for row in rows[:: len(LOADS)]] == [
        (gap, "plates", direction) for gap in GAPS for direction in "xy"
    ]
    assert [row.load_rms_N for row in rows[: len(LOADS)]] == list(LOADS)


def test_a_group_named_by_a_number_is_a_text():
    row = with_places([{"gap_m": 1e-4, "group": 1, "direction": "x"}], "y")[0]
    assert (row["group"], row["direction"]) == ("1", "x")
    assert with_places([{"gap_m": 1e-4}], "y")[0]["direction"] == "y"
    assert with_places([{"gap_m": 1e-4, "group": ""}], "y")[0]["group"] == "all"


def test_directions_that_nothing_moves_are_named_not_judged():
    still = [row | {"reason_k": NOT_MOVED} for row in equivalent_rows() if row["direction"] == "x"]
    rows = [row for row in equivalent_rows() if row["direction"] == "y"]
    assert unmoved(rows + still) == [("plates", "x")]
    assert {row.direction for row in answers(summary_rows(), rows + still, "y")} == {"y"}
