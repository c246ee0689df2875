"""CPU time of a study by rule and by part of the work.

It is summed from the benchmark files of the jobs and the CPU seconds in their logs.
"""

from collections.abc import Iterable, Iterator
from pathlib import Path

from vibroimpact.io.records import read_text
from vibroimpact.io.stopwatch import seconds_in

# The work a study is made for; everything else should take less than a third of the time.
METHOD = ("kernel", "spectra", "identification")
REST = "rest"


def job_of(benchmark: str, log: str) -> dict:
    """Return {wall_s, cpu_s, max_rss_MB, parts {name: CPU s}} of one job.

    benchmark: text of its benchmark file, with Snakemake's columns.
    log: text of its log.

    CPU seconds are taken from the log if it has them. Those of the benchmark file are sampled
    and miss the end of short jobs.
    """
    header, values = (line.split("\t") for line in benchmark.splitlines()[:2])
    measured = {
        name: float(value) if value.replace(".", "", 1).isdigit() else 0.0
        for name, value in zip(header, values, strict=True)
    }
    parts = seconds_in(log)
    cpu = parts.pop("all", measured["cpu_time"])
    return {
        "wall_s": measured["s"],
        "cpu_s": cpu,
        "max_rss_MB": measured["max_rss"],
        "parts": {**parts, REST: cpu - sum(parts.values())},
    }


def timing_rows(jobs: Iterable[tuple[str, dict]]) -> list[dict]:
    """Return rows {rule, part, jobs, wall_s, cpu_s, share, max_rss_MB} of (rule, job) pairs.

    Rules are in descending order of CPU time, each followed by its parts; the last rows are those
    of all rules together. part is empty for a rule as a whole. share is of the CPU time of all
    jobs. wall_s and max_rss_MB are those of whole jobs.
    """
    by_rule: dict[str, list[dict]] = {}
    for rule, job in jobs:
        by_rule.setdefault(rule, []).append(job)
    everything = [job for group in by_rule.values() for job in group]
    total = sum(job["cpu_s"] for job in everything) or 1.0
    ordered = sorted(by_rule.items(), key=lambda item: -sum(job["cpu_s"] for job in item[1]))
    return [
        row for rule, group in [*ordered, ("all", everything)] for row in _rows(rule, group, total)
    ]


def _rows(rule: str, jobs: list[dict], total: float) -> Iterator[dict]:
    parts: dict[str, float] = {}
    for job in jobs:
        for name, seconds in job["parts"].items():
            parts[name] = parts.get(name, 0.0) + seconds
    cpu = sum(job["cpu_s"] for job in jobs)
    for name, seconds in {"": cpu, **parts}.items():
        yield {
            "rule": rule,
            "part": name,
            "jobs": len(jobs),
            "wall_s": round(sum(job["wall_s"] for job in jobs), 2),
            "cpu_s": round(seconds, 3),
            "share": round(seconds / total, 4),
            "max_rss_MB": max((job["max_rss_MB"] for job in jobs), default=0.0),
        }


def study_timing(benchmarks: Iterable[str | Path], logs: Iterable[str | Path]) -> list[dict]:
    """Return the timing_rows of jobs, from the paths of their benchmark files and logs.

    Raises RecordError when a file can not be read.
    """
    jobs = []
    for path, log in zip(benchmarks, logs, strict=True):
        rule = Path(path).stem.split("_load_")[0].split("_from_")[0]  # without the load
        jobs.append((rule, job_of(read_text(path), read_text(log))))
    return timing_rows(jobs)


def timing_so_far(benchmarks: Iterable[str | Path], logs: Iterable[str | Path]) -> list[dict]:
    """Return study_timing of the jobs whose benchmark file and log are there.

    A study that was made by parts or copied has not all of them.
    """
    present = [
        (path, log)
        for path, log in zip(benchmarks, logs, strict=True)
        if Path(path).is_file() and Path(log).is_file()
    ]
    return study_timing(*zip(*present, strict=True)) if present else []
