"""What scheduling costs beside the work: CPU seconds of Snakemake and of its jobs.

    python -m evidence.benchmarks.scheduling                     # plans of 24, 240 and 2400 loads
    python -m evidence.benchmarks.scheduling --run --loads 24    # also runs them, -j2

The study is the small one with one gap, one seed and the shortest record that its configuration
permits; `--seconds 49` gives the records the length of the default study. CPU time is that of the
processes, so that other work on the machine changes it little.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]
SHORTEST_S = 0.5  # the bands of the identification need some lines
SEGMENTS = 2
# Runs Snakemake in this process and prints what it and its jobs used, and how many threads it had.
MEASURED = """
import json, resource, sys, threading
from snakemake.cli import main
most, ended = [0], threading.Event()
def watch():
    while not ended.wait(0.2):
        most[0] = max(most[0], threading.active_count() - 1)
threading.Thread(target=watch, daemon=True).start()
code = 0
try:
    main(sys.argv[1:])
except SystemExit as ended_with:
    code = ended_with.code
ended.set()
own, jobs = (resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
print(json.dumps({
    "code": code,
    "snakemake_s": own.ru_utime + own.ru_stime,
    "jobs_s": jobs.ru_utime + jobs.ru_stime,
    "memory_MB": own.ru_maxrss / 1024,
    "threads": most[0],
}))
"""


def study_of(loads: int, seconds: float) -> dict:
    """Return the small study with that many loads, one gap, one seed and short records."""
    values = yaml.safe_load((ROOT / "config" / "smoke.yaml").read_text(encoding="utf-8"))
    values["study"] = f"loads_{loads}"
    values["grid"] = {
        "load_rms_N": {"first": 0.05, "last": 20.0, "count": loads},
        "gap_m": [1e-4],
        "seeds": 1,
    }
    values["record"] |= {"duration_s": seconds, "keep_time_series": False}
    values["integration"]["start_up_s"] = 0.0
    values["spectra"]["segment_s"] = min(seconds / SEGMENTS, 4.0)
    return values


def measure(folder: Path, *arguments: str) -> dict:
    """Return {snakemake_s, jobs_s: CPU s, memory_MB, threads, told} of one call of Snakemake.

    Raises RuntimeError with the end of its output where it fails.
    """
    given = ["--snakefile", str(ROOT / "Snakefile"), "--configfile", "study.yaml"]
    given += ["--workflow-profile", str(ROOT / "workflow" / "profiles" / "default")]
    run = subprocess.run(
        [sys.executable, "-c", MEASURED, *given, *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    try:
        found = json.loads(run.stdout.splitlines()[-1])
    except (IndexError, ValueError):
        found = {"code": 1}
    if found.pop("code"):
        raise RuntimeError(f"{arguments}: {(run.stdout + run.stderr)[-2000:]}")
    return found | {"told": run.stdout + run.stderr}


def rows_of(loads: int, seconds: float, run: bool, cores: int) -> list[dict]:
    """Return a row of the plan, and one of the run where it is asked for."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "study.yaml").write_text(yaml.safe_dump(study_of(loads, seconds)))
        plan = measure(folder, "--dry-run")
        jobs = next(line.split()[1] for line in plan["told"].splitlines() if "total " in line)
        rows = [{"loads": loads, "what": "plan", "jobs": jobs, **plan}]
        if run:
            measure(folder, f"-j{cores}", "--until", "_basis")  # compiles nothing that is timed
            done = measure(folder, f"-j{cores}")
            files = sum(file.is_file() for file in (folder / "results").rglob("*"))
            kept = (folder / ".snakemake" / "metadata").rglob("*")
            size = sum(file.stat().st_size for file in kept if file.is_file())
            rows.append({"loads": loads, "what": "run", "jobs": jobs, **done, "files": files})
            rows[-1]["metadata_MB"] = size / 1e6
        return rows


def line_of(row: dict) -> str:
    """Return a row as text."""
    parts = [
        f"{row['loads']} loads, {row['what']}: {row['jobs']} jobs",
        f"Snakemake {row['snakemake_s']:.1f} CPU s, {row['memory_MB']:.0f} MB",
    ]
    if row["what"] == "run":
        parts += [
            f"jobs {row['jobs_s']:.1f} CPU s, ratio {row['snakemake_s'] / row['jobs_s']:.3f}",
            f"{row['threads']} threads, {row['files']} files",
            f"{row['metadata_MB']:.1f} MB of metadata",
        ]
    return "; ".join(parts)


def main() -> None:
    """Measure and print a line for each plan and run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--loads", type=int, nargs="+", default=[24, 240, 2400])
    parser.add_argument("--seconds", type=float, default=SHORTEST_S, help="length of the records")
    parser.add_argument("--run", action="store_true", help="run the studies too")
    parser.add_argument("--cores", type=int, default=2)
    asked = parser.parse_args()
    for loads in asked.loads:
        for row in rows_of(loads, asked.seconds, asked.run, asked.cores):
            print(line_of(row), flush=True)


if __name__ == "__main__":
    main()
