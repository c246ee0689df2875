"""The command `vibroimpact diagnose`: its arguments, its output and its files.

The library is imported when the command runs, so that `--help` answers at once.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vibroimpact.diagnosis.verdict.content import Estimate, Verdict

EFFORTS = ("quick", "standard", "thorough")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("campaign", metavar="CAMPAIGN", help="a measured campaign (.nc)")
    parser.add_argument(
        "--model",
        metavar="FILE",
        required=True,
        help="configuration of the model; identified: the modes come from the campaign itself",
    )
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
    """Run the command. Return 1 if there is no verdict."""
    from vibroimpact.config.problems import ConfigError
    from vibroimpact.io.provenance import verdict_origin
    from vibroimpact.io.records import RecordError

    from .diagnose import run_diagnosis, write_diagnosis
    from .identified.structure_file import model_of, values_of
    from .progress import ProgressBar

    if not os.path.isfile(options.campaign):
        print(f"{options.campaign}: there is no such file", file=sys.stderr)
        return 1
    try:
        model = model_of(options.model)
        with ProgressBar(sys.stderr, 1 + EFFORTS.index(options.effort)) as bar:
            found = run_diagnosis(
                options.campaign,
                model,
                options.effort,
                threads=os.cpu_count() or 1,
                provenance=verdict_origin(values_of(model), options.campaign),
                log=bar,
            )
        if options.folder:
            Path(options.folder).mkdir(parents=True, exist_ok=True)
            write_diagnosis(found, options.folder)
    except (ConfigError, RecordError) as error:
        print(error, file=sys.stderr)
        return 1
    print("\n".join(summary(found.verdict)))
    return 1 if found.verdict.verdict == "not_testable" else 0


def summary(verdict: Verdict) -> list[str]:
    """Return a verdict as lines for a terminal."""
    from vibroimpact.diagnosis.verdict.content import not_run_sentence

    lines = [f"Verdict: {verdict.verdict.replace('_', ' ')}"]
    if verdict.verdict == "not_testable":
        return [*lines, *(row.message for row in verdict.checks if row.level == "refuse")]
    lines += [
        f"  {effect.id} at {effect.location}: {name} = {_estimate(estimate)}"
        for effect in verdict.shown_effects()
        for name, estimate in effect.parameters.items()
    ]
    shares = {"nothing": verdict.probability_none}
    shares |= {" + ".join(row.ids): row.probability for row in verdict.ranking}
    shares["something that the catalogue lacks"] = verdict.probability_something_else
    lines += [f"  {chance:6.1%}  {name}" for name, chance in shares.items() if chance]
    lines += [f" {told}" for told in [not_run_sentence(verdict.not_run)] if told]
    apart = verdict.misfit.holdout
    if apart is not None and apart.before_dB is not None and apart.after_dB is not None:
        lines.append(
            f"  held-out spectra: {apart.before_dB:.2f} dB off before, {apart.after_dB:.2f} dB"
            f" after, {apart.floor_dB:.2f} dB by chance"
        )
    return lines


def _estimate(estimate: Estimate) -> str:
    """Return "1044 (1001 to 1090) N s/m"."""
    unit = "" if estimate.unit == "1" else f" {estimate.unit}"
    if estimate.value is None or estimate.low is None or estimate.high is None:
        return "not known"
    return f"{estimate.value:.4g} ({estimate.low:.4g} to {estimate.high:.4g}){unit}"
