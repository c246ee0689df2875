"""Before Snakemake reads anything: configurations that are not YAML, and a cache it can write."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from vibroimpact.config.problems import ConfigError
from vibroimpact.config.yaml_file import read_yaml


def require_yaml(arguments: Sequence[str]) -> None:
    """Exit with every problem of a configuration file that is not YAML.

    arguments: those of snakemake, whose --configfile names the files; without it, the file that the
    Snakefile names. Snakemake parses these files before it reads the Snakefile, and its own message
    says neither file nor line. Raises SystemExit.
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--configfile", "--configfiles", nargs="+", action="extend")
    files = parser.parse_known_args(list(arguments))[0].configfile
    problems = []
    for file in files or filter(os.path.isfile, ["config/study.yaml"]):
        try:
            read_yaml(file)
        except ConfigError as error:
            problems += error.problems
    if problems:
        sys.exit("\n".join(problems))


def give_cache() -> None:
    """Let Snakemake keep its cache in the working folder where HOME can not be written."""
    cache = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "snakemake")
    try:
        cache.mkdir(parents=True, exist_ok=True)
        writable = os.access(cache, os.W_OK)
    except OSError:
        writable = False
    if not writable:
        os.environ["XDG_CACHE_HOME"] = os.path.abspath(".snakemake/cache")
