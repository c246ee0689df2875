"""Where the time of a study goes: the benchmark files of its jobs and the CPU seconds in their
logs, summed by rule and part.
"""

from pathlib import Path

from vibroimpact.records import read_text
from vibroimpact.stopwatch import seconds_in

METHOD = (
    "kernel",
    "spectra",
    "identification",
)  # what the study is for; all else should be less than a third
REST = "rest"


def job_of(benchmark: str, log: str) -> dict:
    """{wall_s, cpu_s, max_rss_MB, parts {name: CPU s}} of a job from the texts of its benchmark
    file (Snakemake's columns) and its log.

    CPU seconds are those of the log where it tells them: the benchmark's are sampled, and miss the
    end of short jobs.
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


def rule_of(path) -> str:
    """The rule of a benchmark file: its name without the load."""
    return Path(path).stem.split("_load_")[0].split("_from_")[0]


def timing_rows(jobs) -> list[dict]:
    """Rows {rule, part, jobs, wall_s, cpu_s, share, max_rss_MB} of (rule, job) pairs: each rule by
    descending CPU time, its parts after it.

    part is empty for a rule as a whole; share is of the CPU time of all jobs; wall_s and max_rss_MB
    are of whole jobs. The last rows are those of all rules together.
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


def _rows(rule, jobs, total):
    parts: dict[str, float] = {}
    for job in jobs:
        for name, seconds in job["parts"].items():
            parts[name] = parts.get(name, 0.0) + seconds
    wall = round(sum(job["wall_s"] for job in jobs), 2)
    cpu = sum(job["cpu_s"] for job in jobs)
    most = max((job["max_rss_MB"] for job in jobs), default=0.0)
    yield {
        "rule": rule,
        "part": "",
        "jobs": len(jobs),
        "wall_s": wall,
        "cpu_s": round(cpu, 3),
        "share": round(cpu / total, 4),
        "max_rss_MB": most,
    }
    for name, seconds in parts.items():
        yield {
            "rule": rule,
            "part": name,
            "jobs": len(jobs),
            "wall_s": wall,
            "cpu_s": round(seconds, 3),
            "share": round(seconds / total, 4),
            "max_rss_MB": most,
        }


def study_timing(benchmarks, logs) -> list[dict]:
    """The timing_rows of jobs given by the paths of their benchmark files and logs. Raises
    RecordError when one can not be read.
    """
    return timing_rows(
        [
            (rule_of(path), job_of(read_text(path), read_text(log)))
            for path, log in zip(benchmarks, logs, strict=True)
        ]
    )
