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
from vibroimpact.identify.linear.support_groups import ALL, SupportDirection, reached_supports
from vibroimpact.identify.linear.supported_structure import SupportedStructure
from vibroimpact.identify.spectra.welch import driven_axis
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.study.equivalent_table import equivalent_rows
from vibroimpact.study.method_agreement import consistency_rows, summary_rows

from .linear_prediction import (
    BANDS_HZ,
    RESOLUTION_HZ,
    Response,
    band_level,
    compared_row,
    displacement_and_stress,
    recorded_response,
    response_of_psds,
)

# Name of the linear supports: columns of a row of equivalent.csv that hold their k and c.
ONE, EACH, SECANT = "one for all", "each its own", "secant"
IDENTIFIED_COLUMNS = ("k_N_per_m", "c_N_s_per_m")
SECANT_COLUMNS = ("secant_k_N_per_m", "secant_c_N_s_per_m")
# Variables of the two files that are read, in addition to those of the identification.
RECORD_READ = ("stress_rms", "stress_peak", "rms_force", "contact_fraction")
SPECTRA_READ = ("psd_displacement_mean",)
COLUMNS = (
    *("gap_m", "load_rms_N", "supports", "quantity", "of", "unit"),
    *("linear", "nonlinear", "scatter_dB", "error_dB", "usable", "gain_dB", "error_with_gain_dB"),
)


@dataclass(frozen=True, eq=False)
class LinearSupports:
    """The supports of a linear structure.

    directions: SupportDirections that the force moves; modes: indices of the modes that it moves.
    k, c: (direction,) N/m and N s/m.
    """

    directions: tuple[SupportDirection, ...]
    modes: np.ndarray
    k: np.ndarray
    c: np.ndarray


def linear_supports(
    model: ModalModel,
    groups: str | tuple[tuple[str, ...], ...],
    rows: Sequence[Mapping],
    columns: tuple[str, str] = IDENTIFIED_COLUMNS,
) -> LinearSupports:
    """Return the LinearSupports of one gap and load from its rows of equivalent.csv.

    A k or c that is not resolved is 0: the data can not distinguish it from no support.

    groups: identification.groups.
    columns: names of the columns with k and c.
    """
    directions, modes = reached_supports(model, groups)
    found = {(row["group"], row["direction"]): row for row in rows}
    values = np.array(
        [
            [found[direction.group, direction.direction][column] for column in columns]
            for direction in directions
        ],
        dtype=float,
    )
    k, c = np.nan_to_num(values, nan=0.0).T
    return LinearSupports(directions, modes, k, c)


def supports_response(
    model: ModalModel,
    supports: LinearSupports,
    load: float,
    band_Hz: Sequence[float],
    duration_s: float,
) -> Response:
    """Return the Response of a structure on linear supports to a force flat in a band.

    The force of a support is k + i omega c times the displacement of its points, by their share.

    load: RMS of the force, N.
    duration_s: for the peak stress.
    """
    frequency = np.arange(band_Hz[0], band_Hz[1], RESOLUTION_HZ)
    level = load**2 / (band_Hz[1] - band_Hz[0])
    shapes, owner, place = _mean_motion(model, supports.directions)
    outputs = np.hstack([displacement_and_stress(model), shapes])
    power = np.empty((outputs.shape[1], len(frequency)))
    for first in range(0, len(frequency), FREQUENCY_CHUNK):
        part = slice(first, first + FREQUENCY_CHUNK)
        structure = SupportedStructure(model, supports.directions, supports.modes, frequency[part])
        response = structure.frf(structure.observed(outputs), supports.k, supports.c)
        power[:, part] = np.sum(response.real**2 + response.imag**2, axis=-1).T * level
    places = outputs.shape[1] - shapes.shape[1]
    omega = 2.0 * np.pi * frequency
    square = supports.k[owner, None] ** 2 + (supports.c[owner, None] * omega) ** 2
    force = np.zeros((len(model.support_names), len(frequency)))
    np.add.at(force, place, power[places:] * square)
    return response_of_psds(model, frequency, power[:places], force, duration_s)


def _mean_motion(
    model: ModalModel, directions: Sequence[SupportDirection]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (shapes (mode, pair), index of the direction (pair,), index of the support (pair,)).

    A pair is a support in a direction; its shape is the mean displacement of its points by share.
    """
    shapes, owner, place = [], [], []
    for index, direction in enumerate(directions):
        along = np.einsum("mpd,pd->mp", model.contact_shapes[:, direction.rows], direction.along)
        weighted = along * model.contact_weight[direction.rows]
        support = model.support_of_point[direction.rows]
        for number in np.unique(support):
            shapes.append(weighted[:, support == number].sum(axis=1))
            owner.append(index)
            place.append(number)
    return np.stack(shapes, axis=1), np.array(owner), np.array(place)


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

    settings: configuration with excitation, identification and record.duration_s.
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
            linear = supports_response(
                model, supports, load, excitation.band_Hz, settings.record.duration_s
            )
            labels = {"gap_m": gap_m, "load_rms_N": load, "supports": name}
            compared = _compared(linear, seeds, sensors, excitation.band_Hz, model.support_names)
            rows += [{**labels, **row} for row in _with_gain(compared, len(sensors))]
    return rows


def _with_gain(rows: list[dict], sensors: int) -> list[dict]:
    """Return the rows of one case with one gain of the input.

    sensors: number of the first rows, the sensors in the whole band.
    """
    gain = -float(np.mean([row["error_dB"] for row in rows[:sensors]]))
    return [{**row, "gain_dB": gain, "error_with_gain_dB": row["error_dB"] + gain} for row in rows]


def _recorded(
    model: ModalModel, records: Sequence[xr.Dataset], spectra: Sequence[xr.Dataset]
) -> dict[tuple[float, float], list[Response]]:
    """Return {(gap, load): Responses of the seeds} of simulated cases."""
    cases: dict[tuple[float, float], list[Response]] = {}
    for record, of_case in zip(records, spectra, strict=True):
        frequency = of_case["frequency"].values
        psd = of_case["psd_displacement_mean"].values.astype(float)
        response = recorded_response(record, frequency, psd, model.sensor_names)
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
            values = [seed.rms_stress[section] for seed in seeds]
            rows.append(
                compared_row(
                    "RMS bending stress", support, "Pa", linear.rms_stress[section], values
                )
            )
    return rows
