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
def test_one_method_off_by_more_is_a_spread(method):
    assert summary_of(case(1.0e5, 0, **{method: 1.3e5}))["lscf"]["verdict_k"] == "spread"
    assert summary_of(case(1.0e5, 0, **{method: 0.7e5}))["lscf"]["verdict_k"] == "spread"
    assert summary_of(case(1.0e5, 0, peak_half=9.0e5, secant=1.0))["lscf"]["verdict_k"] == "agree"


@pytest.mark.parametrize("c, verdict", [(62.4, "agree"), (62.6, "spread"), (39.0, "spread")])
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


def test_two_methods_recommend_a_stiffness_one_does_not():
    values = {"lscf": 1.0e5, "ods": 1.2e5, "broadband": 3.0e5}
    three = equivalent_rows(summary_rows(consistency_rows([case(1.0, 0, **values)])))[0]
    assert (three["k_N_per_m"], three["k_low"], three["k_high"]) == (1.2e5, 1.0e5, 3.0e5)
    assert (three["agreement_k"], three["reason_k"]) == ("spread", "")
    two = consistency_rows([case(1.0, 0, silent=("ods",), **values)])
    assert equivalent_rows(summary_rows(two))[0]["k_N_per_m"] == 2.0e5
    one = consistency_rows([case(1.0, 0, silent=("ods", "lscf"), **values)])
    alone = equivalent_rows(summary_rows(one), [("all", "x")])
    assert np.isnan(alone[0]["k_N_per_m"]) and np.isnan(alone[0]["c_N_s_per_m"])
    assert alone[0]["reason_k"] == "lscf: lscf sees nothing; ods: ods sees nothing"
    assert alone[1]["direction"] == "x" and "does not move" in alone[1]["reason_k"]


def test_of_several_supports_the_shape_must_see_what_it_can():
    # lscf and broadband are one reading of several supports.
    rows = []
    for direction, silent in (("x", ("ods",)), ("y", ())):
        place = SimpleNamespace(group="all", direction=direction)
        for load, missing in ((1.0, ("ods",)), (5.0, silent)):
            rows += case(1.0e5, 0, load=load, silent=missing, place=place)
    found = {
        (row["direction"], row["load_rms_N"]): row["k_N_per_m"]
        for row in equivalent_rows(summary_rows(consistency_rows([rows])))
    }
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
        and found["lscf"]["verdict_k"] == "unresolved"
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
    assert dataset["verdict_k"].values.tolist() == [[2, 0], [0, 2]]


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
