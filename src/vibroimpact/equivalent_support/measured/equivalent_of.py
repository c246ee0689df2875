"""The equivalent support of a measured tube: a campaign and a model in, k and c out.

Each record becomes the spectra of a case, and the functions of a study do the rest. No contact is
simulated. Records of one gap and about one level are the seeds of a case. The level of a record is
the RMS of its force in N. If no record has one it is the RMS of the displacement in m, so that
records still differ by the strength of the motion.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.campaign.file import CampaignError, read_campaign
from vibroimpact.campaign.signals import campaign_signals
from vibroimpact.config.reading import load_config
from vibroimpact.config.schema import Config
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.identify.estimate import table_rows
from vibroimpact.identify.identify_case import identify_case
from vibroimpact.identify.linear.support_groups import unreached_supports
from vibroimpact.io.records import write_record, write_table
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.reduction.model_file import write_model
from vibroimpact.study.agreement_dataset import consistency_dataset
from vibroimpact.study.cases import Case
from vibroimpact.study.equivalent_table import DIGEST_COLUMN, equivalent_rows
from vibroimpact.study.method_agreement import consistency_rows, summary_rows

from .settings import measured_settings, with_grid
from .spectra import displacements, measured_spectra
from .tube import KnownForce, MeasuredTube, measured_tube
from .usable import identification_problems, signal_problems

Rows = list[dict[str, Any]]
# Largest ratio of two levels of one case. Responses of one level scatter more than its forces.
SAME_LOAD, SAME_RESPONSE = 1.05, 1.25
DIGITS = 4
LOAD, RESPONSE = "load_rms_N", "response_rms_m"  # columns that a level can be


@dataclass(frozen=True, eq=False)
class MeasuredSupports:
    """The equivalent supports of a measured tube.

    config: the model's configuration with the records and sensors of the campaign.
    model: linear model whose sensors are those of the campaign.
    force: the known spectra of the forces.
    records: {Case: name of the record}.
    spectra, curves: {Case: Dataset}, as of study.case_spectra and identify.identify_case.
    rows, summary, equivalent: those of consistency.csv, consistency_summary.csv, equivalent.csv.
    levels: "load_rms_N", or "response_rms_m" if no record has a load: the rows then hold the RMS
        of the displacement, in m, in the place of the load.
    notes: sentences on the assumptions.
    """

    config: ConfigPart
    model: ModalModel
    force: KnownForce
    records: Mapping[Case, str]
    spectra: Mapping[Case, xr.Dataset]
    curves: Mapping[Case, xr.Dataset]
    rows: Rows
    summary: Rows
    equivalent: Rows
    levels: str
    notes: tuple[str, ...]

    def to_dataset(self) -> xr.Dataset:
        """Return the estimates, their medians and verdicts, as the file consistency.nc of a study.

        The coordinate `load` is in m if `levels` is the response.
        """
        found = consistency_dataset(self.rows, self.summary)
        if self.levels == RESPONSE:
            found["load"].attrs = {"units": "m", "long_name": "RMS of the displacement"}
        return found

    def write(self, folder: str | Path, attributes: Mapping[str, Any], digest: str) -> None:
        """Write the files of a study: equivalent.csv, consistency.csv, consistency_summary.csv,
        consistency.nc and model.nc.

        attributes: of the netCDF files, see provenance.file_attributes.
        digest: answer_digest of the configuration of the tube.

        If no record has a load, its columns are NaN and response_rms_m (m) stands behind them.
        """
        folder = Path(folder)
        tables = {
            "equivalent": self.equivalent,
            "consistency_summary": self.summary,
            "consistency": [
                row | {"record": self.records[Case(row["load_rms_N"], row["gap_m"], row["seed"])]}
                for row in self.rows
            ],
        }
        unknown = {"load_rms_N": np.nan, "load_over_gap": np.nan}
        for name, rows in tables.items():
            if self.levels == RESPONSE:
                rows = [row | {RESPONSE: row["load_rms_N"]} | unknown for row in rows]
            own = [row | {DIGEST_COLUMN: digest} for row in rows]
            write_table(own, folder / f"{name}.csv")
        write_record(self.to_dataset().assign_attrs(attributes), folder / "consistency.nc")
        write_model(self.model, folder / "model.nc", dict(attributes))


def equivalent_of(
    campaign: xr.Dataset | str | Path, model: Config | str | Path
) -> MeasuredSupports:
    """Return the equivalent supports of a measured tube, by the methods of a study.

    campaign: Dataset or file. Its force may be missing: pole and shape then give k and c.
    model: configuration of the tube with its supports, or its YAML file. Its bands and groups of
        section identification are used if it has one.

    Raises CampaignError or RecordError for a campaign that can not be used, ConfigError for a
    model; the message states the remedy.
    """
    config = model if isinstance(model, Config) else load_config(model)
    if not isinstance(campaign, xr.Dataset):
        campaign = read_campaign(campaign, force_needed=False)
    _require(identification_problems(config, campaign))
    signals = campaign_signals(campaign)
    _require(signal_problems(signals, config.spectra.segment_s))
    try:
        tube = measured_tube(config, campaign, signals)
    except ValueError as error:  # off the tube, or no support is reached
        raise CampaignError(str(error)) from error
    settings = measured_settings(config, tube)
    level, name = _levels(settings, tube)
    gaps = gaps_of_records(signals.gap, config.grid.gap_m)
    cases = cases_of_records(level, gaps, SAME_LOAD if name == LOAD else SAME_RESPONSE)
    settings = with_grid(settings, cases)
    spectra = {
        case: measured_spectra(settings, tube, record, case) for record, case in enumerate(cases)
    }
    tables, curves = [], {}
    for case, dataset in spectra.items():
        estimates, curves[case] = identify_case(settings, tube.model, None, dataset)
        tables.append(table_rows(estimates, dataset.attrs))
    rows = consistency_rows(tables)
    summary = summary_rows(rows)
    unreached = unreached_supports(tube.model, settings.identification.groups)
    return MeasuredSupports(
        config=settings,
        model=tube.model,
        force=tube.force,
        records={case: str(dataset.attrs["record"]) for case, dataset in spectra.items()},
        spectra=spectra,
        curves=curves,
        rows=rows,
        summary=summary,
        equivalent=equivalent_rows(summary, unreached),
        levels=name,
        notes=_notes(config, tube),
    )


def _require(problems: Iterable[str]) -> None:
    """Raise CampaignError with every problem, a line each."""
    found = list(problems)
    if found:
        raise CampaignError("\n".join(found))


def _levels(config: ConfigPart, tube: MeasuredTube) -> tuple[np.ndarray, str]:
    """Return (level (record,), name of the column): loads, or the motion of the response point."""
    signals = tube.signals
    if np.isfinite(signals.load_rms).all() and (signals.load_rms > 0.0).all():
        return signals.load_rms, LOAD
    row = tube.points.index(config.identification.response_point)
    moved = [displacements(config, tube, record)[row] for record in range(len(signals.records))]
    return np.array([np.sqrt(np.mean(series**2)) for series in moved]), RESPONSE


def cases_of_records(level: np.ndarray, gap_m: np.ndarray, same: float = SAME_LOAD) -> list[Case]:
    """Return the Case of each record.

    level: (record,) RMS of the force in N, or of the displacement in m.
    gap_m: (record,) radial gap in m.
    same: largest ratio of two levels of one case.
    """
    found: dict[int, Case] = {}
    for gap in np.unique(gap_m):
        for together in _alike(level, np.flatnonzero(gap_m == gap), same):
            middle = float(f"{np.mean(level[together]):.{DIGITS}g}")
            for seed, record in enumerate(sorted(together)):
                found[record] = Case(middle, float(gap), seed)
    return [found[record] for record in range(len(level))]


def _alike(level: np.ndarray, records: Sequence[int] | np.ndarray, same: float) -> list[list[int]]:
    """Return the records of each level, ascending."""
    groups: list[list[int]] = []
    for record in sorted(map(int, records), key=lambda record: level[record]):
        if groups and level[record] <= same * level[groups[-1][0]]:
            groups[-1].append(record)
        else:
            groups.append([record])
    return groups


def gaps_of_records(stated_m: np.ndarray, model_m: Sequence[float]) -> np.ndarray:
    """Return (record,) gaps in m: as stated, else the largest of the model's grid.

    stated_m: (record,) m, NaN if a record states none.
    model_m: gaps of the model's grid.
    """
    known = np.isfinite(stated_m) & (stated_m > 0.0)
    return np.where(known, stated_m, max(model_m))


def _notes(config: Config, tube: MeasuredTube) -> tuple[str, ...]:
    """Return the assumptions in sentences."""
    signals, force = tube.signals, tube.force
    notes = []
    if not force.known:
        notes.append(
            "No force was measured: k and c come from pole and shape. Every mode was taken to be"
            " pushed alike."
        )
    elif not signals.forces:
        notes.append("No force was measured: it was taken to be the turbulence of the model.")
    elif len(signals.forces) > 1:
        notes.append(
            f"The {len(signals.forces)} forces act together, with the covariance that they have"
            " over their band."
        )
    left = [name for index, name in enumerate(signals.channels) if index not in tube.channels]
    if left:
        notes.append(f"Not used, because the force does not move them: {', '.join(left)}.")
    if not np.isfinite(signals.gap).all():
        gap = 1e3 * max(config.grid.gap_m)
        notes.append(f"Records without a gap were given that of the model, {gap:.4g} mm.")
    if signals.forces and signals.period_samples:
        notes.append(
            "The force repeats: the scatter over segments is too small. Give spectra.segment_s of"
            " several periods."
        )
    return tuple(notes)
