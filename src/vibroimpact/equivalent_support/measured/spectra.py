"""The spectra of a measured record, as study.case_spectra makes them of a simulated one."""

import numpy as np
import xarray as xr

from vibroimpact.campaign.base_motion import integrated
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.identify.broadband import UNKNOWN
from vibroimpact.io.units import TIME_DERIVATIVES
from vibroimpact.study.case_spectra import case_spectra
from vibroimpact.study.cases import Case

from .settings import lowest_read_Hz
from .tube import MeasuredTube, relative_psd

TIME_CONSTANTS = 5.0  # of the first mode, left out of a record that begins at rest


def displacements(config: ConfigPart, tube: MeasuredTube, record: int) -> np.ndarray:
    """Return (sensor, time) the displacement in m of a record, from stationary motion on.

    Accelerations and velocities are integrated over time above half the lowest frequency that the
    identification reads.
    """
    signals, model = tube.signals, tube.model
    low_Hz = lowest_read_Hz(config.identification)
    first = signals.transient_periods * signals.period_samples if signals.forces else 0
    if signals.starts_at_rest:
        slowest = 0.5 * model.damping[model.omega > 0.0].min()
        first = max(first, int(min(TIME_CONSTANTS / slowest, 10.0) * signals.rate))
    series = signals.response[record][tube.channels].copy()
    for row, channel in enumerate(tube.channels):
        for _ in range(TIME_DERIVATIVES[signals.kinds[channel]]):
            series[row] = integrated(series[row] - series[row].mean(), signals.rate, low_Hz)
    kept = series[:, first:]
    return kept - kept.mean(axis=1, keepdims=True)


def measured_spectra(config: ConfigPart, tube: MeasuredTube, record: int, case: Case) -> xr.Dataset:
    """Return the spectra of a record, and the relative PSD of its force if it is not white.

    Those of the sensors are 0 below the lowest frequency that is read, below which integrated
    noise grows without end.

    config: of measured_settings.
    """
    moved = displacements(config, tube, record)
    dims = ("sensor", "time")
    series = xr.Dataset(
        {
            "displacement": (dims, moved),
            "acceleration": (dims, np.zeros_like(moved)),
            "line_displacement": (("line_point", "time"), moved),
        },
        {"sensor": list(tube.model.sensor_names)},
        {"case": case.id, "load_rms_N": case.load_rms_N, "gap_m": case.gap_m, "seed": case.seed},
    )
    spectra = case_spectra(config, series).assign_attrs(
        record=tube.signals.records[record], force="known" if tube.force.known else UNKNOWN
    )
    omega = 2.0 * np.pi * spectra["frequency"]
    for name in ("mean", "min", "max"):
        spectra[f"psd_acceleration_{name}"] = spectra[f"psd_displacement_{name}"] * omega**4
    kept = spectra["low_frequency"] >= lowest_read_Hz(config.identification)
    for part in ("re", "im"):
        spectra[f"sensor_spectra_{part}"] = spectra[f"sensor_spectra_{part}"] * kept
    frequency = spectra["low_frequency"].values
    psd = relative_psd(config, tube.signals, record, tube.force, frequency)
    return spectra if psd is None else spectra.assign(force_psd=("low_frequency", psd))
