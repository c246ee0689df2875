"""The benchmark: its table, and that the peers which are always there solve our problem. No times
are asserted.
"""

import csv
from dataclasses import replace

import numpy as np
import pytest

from evidence.benchmarks.check import agreement
from evidence.benchmarks.machines import PLAIN, keep_machine
from evidence.benchmarks.newmark import newmark_map
from evidence.benchmarks.ours import (
    contact_fraction,
    displacement,
    last_energies,
    march_ours,
    schedule_of,
)
from evidence.benchmarks.page import write_page
from evidence.benchmarks.pairs import BATCH, ONE_RUN, PEAK, Pair
from evidence.benchmarks.peak import PeakRate, flops_per_step
from evidence.benchmarks.peers import plain, scipy_ivp
from evidence.benchmarks.problem import FREE_MODES, RATE, tube_problem
from evidence.benchmarks.table import COLUMNS, benchmark_rows, read_csv, write_csv
from evidence.benchmarks.work_precision_page import section
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
    assert tuple(found[0]) == (
        "case",
        "quantity",
        "unit",
        "ours_median",
        "peer",
        "peer_median",
        "ratio_median",
        "ratio_min",
        "ratio_max",
    )
    assert [row["unit"] for row in found] == ["CPU s per simulated s", "ns per step", "ns per step"]
    assert [float(found[0][f"ratio_{name}"]) for name in ("min", "median", "max")] == [
        5.0,
        7.5,
        10.0,
    ]  # the ratio of the medians would be 6.7
    assert float(found[1]["peer_median"]) == pytest.approx(20.0e9 / RATE, rel=1e-5)
    assert float(found[2]["ratio_median"]) == 0.5  # the fraction of the peak that is used


def test_rows_with_other_columns_are_refused(tmp_path):
    with pytest.raises(ValueError, match="columns"):
        write_csv(tmp_path / "benchmark.csv", COLUMNS, [{"case": "a tube"}])


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


def test_the_page_from_files_is_the_page_of_the_run(tmp_path):
    rows = benchmark_rows(pairs())
    write_csv(tmp_path / "benchmark.csv", COLUMNS, rows)
    for name, found in (("run", rows), ("files", read_csv(tmp_path / "benchmark.csv"))):
        write_page(tmp_path / f"{name}.md", found, [], [], [], {"processor": "one"}, "figure.png")
    assert (tmp_path / "run.md").read_text(encoding="utf-8") == (tmp_path / "files.md").read_text(
        encoding="utf-8"
    )
    assert read_csv(tmp_path / "not_there.csv") == []


def test_work_and_precision_stand_side_by_side():
    rows = [
        {
            "case": "R3",
            "scheme": scheme,
            "steps_per_second": "200000",
            "error": error,
            "standard_error": "0",
            "cpu_s_per_simulated_s": "0.17",
        }
        for scheme, error in (("exact", "0.0021"), ("newmark", "0.0015"))
    ]
    assert "| R3 | 200000 | 0.0015 | 0.0021 |  |" in section(rows, "figure.png")


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


def test_case_is_independent_of_the_batch_size(problem):
    forces = np.stack([problem.force(STEPS_S, seed) for seed in range(16)], axis=1)
    parts = march_ours(problem, forces, schedule_of(STEPS_S))
    assert sum(part.displacement.shape[0] for part in parts) == 16
    np.testing.assert_array_equal(
        displacement(problem, forces, STEPS_S), displacement(problem, forces[:, 0], STEPS_S)
    )


def test_textbook_step_solves_newmark_equations():
    omega, damping, dt = np.array([300.0]), np.array([12.0]), 1.0e-3
    c = newmark_map(omega, damping, dt)[:, 0]
    q0, v0, f0, f1 = 0.3, -2.0, 5.0, 7.0
    v1 = c[0] * v0 + c[1] * q0 + c[2] * (f0 + f1)
    q1 = c[3] * q0 + c[4] * v0 + c[5] * (f0 + f1)
    a0, a1 = (f - damping[0] * v - omega[0] ** 2 * q for f, v, q in ((f0, v0, q0), (f1, v1, q1)))
    assert q1 == pytest.approx(q0 + dt * v0 + dt**2 * (a0 + a1) / 4.0, rel=1e-12)
    assert v1 == pytest.approx(v0 + dt * (a0 + a1) / 2.0, rel=1e-12)


def test_the_peak_loop_does_its_operations():
    peak = PeakRate()
    # a = a / 2 + 1/2 from any start ends at 1, in every chain
    chains = peak.run()
    assert chains == pytest.approx(round(chains), rel=1e-12) and chains in (12.0, 24.0)


def test_operations_of_a_step_are_counted_by_group(problem):
    # two planes, ten contact rows each
    assert flops_per_step(problem.model) == 17 * 57 + 4 * 10 * 57 + 2 * 4 * 100 + 20 * 3 * 10
    assert flops_per_step(problem.model, touching=False) == 17 * 57 + 2 * 10 * 57
