"""Snakemake in a process of its own, as a user runs it."""

import subprocess
import sys
from pathlib import Path

RULES = ("--snakefile", Path(__file__).parents[2] / "Snakefile")  # of this checkout


def command(*arguments):
    """The command line of snakemake."""
    return [sys.executable, "-m", "snakemake", *map(str, arguments)]


def snakemake(folder, *arguments, **options):
    """The finished process of snakemake in a folder; options: those of subprocess.run."""
    words = command(*arguments)
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, **options)


def told_by(folder, *arguments, **options):
    """What snakemake has printed in a folder at the end of a run without an error."""
    run = snakemake(folder, *arguments, **options)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout + run.stderr
