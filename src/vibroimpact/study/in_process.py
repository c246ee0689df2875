"""A case, or a small study, from its configuration to the equivalent support in one process.

For notebooks and scripts. The workflow makes the same numbers in parallel jobs and keeps them in
files. Functions import the identification: a simulation starts half a second earlier without it.
"""

from pathlib import Path
from typing import Any

import xarray as xr

from vibroimpact.config.reading import changed_config, config_of
from vibroimpact.config.schema import Config
from vibroimpact.config.stage_keys import stage_params
from vibroimpact.identify.estimate import table_rows
from vibroimpact.io.memo import Memo
from vibroimpact.io.provenance import config_digest
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.reduction.reduced_model import build_model

from .agreement_dataset import consistency_dataset
from .cases import Case, all_cases
from .method_agreement import consistency_rows, summary_rows
from .simulation import simulate_cases
from .support_estimates import SupportEstimates

MODELS = Memo()
SERIES = ("displacement", "acceleration", "line_displacement")  # that spectra are made of


def simulate_case(
    config: Config | str | Path,
    load_rms_N: float,
    gap_m: float,
    seed: int = 0,
    duration_s: float | None = None,
) -> xr.Dataset:
    """Return the record of one load and gap: time series and statistics of contact and stress.

    Its variables, dimensions and units are those of study.record_variables.VARIABLES. The grid of
    the configuration is not read.

    config: a Config, or the path of a file.
    load_rms_N: RMS of the force, N.
    gap_m: radial clearance of the supports without one of their own, m.
    seed: of the force and the imperfections, from 0.
    duration_s: of the record, s; that of the configuration if None.
    Raises ConfigError for values that the configuration may not have, IntegrationError, ForceError.
    """
    values: dict[str, Any] = {
        "grid.load_rms_N": [load_rms_N],
        "grid.gap_m": [gap_m],
        "grid.seeds": seed + 1,
    }
    if duration_s is not None:
        values["record.duration_s"] = duration_s
    config = changed_config(config, values)
    case = Case(float(load_rms_N), float(gap_m), seed)
    ((_, record),) = simulate_cases(config, reduced_model(config), [case])
    return record


def case_spectra(config: Config | str | Path, record: xr.Dataset) -> xr.Dataset:
    """Return the averaged spectra of one case, with the attributes of its record.

    Its psd_displacement_mean (sensor, frequency) is in m²/Hz, psd_acceleration_mean in (m/s²)²/Hz.

    config: a Config, or the path of a file.
    record: of simulate_case: displacement (sensor, time) m, acceleration (sensor, time) m/s² and
        line_displacement (line_point, time) m.
    Raises ValueError for a record without time series or of another shape, ConfigError.
    """
    config = config_of(config)
    if not isinstance(record, xr.Dataset):
        raise ValueError(
            f"the record is of type {type(record).__name__}: give that of simulate_case, an xarray"
            " Dataset, as in case_spectra(config, record)"
        )
    missing = [name for name in SERIES if name not in record]
    if missing:
        raise ValueError(
            f"the record of {record.attrs.get('case', 'this case')} holds no time series of"
            f" {', '.join(missing)}: give that of simulate_case, or take the spectra in"
            " results/<study>/spectra"
        )
    from .case_spectra import case_spectra as spectra_of

    return spectra_of(config, record)


def identify_support(
    config: Config | str | Path, record: xr.Dataset, spectra: xr.Dataset | None = None
) -> SupportEstimates:
    """Return the equivalent support of one case by every method: k (N/m) and c (N s/m) per support.

    They are NaN if a method can not resolve the support.

    config: a Config, or the path of a file.
    record: of simulate_case, or read from results/<study>/records.
    spectra: of case_spectra, or read from results/<study>/spectra; made from the record if None.
    Raises ValueError for a configuration without identification, and for a record without time
    series if the spectra are not given.
    """
    config = _identified(config)
    from vibroimpact.identify.identify_case import identify_case

    if spectra is None:
        spectra = case_spectra(config, record)
    estimates, curves = identify_case(config, reduced_model(config), record, spectra)
    case = record.attrs
    return SupportEstimates(case["load_rms_N"], case["gap_m"], tuple(estimates), curves)


def run_study(config: Config | str | Path) -> xr.Dataset:
    """Return the equivalent supports of all cases of a study, as in its file consistency.nc.

    Variables: of every case (support_direction, gap, load, seed, method), of the medians over seeds
    (support_direction, gap, load, method), and the verdicts on the agreement of the methods
    (support_direction, gap, load). Meant for small grids: the workflow runs large ones in parallel
    and keeps their records.

    config: a Config, or the path of a file.
    Raises ValueError for a configuration without identification, and as simulate_case does.
    """
    config = _identified(config)
    from vibroimpact.identify.identify_case import identify_case

    model, tables = reduced_model(config), []
    for _, record in simulate_cases(config, model, all_cases(config.grid)):
        estimates, _ = identify_case(config, model, record, case_spectra(config, record))
        tables.append(table_rows(estimates, record.attrs))
    rows = consistency_rows(tables)
    return consistency_dataset(rows, summary_rows(rows))


def _identified(config: Config | str | Path) -> Config:
    """Return a Config with a section identification. Raises ValueError, ConfigError."""
    config = config_of(config)
    if config.identification is None:
        raise ValueError(
            f"study '{config.study}' has no section identification, which gives the bands for"
            " the equivalent support: add it; `vibroimpact reference` lists its keys"
        )
    return config


def reduced_model(config: Config) -> ModalModel:
    """Return the ModalModel of a configuration; the last few are kept.

    That of matrices is always built again, because their files may have changed.
    """
    if config.structure.kind == "matrices":
        return build_model(config)
    key = config_digest(stage_params(config, "basis"))
    return MODELS.get(key, lambda: build_model(config))
