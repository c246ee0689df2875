"""The response of the linear tube on its equivalent support beside that of the non-linear one."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.equivalent_support.supports_prediction import (
    BANDS_HZ,
    RESOLUTION_HZ,
    Response,
    USABLE_dB,
    band_level,
    compared_row,
    displacement_and_stress,
    response_of_psds,
)
from vibroimpact.identify.linear.responses import frf
from vibroimpact.reduction.modal_model import ModalModel

# Name and largest fraction of time in contact.
REGIMES = (("hardly touching", 0.01), ("transition", 0.40), ("mostly in contact", 1.0))
EULER_GAMMA = 0.5772
TINY = np.finfo(float).tiny


@dataclass(frozen=True)
class TubeResponse(Response):
    """A Response with the values that a designer asks for.

    rms_displacement: {sensor: m}. rms_force: {support: N}. peak_stress: {section: Pa}.
    contact: fraction of time, NaN for a linear tube.
    """

    rms_displacement: dict
    rms_force: dict
    peak_stress: dict
    contact: float


def linear_response(
    model: ModalModel,
    k: float,
    c: float,
    load: float,
    band_Hz: Sequence[float],
    duration_s: float,
) -> TubeResponse:
    """Return the TubeResponse of the linear tube with support (k N/m, c N s/m).

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
    sensors = len(model.sensor_names)
    places = sensors + 2 * len(model.section_names)
    support = power[places:] * (k**2 + (2.0 * np.pi * frequency * c) ** 2)
    force = support.reshape(-1, 2, len(frequency)).sum(axis=1)
    stress = power[sensors:places].reshape(-1, 2, len(frequency)).sum(axis=1)
    step, own = frequency[1] - frequency[0], response_of_psds(model, frequency, power[:places])
    sigma = np.sqrt(stress.sum(axis=1) * step)
    rate = np.sqrt((stress * frequency**2).sum(axis=1) * step) / np.maximum(sigma, TINY)
    peaks = sigma * expected_peak_factor(rate * duration_s)
    rms = np.sqrt(power[:sensors].sum(axis=1) * step)
    return TubeResponse(
        **vars(own),
        rms_displacement=dict(zip(model.sensor_names, rms, strict=True)),
        rms_force=dict(zip(model.support_names, np.sqrt(force.sum(axis=1) * step), strict=True)),
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
) -> TubeResponse:
    """Return the TubeResponse of a non-linear record.

    record: Dataset with its statistics.
    psd (sensor, frequency): m²/Hz, of the sensors `names`.
    """
    step = frequency[1] - frequency[0]
    return TubeResponse(
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


def amplified(response: TubeResponse, gain: float) -> TubeResponse:
    """Return the TubeResponse of a linear tube to a force `gain` times as large."""

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


def synthesise_records(
    model: ModalModel,
    k: float,
    c: float,
    force: np.ndarray,
    sampling_frequency: float = 2048.0,
    output_shapes: np.ndarray | None = None,
    kind: str = "displacement",
    channel: int = 0,
) -> np.ndarray:
    """Return (output, time) response in m (m/s, m/s²) to a periodic force (time,) in N.

    Every line of the force's spectrum is multiplied by the FRF. This is exact for a force that
    repeats after its length and has nothing above half the sampling frequency. For a response
    without period, cut a stretch out of a longer record.

    k, c: stiffness in N/m and damping in N s/m of the support.
    sampling_frequency: Hz.
    output_shapes: (mode, output); model.sensor_shapes by default.
    kind, channel: as in frf.
    """
    output_shapes = model.sensor_shapes if output_shapes is None else output_shapes
    lines = np.fft.rfft(force)
    frequency = np.fft.rfftfreq(len(force), 1.0 / sampling_frequency)
    return np.fft.irfft(
        frf(model, k, c, frequency, output_shapes, kind, channel) * lines, n=len(force)
    )


def prediction_rows(
    labels: Mapping[str, Any],
    linear: TubeResponse,
    seeds: list[TubeResponse],
    sensors: Sequence[str],
) -> list[dict]:
    """Return the rows that compare a linear TubeResponse with the non-linear ones of several seeds.

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


def summary_rows(rows: Sequence[dict]) -> list[dict]:
    """Return rows per geometry, law, quantity and regime: median and worst error in dB.

    usable: "yes" where every case is within 2 dB, "with care" where the median is, else "no".
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
