"""Where the time goes: logs and benchmark files add up to rows, shares to one, and the figure shows
the rows.
"""

import pytest

from vibroimpact.io.records import RecordError
from vibroimpact.io.stopwatch import Stopwatch, seconds_in
from vibroimpact.study.timing import study_timing, timing_so_far

HEADER = "s\th:m:s\tmax_rss\tmax_vms\tmax_uss\tmax_pss\tio_in\tio_out\tmean_load\tcpu_time"


@pytest.fixture
def paths(tmp_path):
    """Benchmark files and logs of four jobs; the log of the last says nothing."""
    jobs = {
        "simulate_load_0.5": (
            "9.0",
            "210.5",
            "8.5",
            "CPU seconds: kernel 6.000, spectra 1.000, all 10.000",
        ),
        "simulate_load_4": (
            "11.0",
            "250.5",
            "9.5",
            "one\nCPU seconds: spectra 1.000, kernel 8.000, all 12.000\n",
        ),
        "identify_from_0.316": (
            "5.0",
            "140.0",
            "1.0",
            "CPU seconds: identification 3.000, all 4.000",
        ),
        "basis": ("2.0", "100.0", "1.5", "99 modes"),
    }
    for name, (wall, memory, cpu, log) in jobs.items():
        (tmp_path / f"{name}.tsv").write_text(
            f"{HEADER}\n{wall}\t0:00:09\t{memory}\t1\t1\t1\tNA\t1\t50.0\t{cpu}\n"
        )
        (tmp_path / f"{name}.log").write_text(log)
    return [[tmp_path / f"{name}.{suffix}" for name in jobs] for suffix in ("tsv", "log")]


def test_jobs_are_summed_by_rule_and_part(paths):
    rows = study_timing(*paths)
    by_name = {(row["rule"], row["part"]): row for row in rows}
    assert [row["rule"] for row in rows if not row["part"]] == [
        "simulate",
        "identify",
        "basis",
        "all",
    ]
    assert by_name["simulate", ""] == {
        "rule": "simulate",
        "part": "",
        "jobs": 2,
        "wall_s": 20.0,
        "cpu_s": 22.0,
        "share": 0.8,
        "max_rss_MB": 250.5,
    }
    assert (by_name["simulate", "kernel"]["cpu_s"], by_name["simulate", "rest"]["cpu_s"]) == (
        14.0,
        6.0,
    )
    assert by_name["basis", "rest"]["cpu_s"] == 1.5  # the benchmark's, where the log tells nothing
    assert by_name["all", ""]["cpu_s"] == 27.5 and by_name["all", ""]["jobs"] == 4
    assert sum(
        row["share"] for row in rows if row["rule"] == "all" and row["part"]
    ) == pytest.approx(1.0, abs=1e-3)


def test_a_missing_file_is_named(paths):
    paths[1][0].unlink()
    with pytest.raises(RecordError, match="simulate_load_0.5.log: cannot be read"):
        study_timing(*paths)


def test_stopwatch_times_are_read_back_from_the_log():
    stopwatch = Stopwatch()
    assert stopwatch.time("work", sum, range(1000)) == 499500
    with pytest.raises(RuntimeError), stopwatch("work"):
        raise RuntimeError
    stopwatch.add({"more work": 1.25})
    told = seconds_in("before\n" + stopwatch.line() + "\nafter")
    assert set(told) == {"work", "more work", "all"} and told["more work"] == 1.25
    assert seconds_in("nothing") == {}


def test_timing_so_far_leaves_out_jobs_without_their_files(paths):
    benchmarks, logs = paths
    whole = timing_so_far(benchmarks, logs)
    assert whole == study_timing(benchmarks, logs)
    logs[0].unlink()
    rows = timing_so_far(benchmarks, logs)
    assert next(row for row in rows if row["rule"] == "all")["jobs"] == 3
    assert timing_so_far([], []) == []
