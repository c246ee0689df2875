"""Comparison of the equivalent linear tube with the non-linear one, in cases not fitted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.linear.responses import frf
from vibroimpact.reduction.modal_model import ModalModel

BANDS_HZ = ((5.0, 20.0), (20.0, 40.0), (40.0, 60.0), (60.0, 100.0), (100.0, 200.0))
RESOLUTION_HZ = 0.01
USABLE_dB = 2.0  # 26 % in amplitude: the "agree" of the study
# Name and largest fraction of time in contact.
REGIMES = (("hardly touching", 0.01), ("transition", 0.40), ("mostly in contact", 1.0))
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


def linear_response(
    model: ModalModel,
    k: float,
    c: float,
    load: float,
    band_Hz: Sequence[float],
    duration_s: float,
) -> Response:
    """Return the Response of the linear tube with support (k N/m, c N s/m).

    load: RMS of the force, N, flat in band_Hz.
    duration_s: for the peak stress.

    Peak stress: expected maximum of a Gaussian process over the duration, sigma (sqrt(2 ln n) +
    0.5772 / sqrt(2 ln n)), n upcrossings. Source: Davenport 1964. Plate force: (k + i omega c)
    times the displacement of the points, summed by their share.
    """
    frequency = np.arange(band_Hz[0], band_Hz[1], RESOLUTION_HZ)
    level = load**2 / (band_Hz[1] - band_Hz[0])
    outputs = np.hstack([displacement_and_stress(model), _support_shapes(model)])
    power = np.abs(frf(model, k, c, frequency, outputs)) ** 2 * level
    places = len(model.sensor_names) + 2 * len(model.section_names)
    support = power[places:] * (k**2 + (2.0 * np.pi * frequency * c) ** 2)
    force = support.reshape(-1, 2, len(frequency)).sum(axis=1)
    return response_of_psds(model, frequency, power[:places], force, duration_s)


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


def amplified(response: Response, gain: float) -> Response:
    """Return the Response of a linear tube to a force `gain` times as large."""

    def times(values: dict[str, float]) -> dict[str, float]:
        return {place: gain * value for place, value in values.items()}

    return replace(
        response,
        psd={name: gain**2 * psd for name, psd in response.psd.items()},
        rms_displacement=times(response.rms_displacement),
        rms_force=times(response.rms_force),
        rms_stress=times(response.rms_stress),
        peak_stress=times(response.peak_stress),
    )


def expected_peak_factor(crossings: Any) -> Any:
    """Return the expected maximum of a Gaussian process, in standard deviations.

    crossings: expected number of upcrossings of the mean.
    """
    root = np.sqrt(2.0 * np.log(np.maximum(crossings, 2.0)))
    return root + EULER_GAMMA / root


def _support_shapes(model):
    """Return (mode, 2 per support): displacement conjugate to the resultant of each support."""
    weighted = model.contact_shapes * model.contact_weight[:, None]
    return np.concatenate(
        [
            weighted[:, model.support_of_point == number].sum(axis=1)
            for number in range(len(model.support_names))
        ],
        axis=1,
    )


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


def prediction_rows(
    labels: Mapping[str, Any], linear: Response, seeds: list[Response], sensors: Sequence[str]
) -> list[dict]:
    """Return the rows that compare one linear Response with the non-linear ones of several seeds.

    labels: columns that identify the case.
    sensors: those whose displacement is compared (the driven direction).

    Row keys: labels, regime, quantity, of, unit, linear, nonlinear (root mean square over seeds),
    scatter_dB (standard error), error_dB, usable.
    """
    contact = float(np.mean([seed.contact for seed in seeds]))
    regime = next(name for name, limit in REGIMES if contact <= limit)
    rows = []
    for sensor in sensors:
        rows.append(
            compared_row(
                "RMS displacement",
                sensor,
                "m",
                linear.rms_displacement[sensor],
                [seed.rms_displacement[sensor] for seed in seeds],
            )
        )
        for low, high in BANDS_HZ:
            pair = [
                band_level(linear, sensor, low, high),
                *(band_level(seed, sensor, low, high) for seed in seeds),
            ]
            rows.append(
                compared_row(f"PSD {low:g}-{high:g} Hz", sensor, "m/sqrt(Hz)", pair[0], pair[1:])
            )
    for quantity, unit, name in (
        ("RMS plate force", "N", "rms_force"),
        ("RMS bending stress", "Pa", "rms_stress"),
        ("peak bending stress", "Pa", "peak_stress"),
    ):
        ours = getattr(linear, name)
        places = ours if name == "rms_force" else _largest(ours)
        rows += [
            compared_row(
                quantity, place, unit, ours[place], [getattr(seed, name)[place] for seed in seeds]
            )
            for place in places
        ]
    return [{**labels, "contact_fraction": contact, "regime": regime, **row} for row in rows]


def _largest(values, count=3):
    """Return the sections with the largest stress, which a designer checks."""
    return sorted(values, key=values.get, reverse=True)[:count]


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


def summary_rows(rows: Sequence[dict]) -> list[dict]:
    """Return rows per geometry, law, quantity and regime: median and worst error in dB.

    usable: "yes" if every case is within 2 dB, "with care" if the median is, else "no".
    """
    groups: dict[tuple, list[float]] = {}
    for row in rows:
        if np.isfinite(row["error_dB"]):
            key = (row["geometry"], row["law"], row["quantity"], row["regime"])
            groups.setdefault(key, []).append(row["error_dB"])
    table = []
    for (geometry, law, quantity, regime), errors in groups.items():
        worst, middle = max(errors, key=abs), float(np.median(errors))
        verdict = (
            "yes" if abs(worst) <= USABLE_dB else "with care" if abs(middle) <= USABLE_dB else "no"
        )
        table.append(
            {
                "geometry": geometry,
                "law": law,
                "quantity": quantity,
                "regime": regime,
                "cases": len(errors),
                "median_error_dB": middle,
                "worst_error_dB": float(worst),
                "may_be_used": verdict,
            }
        )
    return table
