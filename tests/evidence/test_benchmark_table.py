"""The benchmark: its table, and that the peers which are always there solve our problem. No times
are asserted.
"""

import csv
from dataclasses import replace

import numpy as np
import pytest

from evidence.benchmarks.check import agreement
from evidence.benchmarks.machines import PLAIN, keep_machine
from evidence.benchmarks.ours import (
    contact_fraction,
    last_energies,
    march_ours,
    schedule_of,
)
from evidence.benchmarks.page import write_page
from evidence.benchmarks.pairs import BATCH, ONE_RUN, PEAK, Pair
from evidence.benchmarks.peers import plain, scipy_ivp
from evidence.benchmarks.problem import FREE_MODES, RATE, tube_problem
from evidence.benchmarks.table import COLUMNS, benchmark_rows, read_csv, write_csv
from vibroimpact.integration import kernel_layout as layout

STEPS_S, LONGER_S = 0.01, 0.012  # recorded; the output filter asks for 800 steps more
HARD_N = 400.0  # contact within a few milliseconds


@pytest.fixture(scope="module")
def problem():
    """A tube on its free modes, hit hard from the first steps on."""
    found = replace(tube_problem(FREE_MODES, "free modes"), load_N=HARD_N)
    assert contact_fraction(found, STEPS_S) > 0.1
    return found


def pairs():
    """Two pairs with round numbers: ours 2 and 4, theirs 20 and 20; and the arithmetic at the
    peak.
    """
    return [
        Pair("a tube", ONE_RUN, "slow", True, False, [2.0, 4.0], [20.0, 20.0]),
        Pair("a tube", ONE_RUN, PEAK, True, True, [2.0, 2.0], [1.0, 1.0]),
    ]


def test_a_machine_replaces_its_own_rows_only(tmp_path, monkeypatch):
    monkeypatch.setattr("evidence.benchmarks.machines.FILE", tmp_path / "machines.csv")
    eight = BATCH.format(8)
    measured = [
        Pair("a tube", ONE_RUN, PLAIN, True, False, [2.0], [4.0]),
        Pair("a tube", eight, PLAIN, True, False, [1.0], [6.0]),
        Pair("a tube", eight, PEAK, True, True, [1.0], [0.2]),
    ]
    slower = [*measured[:1], replace(measured[1], theirs=[5.0]), *measured[2:]]
    for target, pairs_there in (("one", slower), ("other", slower), ("one", measured)):
        keep_machine(benchmark_rows(pairs_there), target, (48.0, 256))
    found = read_csv(tmp_path / "machines.csv")
    assert [(row["target"], row["batch_of_8"]) for row in found] == [("one", "6"), ("other", "5")]
    assert {(row["one_run"], row["peak_share"]) for row in found} == {("2", "0.2")}


def test_the_table_has_its_columns_and_ratios_of_neighbours(tmp_path):
    rows = benchmark_rows(pairs())
    write_csv(tmp_path / "benchmark.csv", COLUMNS, rows)
    with open(tmp_path / "benchmark.csv", encoding="utf-8") as file:
        found = list(csv.DictReader(file))
    assert tuple(found[0]) == COLUMNS
    assert [row["unit"] for row in found] == ["CPU s per simulated s", "ns per step", "ns per step"]
    assert [float(found[0][f"ratio_{name}"]) for name in ("min", "median", "max")] == [
        5.0,
        7.5,
        10.0,
    ]  # the ratio of the medians would be 6.7
    assert float(found[1]["peer_median"]) == pytest.approx(20.0e9 / RATE, rel=1e-5)
    assert float(found[2]["ratio_median"]) == 0.5  # the fraction of the peak that is used


def test_page_lists_every_peer_and_absent_ones(tmp_path):
    absent = ["JAX cannot be imported: install it"]
    write_page(
        tmp_path / "performance.md",
        benchmark_rows(pairs()),
        [],
        [],
        absent,
        {"processor": "one"},
        "figure.png",
    )
    text = (tmp_path / "performance.md").read_text(encoding="utf-8")
    assert "| slow | 7.5; - |" in text
    assert "| one run | 3, 58594, 50 % |" in text
    assert "JAX cannot be imported" in text


def test_plain_loop_and_kernel_agree(problem, monkeypatch):
    """Over 1000 steps and more, hit hard: 1e-12 where both follow the contact iteration to
    round-off, 1e-4 where ours stops as usual.
    """
    schedule = schedule_of(LONGER_S)
    assert schedule.steps >= 1000
    force = problem.force(0.1)[
        : schedule.steps
    ]  # one step more in ours, the first, from zero force to zero force
    q, v = plain.march_to_end(problem, force, passes=60)
    expected = 0.5 * np.sum(v**2), 0.5 * np.sum((problem.model.omega * q) ** 2)
    for tolerance, error in ((1e-4, layout.FIXED_POINT_TOLERANCE), (1e-12, 1e-15)):
        monkeypatch.setattr(layout, "FIXED_POINT_TOLERANCE", error)
        lanes = march_ours(problem, force, schedule)[0]
        assert lanes.tally["contact_steps"].min() > 0.5 * lanes.steps
        energies = last_energies(lanes)
        assert (energies["kinetic"][0], energies["elastic"][0]) == pytest.approx(
            expected, rel=tolerance
        )


@pytest.mark.parametrize("peer", [*plain.peers(), *scipy_ivp.peers()], ids=lambda peer: peer.name)
def test_peers_of_the_ordinary_environment_agree_with_ours(problem, peer):
    found = agreement(peer, problem, STEPS_S)
    assert found.passed, found.sentence()


def test_peer_with_another_gap_is_detected(problem):
    peer = plain.peers()[0]
    other = replace(
        peer,
        start=lambda given, touching: peer.start(
            replace(given, gap_m=1.05 * given.gap_m), touching
        ),
    )
    assert "does NOT agree" in agreement(other, problem, STEPS_S).sentence()
