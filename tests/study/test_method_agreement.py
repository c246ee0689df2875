"""Verdicts, spans over seeds, and how the gaps collapse."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.identify.estimate import METHODS, Estimate, table_rows, unresolved
from vibroimpact.study.agreement_dataset import consistency_dataset
from vibroimpact.study.equivalent_table import equivalent_rows
from vibroimpact.study.method_agreement import (
    COMPARED,
    collapse_rows,
    consistency_rows,
    summary_rows,
)

ALL = SimpleNamespace(group="all", direction="y")


def case(k, seed, load=5.0, gap=2.0e-4, silent=(), place=None, **others):
    """The rows of a case in which every method gives k, but for others (method=value) and silent
    methods.
    """
    estimates = [
        (
            unresolved(method, f"{method} sees nothing")
            if method in silent
            else Estimate(
                method, others.get(method, k), 0.1 * k, others.get(f"c_{method}", 50.0), 5.0
            )
        ).at(place or ALL)
        for method in METHODS
    ]
    return table_rows(estimates, {"gap_m": gap, "load_rms_N": load, "seed": seed})


def summary_of(*tables):
    return {row["method"]: row for row in summary_rows(consistency_rows(tables))}


def test_methods_within_a_quarter_of_the_median_agree():
    found = summary_of(
        *(
            case(1.0e5 * factor, seed, ods=0.8e5 * factor, broadband=1.2e5 * factor)
            for seed, factor in enumerate((0.9, 1.0, 1.3, 1.0))
        )
    )
    lscf = found["lscf"]
    assert (lscf["k_median"], lscf["k_low"], lscf["k_high"]) == pytest.approx((1.0e5, 0.9e5, 1.3e5))
    assert lscf["verdict_k"] == "agree" and lscf["ratio"] == pytest.approx(1.0)
    assert found["ods"]["ratio"] == pytest.approx(0.8) and found["broadband"][
        "ratio"
    ] == pytest.approx(1.2)
    assert (lscf["c_median"], lscf["load_over_gap"]) == pytest.approx((50.0, 2.5e4))


@pytest.mark.parametrize("method", ["lscf", "ods", "broadband"])
def test_one_method_off_by_more_differs_or_is_a_spread(method):
    for off in (1.3e5, 0.7e5):
        alone = summary_of(case(1.0e5, 0, **{method: off}))
        assert alone["lscf"]["verdict_k"] == "differ"  # of one seed: no interval overlaps
        wide = [case(1.0e5, seed, **{method: off + step}) for seed, step in enumerate((-4e4, 4e4))]
        assert summary_of(*wide)["lscf"]["verdict_k"] == "spread"
    assert summary_of(case(1.0e5, 0, peak_half=9.0e5, secant=1.0))["lscf"]["verdict_k"] == "agree"


@pytest.mark.parametrize("c, verdict", [(62.4, "agree"), (62.6, "differ"), (39.0, "differ")])
def test_dampings_that_differ_by_a_quarter_do_not_agree(c, verdict):
    found = summary_of(case(1.0e5, 0, c_broadband=c))
    assert found["lscf"]["verdict_c"] == found["broadband"]["verdict_c"] == verdict
    assert found["lscf"]["verdict_k"] == "agree"


def test_only_compared_methods_carry_a_verdict():
    found = summary_of(case(1.0e5, 0))
    assert {name for name, row in found.items() if row["verdict_k"]} == set(COMPARED)
    assert {name for name, row in found.items() if row["verdict_c"]} == {"lscf", "broadband"}


def test_every_unresolved_row_says_why():
    tables = [case(1.0e5, seed, silent=("ods",) if seed else ()) for seed in range(3)]
    found = summary_of(*tables)
    assert found["ods"]["reason"] == "not resolved in 2 of 3 seeds: ods sees nothing"
    assert found["lscf"]["reason"] == ""
    rows = summary_rows(consistency_rows([case(1.0e5, 0, silent=COMPARED)]))
    assert all(row["reason"] for row in rows if not np.isfinite(row["k_median"]))


def answer_of(*tables):
    """The first row of equivalent.csv."""
    return equivalent_rows(summary_rows(consistency_rows(tables)), [("all", "x")])[0]


VALUES = {"lscf": 1.0e5, "ods": 1.2e5, "broadband": 3.0e5}


def test_two_methods_recommend_a_stiffness_one_does_not():
    two = answer_of(case(1.0, 0, silent=("broadband",), **VALUES))
    assert (two["k_N_per_m"], two["k_low"], two["k_high"]) == (1.1e5, 1.0e5, 1.2e5)
    assert two["agreement_k"] == "partial"
    assert two["reason_k"] == (
        "two of three methods resolve k; broadband PSD: broadband sees nothing"
    )
    assert two["reason_c"].startswith("one of two methods resolves c; broadband PSD: ")
    one = consistency_rows([case(1.0, 0, silent=("ods", "lscf"), **VALUES)])
    alone = equivalent_rows(summary_rows(one), [("all", "x")])
    assert np.isnan(alone[0]["k_N_per_m"]) and np.isnan(alone[0]["c_N_s_per_m"])
    assert alone[0]["reason_k"] == (
        "only broadband PSD 300 kN/m, and two methods must resolve it; LSCF pole: lscf sees nothing"
    )
    assert alone[1]["direction"] == "x" and "does not move" in alone[1]["reason_k"]


def test_methods_that_differ_recommend_nothing():
    for silent in ((), ("ods",)):
        row = answer_of(case(1.0, 0, silent=silent, **VALUES))
        assert np.isnan([row["k_N_per_m"], row["k_low"], row["c_N_s_per_m"], row["k_bound"]]).all()
        assert row["agreement_k"] == "differ"
        assert row["reason_k"].startswith("the methods differ: LSCF pole 100 kN/m, ")
    near = [case(1.0, seed, **VALUES | {"ods": ods}) for seed, ods in enumerate((0.9e5, 3.1e5))]
    wide = [case(1.0, seed, **{**VALUES, "broadband": k}) for seed, k in enumerate((0.9e5, 3.2e5))]
    assert answer_of(*near)["agreement_k"] == "differ"  # lscf and broadband still do
    row = answer_of(*wide)
    assert (row["agreement_k"], row["k_N_per_m"]) == ("spread", 1.2e5)
    assert row["reason_k"].startswith("the methods are more than 25 % apart: LSCF pole 100 kN/m")


def test_dampings_that_differ_leave_the_stiffness():
    row = answer_of(case(1.0e5, 0, c_broadband=219.0, c_lscf=840.0))
    assert row["k_N_per_m"] == 1.0e5 and np.isnan(row["c_N_s_per_m"])
    assert row["reason_c"] == "the methods differ: LSCF pole 840 N s/m, broadband PSD 219 N s/m"


def flagged_case(seed, method, text, **values):
    """The rows of a case in which the estimate of one method has a flag."""
    rows = case(1.0e5, seed, **values)
    return [row | {"flag": text if row["method"] == method else ""} for row in rows]


def test_a_flagged_estimate_takes_no_part():
    """A U-bend: the pole of another mode must not be averaged with the broadband comparison."""
    values = {"lscf": 2.07e4, "broadband": 8.83e4}
    text = "mode crossing: the pole of 61 Hz is that of another mode"
    row = answer_of(flagged_case(0, "lscf", text, silent=("ods",), **values))
    assert np.isnan(row["k_N_per_m"]) and "only broadband PSD 88.3 kN/m" in row["reason_k"]
    assert text in row["reason_k"] and row["flag"] == f"lscf: 1 of 1 seeds: {text}"
    three = answer_of(flagged_case(0, "lscf", text, ods=8.5e4, **values))
    assert three["k_N_per_m"] == pytest.approx(8.665e4)
    assert (three["k_low"], three["agreement_k"]) == (8.5e4, "partial")
    assert three["c_N_s_per_m"] == 50.0 and "one of two methods resolves c" in three["reason_c"]


def test_the_sound_seeds_of_a_method_still_count():
    seeds = [flagged_case(0, "lscf", "mode crossing", lscf=9.0e5), case(1.0e5, 1), case(1.1e5, 2)]
    found = summary_of(*seeds)["lscf"]
    assert (found["k_median"], found["k_high"], found["verdict_k"]) == (1.05e5, 1.1e5, "agree")
    assert found["flag"] == "1 of 3 seeds: mode crossing"


def bounded(seed, bounds, touching, **values):
    """The rows of a case in which methods give only a bound of k."""
    rows = case(2.0e3, seed, silent=tuple(bounds), **values)
    for row in rows:
        row["k_bound"] = bounds.get(row["method"], np.nan)
        row["contact_fraction"] = touching
    return rows


def test_a_stiffness_that_most_methods_know_weakly_says_so():
    note = {"quality": "weak", "reason": "standard error 27% of k"}
    rows = [case(1.0e5, seed) for seed in range(2)]
    weak = [[row | note if row["method"] != "ods" else row for row in table] for table in rows]
    assert summary_of(*weak)["lscf"]["reason"] == "weak: standard error 27% of k"
    row = answer_of(*weak)
    assert (row["k_N_per_m"], row["agreement_k"]) == (1.0e5, "agree")
    assert row["reason_k"] == "2 of 3 methods are weak: standard error 27% of k"
    assert row["reason_c"] == ""
    one = [[row | note if row["method"] == "ods" else row for row in table] for table in rows]
    assert answer_of(*one)["reason_k"] == ""


def test_an_unresolved_stiffness_has_an_upper_bound():
    bounds = {"lscf": 2.4e3, "ods": 7.2e3, "broadband": 2.7e3}
    row = answer_of(bounded(0, bounds, 0.003), bounded(1, bounds | {"lscf": 2.5e3}, 0.003))
    assert (row["k_bound"], row["contact_fraction"]) == (2.5e3, 0.003)
    assert (
        row["reason_k"]
        == row["reason_c"]
        == ("k < 2.5 kN/m: the tube hardly touches, 0.3 % of the time")
    )
    assert "the tube touches nothing" in answer_of(bounded(0, bounds, 0.0))["reason_k"]
    assert "though the tube touches 20 %" in answer_of(bounded(0, bounds, 0.2))["reason_k"]
    assert answer_of(bounded(0, bounds, np.nan))["reason_k"].endswith("tell from no support")
    one = answer_of(bounded(0, {"lscf": 2.4e3, "ods": 7.2e3}, 0.01, broadband=3.0e3))
    assert one["k_bound"] == 3.0e3  # not below what another method resolves
    two = answer_of(bounded(0, {"ods": 7.2e3}, 0.01, broadband=2.1e3))
    assert np.isnan(two["k_bound"])
    assert two["reason_k"].endswith("resolve k; deflection shape: does not tell k from none")


def test_the_pole_alone_resolves_no_one_of_several_supports():
    """It only corrects what the broadband comparison found."""
    places = [SimpleNamespace(group=name, direction="x") for name in ("left", "right")]
    rows = [
        *case(1.0e5, 0, place=places[0]),
        *case(1.0e5, 0, silent=("broadband",), place=places[1]),
    ]
    left, right = equivalent_rows(summary_rows(consistency_rows([rows])))
    assert (left["agreement_k"], right["agreement_k"]) == ("agree", "unresolved")
    assert np.isnan(right["k_N_per_m"])
    assert right["reason_k"].startswith("only deflection shape 100 kN/m, and two methods must")


def test_of_several_supports_the_shape_must_see_what_it_can():
    # lscf and broadband are one reading of several supports.
    rows = []
    for direction, silent in (("x", ("ods",)), ("y", ())):
        place = SimpleNamespace(group="all", direction=direction)
        for load, missing in ((1.0, ("ods",)), (5.0, silent)):
            rows += case(1.0e5, 0, load=load, silent=missing, place=place)
    table = equivalent_rows(summary_rows(consistency_rows([rows])))
    found = {(row["direction"], row["load_rms_N"]): row["k_N_per_m"] for row in table}
    (lost,) = [row for row in table if np.isnan(row["k_N_per_m"])]
    assert lost["reason_k"] == (
        "only broadband PSD 100 kN/m, and two methods must resolve it; deflection shape: ods sees"
        " nothing"
    )
    assert found["x", 1.0] == found["x", 5.0] == 1.0e5  # the shape never sees x
    assert np.isnan(found["y", 1.0]) and found["y", 5.0] == 1.0e5


def test_method_unresolved_by_half_the_seeds_is_open():
    half = summary_of(case(1.0e5, 0), case(1.0e5, 1, silent=("ods",)))
    assert half["ods"]["k_median"] == 1.0e5 and half["ods"]["verdict_k"] == "agree"
    found = summary_of(
        case(1.0e5, 0), case(1.0e5, 1, silent=("ods",)), case(1.0e5, 2, silent=("ods",))
    )
    assert (
        np.isnan(found["ods"]["k_median"])
        and found["lscf"]["verdict_k"] == "partial"
        and np.isnan(found["lscf"]["ratio"])
    )


def test_rows_are_ordered_and_the_dataset_holds_them():
    rows = consistency_rows(
        [case(2.0e5, 1, load=10.0), case(1.0e5, 0, gap=1.0e-4), case(1.0e5, 0, silent=("ods",))]
    )
    assert [(row["gap_m"], row["load_rms_N"]) for row in rows[::8]] == [
        (2.0e-4, 5.0),
        (2.0e-4, 10.0),
        (1.0e-4, 5.0),
    ]
    dataset = consistency_dataset(rows, summary_rows(rows))
    assert (dataset["group"].item(), dataset["direction"].item()) == ("all", "y")
    dataset = dataset.isel(support_direction=0)
    assert dict(dataset.sizes) == {"gap": 2, "load": 2, "seed": 2, "method": 8}
    place = {"gap": 2.0e-4, "load": 10.0, "method": "lscf"}
    assert float(dataset["k"].sel(place | {"seed": 1})) == 2.0e5 and np.isnan(
        float(dataset["k"].sel(place | {"seed": 0}))
    )
    assert float(dataset["k_median"].sel(place)) == 2.0e5
    assert dataset["quality"].attrs["flag_meanings"] == "ok weak unresolved"
    assert (
        int(dataset["quality"].sel({"gap": 2.0e-4, "load": 5.0, "seed": 0, "method": "ods"})) == 2
    )
    words = dataset["verdict_k"].attrs["flag_meanings"].split()
    verdicts = [[words[index] for index in row] for row in dataset["verdict_k"].values]
    assert verdicts == [["partial", "agree"], ["agree", "unresolved"]]


def test_scaled_gaps_collapse_on_one_curve():
    # k = 4 load/gap for two gaps with different loads: interpolation in logarithms is exact for a
    # power law
    tables = [
        case(4.0 * load / gap, 0, load=load, gap=gap)
        for gap, loads in ((2.0e-4, (2.0, 4.0, 8.0)), (1.0e-4, (1.5, 3.0, 6.0)))
        for load in loads
    ]
    rows = collapse_rows(summary_rows(consistency_rows(tables)))
    lscf = [row for row in rows if row["method"] == "lscf"]
    assert len(lscf) == 4 and all(
        row["k_ratio"] == pytest.approx(1.0) and row["gaps"] == 2 for row in lscf
    )
    assert lscf[0]["k_smallest"] == pytest.approx(4.0 * lscf[0]["load_over_gap"])
    off = [
        case(4.0 * load / gap * (1.0 + (gap < 1.5e-4)), 0, load=load, gap=gap)
        for gap in (2.0e-4, 1.0e-4)
        for load in (2.0e4 * gap, 4.0e4 * gap)
    ]
    assert [
        row["k_ratio"]
        for row in collapse_rows(summary_rows(consistency_rows(off)))
        if row["method"] == "ods"
    ] == pytest.approx([2.0, 2.0])
