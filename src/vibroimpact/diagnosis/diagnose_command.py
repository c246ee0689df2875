"""The command `vibroimpact diagnose`: its arguments, and what it prints and writes.

The library is imported when the command runs, so that `--help` answers at once.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

EFFORTS = ("quick", "standard", "thorough")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("campaign", metavar="CAMPAIGN", help="a measured campaign (.nc)")
    parser.add_argument("--model", metavar="FILE", required=True, help="configuration of the model")
    parser.add_argument(
        "--effort",
        choices=EFFORTS,
        default="standard",
        help="looks for one, two or three effects at once (default: %(default)s)",
    )
    parser.add_argument(
        "--folder",
        metavar="DIR",
        help="write verdict.json, ranking.csv, spectra.nc and model_updated.yaml there",
    )
    parser.set_defaults(command=run)


def run(options: argparse.Namespace) -> int:
    """Run the command. Return 1 where there is no verdict."""
    from vibroimpact.config.problems import ConfigError
    from vibroimpact.config.reading import load_config
    from vibroimpact.provenance import verdict_origin
    from vibroimpact.records import RecordError
    from vibroimpact.reports.verdict_words import verdict_sentence

    from .diagnose import run_diagnosis, write_diagnosis

    if not os.path.isfile(options.campaign):
        print(f"{options.campaign}: there is no such file", file=sys.stderr)
        return 1
    try:
        config = load_config(options.model)
        found = run_diagnosis(
            options.campaign,
            config,
            options.effort,
            threads=os.cpu_count() or 1,
            provenance=verdict_origin(config.model_dump(mode="json"), options.campaign, None),
            log=lambda text: print(text, file=sys.stderr, flush=True),
        )
        if options.folder:
            Path(options.folder).mkdir(parents=True, exist_ok=True)
            write_diagnosis(found, options.folder)
    except (ConfigError, RecordError) as error:
        print(error, file=sys.stderr)
        return 1
    print(f"{found.verdict.verdict}: {verdict_sentence(found.verdict)}")
    return 1 if found.verdict.verdict == "not_testable" else 0
