"""Comparison of the equivalent linear tube with the non-linear one, in cases not fitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.reduction.modal_model import ModalModel

BANDS_HZ = ((5.0, 20.0), (20.0, 40.0), (40.0, 60.0), (60.0, 100.0), (100.0, 200.0))
RESOLUTION_HZ = 0.01
USABLE_dB = 2.0  # 26 % in amplitude: the "agree" of the study
EULER_GAMMA = 0.5772
TINY = np.finfo(float).tiny


@dataclass(frozen=True)
class Response:
    """The response of one tube under one load.

    frequency (frequency,): Hz. psd: {sensor: (frequency,) m²/Hz}.
    rms_displacement: {sensor: m}. rms_force: {support: N}.
    rms_stress, peak_stress: {section: Pa}.
    contact: fraction of time, NaN for a linear tube.
    """

    frequency: np.ndarray
    psd: dict
    rms_displacement: dict
    rms_force: dict
    rms_stress: dict
    peak_stress: dict
    contact: float


def displacement_and_stress(model: ModalModel) -> np.ndarray:
    """Return (mode, sensor + 2 section): the sensors, then both bending stresses per section."""
    return np.hstack([model.sensor_shapes, model.stress_shapes.reshape(len(model.omega), -1)])


def response_of_psds(
    model: ModalModel,
    frequency: np.ndarray,
    power: np.ndarray,
    force: np.ndarray,
    duration_s: float,
) -> Response:
    """Return the Response of a linear tube from its PSDs on evenly spaced frequencies.

    frequency: (frequency,) Hz. power: (output, frequency) m²/Hz and Pa²/Hz, of the outputs of
    displacement_and_stress. force: (support, frequency) N²/Hz. duration_s: for the peak stress.
    """
    step, sensors = frequency[1] - frequency[0], len(model.sensor_names)
    rms = np.sqrt(power[:sensors].sum(axis=1) * step)
    stress = power[sensors:].reshape(-1, 2, len(frequency)).sum(axis=1)
    sigma = np.sqrt(stress.sum(axis=1) * step)
    rate = np.sqrt((stress * frequency**2).sum(axis=1) * step) / np.maximum(sigma, TINY)
    peaks = sigma * expected_peak_factor(rate * duration_s)
    return Response(
        frequency=frequency,
        psd=dict(zip(model.sensor_names, power[:sensors], strict=True)),
        rms_displacement=dict(zip(model.sensor_names, rms, strict=True)),
        rms_force=dict(zip(model.support_names, np.sqrt(force.sum(axis=1) * step), strict=True)),
        rms_stress=dict(zip(model.section_names, sigma, strict=True)),
        peak_stress=dict(zip(model.section_names, peaks, strict=True)),
        contact=np.nan,
    )


def expected_peak_factor(crossings: Any) -> Any:
    """Return the expected maximum of a Gaussian process, in standard deviations.

    crossings: expected number of upcrossings of the mean.
    """
    root = np.sqrt(2.0 * np.log(np.maximum(crossings, 2.0)))
    return root + EULER_GAMMA / root


def recorded_response(
    record: xr.Dataset, frequency: np.ndarray, psd: np.ndarray, names: Sequence[str]
) -> Response:
    """Return the Response of a non-linear record.

    record: Dataset with its statistics.
    psd (sensor, frequency): m²/Hz, of the sensors `names`.
    """
    step = frequency[1] - frequency[0]
    return Response(
        frequency=frequency,
        psd=dict(zip(names, psd, strict=True)),
        rms_displacement=dict(zip(names, np.sqrt(psd.sum(axis=1) * step), strict=True)),
        rms_force=_named(record, "support", "rms_force"),
        rms_stress=_named(record, "section", "stress_rms"),
        peak_stress=_named(record, "section", "stress_peak"),
        contact=float(record["contact_fraction"].values.mean()),
    )


def _named(record, axis, name):
    return dict(
        zip([str(place) for place in record[axis].values], record[name].values, strict=True)
    )


def band_level(response: Response, sensor: str, low: float, high: float) -> float:
    """Return the root of a sensor's mean PSD between two frequencies in Hz, in m/sqrt(Hz)."""
    inside = (response.frequency >= low) & (response.frequency < high)
    return float(np.sqrt(np.mean(response.psd[sensor][inside])))


def compared_row(quantity: str, of: str, unit: str, linear: float, seeds: Sequence[float]) -> dict:
    """Return the columns that compare a linear value with those of several seeds.

    They are the last columns of prediction_rows.
    """
    values = np.asarray(seeds, dtype=float)
    nonlinear = float(np.sqrt(np.mean(values**2)))
    error = 20.0 * np.log10(linear / nonlinear) if linear > 0.0 and nonlinear > 0.0 else np.nan
    scatter = (
        8.686 * values.std(ddof=1) / np.sqrt(values.size) / nonlinear
        if values.size > 1 and nonlinear > 0.0
        else np.nan
    )
    return {
        "quantity": quantity,
        "of": of,
        "unit": unit,
        "linear": float(linear),
        "nonlinear": nonlinear,
        "scatter_dB": float(scatter),
        "error_dB": float(error),
        "usable": bool(abs(error) <= USABLE_dB),
    }
