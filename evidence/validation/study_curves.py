"""Results of the default study against load, at one gap, as plain arrays."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vibroimpact.io.records import read_record, read_table
from vibroimpact.study.cases import Case, load_values

POLES = ("peak_half", "peak_quarter", "peak_25th", "lscf")
STIFFNESS = ("lscf", "ods", "broadband")


@dataclass(frozen=True)
class StudyCurves:
    """Results at one gap; NaN where a method resolves nothing.

    gap_m: m. load (load,): N RMS.
    pole_frequency, pole_damping: {method: (load, seed)}, Hz and damping ratio.
    stiffness, support_damping: {method: (load, seed)}, N/m and N s/m.
    frequency (frequency,): Hz.
    psd: {sensor: (load, seed, frequency)}, displacement, m²/Hz.
    shape (load, seed, line_point): complex operational deflection shape.
    arc_length (line_point,): m.
    singular (load, seed, value): singular values of the response.
    contact (load,): mean fraction of time in contact.
    band_width_Hz: of the drive, whose PSD is flat.
    top_frequency: {gap m: Hz} of the lscf pole at the largest load.
    collapse, summary: rows of consistency_collapse.csv and consistency_summary.csv.
    """

    gap_m: float
    load: np.ndarray
    pole_frequency: dict
    pole_damping: dict
    stiffness: dict
    support_damping: dict
    frequency: np.ndarray
    psd: dict
    shape: np.ndarray
    arc_length: np.ndarray
    singular: np.ndarray
    contact: np.ndarray
    band_width_Hz: float
    top_frequency: dict
    collapse: list
    summary: list

    @property
    def touching(self):
        """Return (load,) whether the tube touches its supports at all."""
        return self.contact > 0.0


def read_curves(config, model, results: Path, gap: float) -> StudyCurves:
    """Return the StudyCurves at one gap of a finished study.

    config, model: of the study, with model its ModalModel.
    results: folder of its results.
    gap: m.

    Raises RecordError.
    """
    loads, seeds = load_values(config.grid), range(config.grid.seeds)
    every = read_table(results / "consistency.csv")
    rows = [row for row in every if row["gap_m"] == gap]
    sensors = [name for name in model.sensor_names if name.endswith(".y")]
    spectra, shapes, singular, contact = [], [], [], []
    for load in loads:
        names = [Case(load, float(gap), seed).id for seed in seeds]
        found = [read_record(results / "spectra" / f"{name}.nc") for name in names]
        spectra.append([each["psd_displacement_mean"].sel(sensor=sensors).values for each in found])
        curves = [read_record(results / "estimates" / f"{name}.nc") for name in names]
        shapes.append([each["ods_re"].values + 1j * each["ods_im"].values for each in curves])
        singular.append([each["singular_value"].values for each in curves])
        contact.append(
            np.mean(
                [
                    read_record(results / "records" / f"{name}.nc")["contact_fraction"].values
                    for name in names
                ]
            )
        )
    psd = np.array(spectra, dtype=float)
    return StudyCurves(
        gap_m=float(gap),
        load=np.array(loads),
        pole_frequency={
            method: _table(rows, loads, seeds, method, "frequency_Hz") for method in POLES
        },
        pole_damping={
            method: _table(rows, loads, seeds, method, "damping_ratio") for method in POLES
        },
        stiffness={
            method: _table(rows, loads, seeds, method, "k_N_per_m")
            for method in (*STIFFNESS, *POLES[:3])
        },
        support_damping={
            method: _table(rows, loads, seeds, method, "c_N_s_per_m")
            for method in (*STIFFNESS, *POLES[:3])
        },
        frequency=found[0]["frequency"].values,
        psd={name: psd[:, :, index] for index, name in enumerate(sensors)},
        shape=np.array(shapes),
        arc_length=model.line_arc_length,
        singular=np.array(singular),
        contact=np.array(contact),
        band_width_Hz=config.excitation.band_Hz[1] - config.excitation.band_Hz[0],
        top_frequency={
            gap_m: float(
                np.nanmedian(
                    [
                        row["frequency_Hz"]
                        for row in every
                        if row["gap_m"] == gap_m
                        and row["load_rms_N"] == loads[-1]
                        and row["method"] == "lscf"
                    ]
                )
            )
            for gap_m in config.grid.gap_m
        },
        collapse=read_table(results / "consistency_collapse.csv"),
        summary=read_table(results / "consistency_summary.csv"),
    )


def _table(rows, loads, seeds, method, column):
    values = {
        (row["load_rms_N"], row["seed"]): row[column] for row in rows if row["method"] == method
    }
    return np.array(
        [[values.get((load, seed), np.nan) for seed in seeds] for load in loads], dtype=float
    )


def median(values):
    """Return (load,) medians over seeds of values (load, seed).

    NaN where fewer than half of the seeds have a value.
    """
    values = np.asarray(values, dtype=float)
    enough = 2 * np.isfinite(values).sum(axis=1) >= values.shape[1]
    return np.array(
        [np.nanmedian(row) if kept else np.nan for row, kept in zip(values, enough, strict=True)]
    )


def standard_error(values):
    """Return (load,) standard errors of the mean over seeds of values (load, seed).

    NaN where fewer than two seeds have a value.
    """
    values = np.asarray(values, dtype=float)
    count = np.isfinite(values).sum(axis=1)
    return np.array(
        [
            np.nanstd(row, ddof=1) / np.sqrt(number) if number > 1 else np.nan
            for row, number in zip(values, count, strict=True)
        ]
    )
