"""The files of a campaign that can not be tested: the sentence why, and empty tables."""

from pathlib import Path

import xarray as xr

from vibroimpact.effects.effect import Values
from vibroimpact.linear_stage.prepared import Prepared
from vibroimpact.records import write_record, write_table, write_text
from vibroimpact.verdict.content import Misfit, MisfitBySplit, not_testable
from vibroimpact.verdict.file import write_verdict

from .ranking import COLUMNS
from .rows import contract_checks


def write_refused(folder: Path, prepared: Prepared, provenance: Values, cost: Values) -> None:
    """Write the verdict of a campaign that can not be tested; cost: of verdict.json."""
    empty = Misfit(before_dB=None, after_dB=None, floor_dB=None, closed_fraction=None)
    write_verdict(
        not_testable(
            contract_checks(prepared.checks),
            provenance,
            next_measurement=prepared.refusal,
            misfit=MisfitBySplit(fit=empty, holdout=empty),
            cost=cost,
        ),
        folder / "verdict.json",
    )
    write_table([], folder / "ranking.csv", columns=COLUMNS)
    for name in ("map", "map_after"):
        write_record(
            xr.Dataset(attrs={"title": "no map: the campaign can not be tested"}),
            folder / f"{name}.nc",
        )
    write_text("# not testable: the model is as it was\n", folder / "model_updated.yaml")
