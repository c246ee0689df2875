"""Prediction of a study by linear supports: one k and c for all, or each its own.

The linear structure with supports answers the force of the study. Its PSDs in bands at the sensors
and its bending stresses at the supports are compared with those of the simulated contacts that the
k and c were identified from.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.identify.estimate import table_rows
from vibroimpact.identify.identify_case import identify_case
from vibroimpact.identify.linear.responses import FREQUENCY_CHUNK
from vibroimpact.identify.linear.support_groups import ALL, reached_supports
from vibroimpact.identify.linear.supported_structure import SupportedStructure
from vibroimpact.identify.spectra.welch import driven_axis
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.study.equivalent_table import equivalent_rows
from vibroimpact.study.method_agreement import consistency_rows, summary_rows

BANDS_HZ = ((5.0, 20.0), (20.0, 40.0), (40.0, 60.0), (60.0, 100.0), (100.0, 200.0))
RESOLUTION_HZ = 0.01
USABLE_dB = 2.0  # 26 % in amplitude: the "agree" of the study
# Name of the linear supports: columns of a row of equivalent.csv that hold their k and c.
ONE, EACH, SECANT = "one for all", "each its own", "secant"
IDENTIFIED_COLUMNS = ("k_N_per_m", "c_N_s_per_m")
SECANT_COLUMNS = ("secant_k_N_per_m", "secant_c_N_s_per_m")
# Variables of the two files that are read, in addition to those of the identification.
RECORD_READ = ("stress_rms",)
SPECTRA_READ = ("psd_displacement_mean",)
COLUMNS = (
    *("gap_m", "load_rms_N", "supports", "quantity", "of", "unit"),
    *("linear", "nonlinear", "scatter_dB", "error_dB", "usable", "gain_dB", "error_with_gain_dB"),
)


@dataclass(frozen=True)
class Response:
    """The response of one tube under one load.

    frequency (frequency,): Hz. psd: {sensor: (frequency,) m²/Hz}. rms_stress: {section: Pa}.
    """

    frequency: np.ndarray
    psd: dict
    rms_stress: dict


def displacement_and_stress(model: ModalModel) -> np.ndarray:
    """Return (mode, sensor + 2 section): the sensors, then both bending stresses per section."""
    return np.hstack([model.sensor_shapes, model.stress_shapes.reshape(len(model.omega), -1)])


def response_of_psds(model: ModalModel, frequency: np.ndarray, power: np.ndarray) -> Response:
    """Return the Response of a linear tube from its PSDs on evenly spaced frequencies.

    frequency: (frequency,) Hz. power: (output, frequency) m²/Hz and Pa²/Hz, of the outputs of
    displacement_and_stress.
    """
    step, sensors = frequency[1] - frequency[0], len(model.sensor_names)
    stress = power[sensors:].reshape(-1, 2, len(frequency)).sum(axis=1)
    sigma = np.sqrt(stress.sum(axis=1) * step)
    return Response(
        frequency=frequency,
        psd=dict(zip(model.sensor_names, power[:sensors], strict=True)),
        rms_stress=dict(zip(model.section_names, sigma, strict=True)),
    )


def linear_supports(
    model: ModalModel,
    groups: str | tuple[tuple[str, ...], ...],
    rows: Sequence[Mapping],
    columns: tuple[str, str] = IDENTIFIED_COLUMNS,
) -> tuple[np.ndarray, np.ndarray]:
    """Return (k in N/m, c in N s/m), each (direction,), of one gap and load from its rows of
    equivalent.csv, for the directions that the force moves.

    A k or c that is not resolved is 0: the data can not distinguish it from no support.

    groups: identification.groups.
    columns: names of the columns with k and c.
    """
    found = {(row["group"], row["direction"]): row for row in rows}
    values = np.array(
        [
            [found[direction.group, direction.direction][column] for column in columns]
            for direction in reached_supports(model, groups)[0]
        ],
        dtype=float,
    )
    k, c = np.nan_to_num(values, nan=0.0).T
    return k, c


def supports_response(
    model: ModalModel,
    groups: str | tuple[tuple[str, ...], ...],
    supports: tuple[np.ndarray, np.ndarray],
    load: float,
    band_Hz: Sequence[float],
) -> Response:
    """Return the Response of a structure on linear supports to a force flat in a band.

    groups, supports: as in linear_supports, and its (k, c).
    load: RMS of the force, N.
    """
    frequency = np.arange(band_Hz[0], band_Hz[1], RESOLUTION_HZ)
    level = load**2 / (band_Hz[1] - band_Hz[0])
    directions, modes = reached_supports(model, groups)
    outputs = displacement_and_stress(model)
    power = np.empty((outputs.shape[1], len(frequency)))
    for first in range(0, len(frequency), FREQUENCY_CHUNK):
        part = slice(first, first + FREQUENCY_CHUNK)
        structure = SupportedStructure(model, directions, modes, frequency[part])
        response = structure.frf(structure.observed(outputs), *supports)
        power[:, part] = np.sum(response.real**2 + response.imag**2, axis=-1).T * level
    return response_of_psds(model, frequency, power)


def one_for_all(
    settings_of_all: StageSettings,
    model: ModalModel,
    records: Sequence[xr.Dataset],
    spectra: Sequence[xr.Dataset],
) -> list[dict]:
    """Return the rows of equivalent.csv that one k and c for all supports has in the same cases.

    settings_of_all: configuration with excitation and identification, whose groups is "all".
    Raises ValueError for other groups.
    """
    if settings_of_all.identification.groups != ALL:
        raise ValueError("identification.groups must be all for one k and c for all supports")
    tables = [
        table_rows(identify_case(settings_of_all, model, record, of_case)[0], record.attrs)
        for record, of_case in zip(records, spectra, strict=True)
    ]
    return equivalent_rows(summary_rows(consistency_rows(tables)))


def supports_prediction_rows(
    settings: StageSettings,
    model: ModalModel,
    equivalent: Mapping[str, Sequence[Mapping]],
    records: Sequence[xr.Dataset],
    spectra: Sequence[xr.Dataset],
) -> list[dict]:
    """Return the rows, with COLUMNS, that compare linear supports with the simulated contacts.

    There are those of one k and c for all, of each its own, and of the secant values of each. An
    identification from responses alone does not give the level of the force, so that one gain of
    the input is free: gain_dB makes the mean error of the sensors in the whole band 0, in dB, and
    error_with_gain_dB is the rest.

    settings: configuration with excitation and identification.
    equivalent: {ONE or EACH: rows of equivalent.csv}, both of the same cases.
    records, spectra: of the cases, in the same order.
    Raises ValueError for a force that is not flat in a band.
    """
    excitation = settings.excitation
    if excitation.kind != "band_limited":
        raise ValueError(
            f"the prediction by linear supports needs an excitation of kind band_limited, not"
            f" {excitation.kind}"
        )
    groups = settings.identification.groups
    kinds = (
        (ONE, ONE, ALL, IDENTIFIED_COLUMNS),
        (EACH, EACH, groups, IDENTIFIED_COLUMNS),
        (SECANT, EACH, groups, SECANT_COLUMNS),
    )
    axis = "." + driven_axis(excitation.direction)
    sensors = [name for name in model.sensor_names if name.endswith(axis)]
    rows = []
    for (gap_m, load), seeds in _recorded(model, records, spectra).items():
        for name, table, grouped, columns in kinds:
            of_case = [
                row
                for row in equivalent[table]
                if np.isclose(row["gap_m"], gap_m) and np.isclose(row["load_rms_N"], load)
            ]
            supports = linear_supports(model, grouped, of_case, columns)
            linear = supports_response(model, grouped, supports, load, excitation.band_Hz)
            labels = {"gap_m": gap_m, "load_rms_N": load, "supports": name}
            compared = _compared(linear, seeds, sensors, excitation.band_Hz, model.support_names)
            # one gain of the input, from the first rows, the sensors in the whole band
            gain = -float(np.mean([row["error_dB"] for row in compared[: len(sensors)]]))
            rows += [
                {**labels, **row, "gain_dB": gain, "error_with_gain_dB": row["error_dB"] + gain}
                for row in compared
            ]
    return rows


def _recorded(
    model: ModalModel, records: Sequence[xr.Dataset], spectra: Sequence[xr.Dataset]
) -> dict[tuple[float, float], list[Response]]:
    """Return {(gap, load): Responses of the seeds} of simulated cases."""
    cases: dict[tuple[float, float], list[Response]] = {}
    for record, of_case in zip(records, spectra, strict=True):
        psd = of_case["psd_displacement_mean"].values.astype(float)
        sections = [str(name) for name in record["section"].values]
        response = Response(
            of_case["frequency"].values,
            dict(zip(model.sensor_names, psd, strict=True)),
            dict(zip(sections, record["stress_rms"].values, strict=True)),
        )
        place = (float(record.attrs["gap_m"]), float(record.attrs["load_rms_N"]))
        cases.setdefault(place, []).append(response)
    return cases


def _compared(
    linear: Response,
    seeds: list[Response],
    sensors: Sequence[str],
    band_Hz: Sequence[float],
    supports: Sequence[str],
) -> list[dict]:
    """Return the rows of one case: RMS in bands, the whole one first; stress at the supports."""
    bands = [
        (max(low, band_Hz[0]), min(high, band_Hz[1]))
        for low, high in (band_Hz, *BANDS_HZ)
        if low < band_Hz[1] and high > band_Hz[0]
    ]
    rows = []
    for low, high in bands:
        quantity = f"RMS displacement {low:g}-{high:g} Hz"
        for sensor in sensors:
            ours, *theirs = (
                band_level(response, sensor, low, high) * np.sqrt(high - low)
                for response in (linear, *seeds)
            )
            rows.append(compared_row(quantity, sensor, "m", ours, theirs))
    for support in supports:
        section = f"{support}_middle"
        if section in linear.rms_stress:
            ours, *theirs = (response.rms_stress[section] for response in (linear, *seeds))
            rows.append(compared_row("RMS bending stress", support, "Pa", ours, theirs))
    return rows


def band_level(response: Response, sensor: str, low: float, high: float) -> float:
    """Return the root of a sensor's mean PSD between two frequencies in Hz, in m/sqrt(Hz)."""
    inside = (response.frequency >= low) & (response.frequency < high)
    return float(np.sqrt(np.mean(response.psd[sensor][inside])))


def compared_row(quantity: str, of: str, unit: str, linear: float, seeds: Sequence[float]) -> dict:
    """Return the columns that compare a linear value with those of several seeds.

    quantity, of, unit; linear, nonlinear (root mean square over seeds), scatter_dB (standard
    error), error_dB, and usable: whether that is within USABLE_dB.
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
