"""The spectra that figures need, gathered file by file with one file in memory at a time."""

from dataclasses import dataclass

import numpy as np

from vibroimpact.excitation.force_files import read_force
from vibroimpact.excitation.line_force_spectrum import line_force_psd, line_force_rms
from vibroimpact.geometry.sections import outer_width
from vibroimpact.identify.linear.family import LinearFamily, driven_modes
from vibroimpact.identify.spectra.welch import driven_axis, psd_statistics, segment_spectra

from .cases_of_gap import paths_of_gap, shown_gap
from .linear_limits import shown_band

QUANTITIES = ("displacement", "acceleration")
# Of segments, and how those of several seeds are put together.
STATISTICS = {"mean": np.add, "min": np.minimum, "max": np.maximum}


def pooled(known, psds):
    """Return {statistic: PSD} of records together; the mean is their sum. known: of those before,
    None for none. psds: of one more.
    """
    if known is None:
        return psds
    return {name: combine(known[name], psds[name]) for name, combine in STATISTICS.items()}


@dataclass(frozen=True)
class Responses:
    """PSDs of one gap by load, and the in-plane share of all cases.

    load (load,): N RMS, ascending. frequency (frequency,): Hz.
    psd: {(quantity, sensor, statistic): (load, frequency)}; statistic is mean (over segments and
    seeds), min or max (over both).
    share: rows {gap_m, load_rms_N, seed, point, in_plane_share_dB}.
    """

    gap_m: float
    load: np.ndarray
    frequency: np.ndarray
    psd: dict
    share: list


def spectra_shown(config, paths, read):
    """Yield the spectra of files named after cases, with the variables that gather needs.

    read: function (path, names). Of gaps that are not shown, few variables are read.
    """
    names = [f"psd_{quantity}_{statistic}" for quantity in QUANTITIES for statistic in STATISTICS]
    shown = set(paths_of_gap(paths, shown_gap(config)))
    for path in paths:
        yield read(path, names if path in shown else ["psd_displacement_mean"])


def gather(config, model, spectra):
    """Return the Responses of an iterable of spectra datasets.

    PSDs are those of the largest gap in the shown band, in the driven direction. Raises ValueError
    when no dataset has that gap.
    """
    gap_m = shown_gap(config)
    driven = driven_axis(config.excitation.direction)
    highest_Hz = shown_band(model)[1]
    sums, counts, share, frequency = {}, {}, [], None
    for dataset in spectra:
        share += _in_plane_share(dataset, driven)
        if not np.isclose(dataset.attrs["gap_m"], gap_m, rtol=1e-9):
            continue
        load = float(dataset.attrs["load_rms_N"])
        counts[load] = counts.get(load, 0) + 1
        kept = dataset["frequency"].values <= highest_Hz
        frequency = dataset["frequency"].values[kept]
        sensors = [str(name) for name in dataset["sensor"].values]
        for quantity in QUANTITIES:
            whole = {name: dataset[f"psd_{quantity}_{name}"].values for name in STATISTICS}
            for index, sensor in enumerate(sensors):
                if sensor.endswith("." + driven):
                    psds = {name: psd[index, kept].astype(float) for name, psd in whole.items()}
                    by_load = sums.setdefault((quantity, sensor), {})
                    by_load[load] = pooled(by_load.get(load), psds)
    if not counts:
        raise ValueError(
            f"no spectra of the gap {gap_m} m: the figures need the cases of the configuration's"
            " largest gap"
        )
    loads = sorted(counts)
    psd = {
        (*key, name): np.array(
            [by_load[load][name] / (counts[load] if name == "mean" else 1) for load in loads]
        )
        for key, by_load in sums.items()
        for name in STATISTICS
    }
    return Responses(gap_m, np.array(loads), frequency, psd, share)


def _in_plane_share(dataset, driven):
    """Return one row per point: mean square of the other directions over the driven one, in dB."""
    powers = dataset["psd_displacement_mean"].values.sum(axis=-1, dtype=float)
    points: dict[str, dict[str, float]] = {}
    for name, power in zip(map(str, dataset["sensor"].values), powers, strict=True):
        point, _, direction = name.rpartition(".")
        points.setdefault(point, {})[direction] = power
    rows = []
    for point, power in points.items():
        across = power.pop(driven, 0.0)
        along = sum(power.values())
        if across > 0.0 and along > 0.0:
            rows.append(
                {
                    "gap_m": float(dataset.attrs["gap_m"]),
                    "load_rms_N": float(dataset.attrs["load_rms_N"]),
                    "seed": int(dataset.attrs["seed"]),
                    "point": point,
                    "in_plane_share_dB": 10.0 * np.log10(along / across),
                }
            )
    return rows


def unit_force_psd(config, frequency):
    """Return the one-sided PSD (frequency,) in N²/Hz of the drive at 1 N RMS.

    It is flat in its band, that of turbulence, or that of the measured record.
    """
    excitation = config.excitation
    if excitation.kind == "band_limited":
        low, high = excitation.band_Hz
        return np.where(inside(frequency, (low, high)), 1.0 / (high - low), 0.0)
    if excitation.kind == "turbulence":
        diameter = outer_width(config.structure.section)
        mean_square = line_force_rms(excitation, diameter) ** 2
        return line_force_psd(excitation, diameter, frequency) / mean_square
    force = read_force(excitation.file, excitation.variable, excitation.sampling_frequency_Hz)
    measured = segment_spectra(force.values, force.rate, config.spectra)
    mean = psd_statistics(measured.values)[0][0] / np.mean(np.square(force.values))
    return np.interp(frequency, measured.frequency, mean, left=0.0, right=0.0)


def linear_psds(config, model, sensor, stiffness, frequency):
    """Return the PSDs (k, frequency) in m²/Hz of a sensor of the linear tube under 1 N RMS.

    stiffness (k,): N/m per support, bilateral; no damping is added.
    """
    shape = model.sensor_shapes[:, [model.sensor_names.index(sensor)]]
    response = LinearFamily(driven_modes(model), frequency).response(shape)
    return np.array([response.psd(k, 0.0)[0] for k in stiffness]) * unit_force_psd(
        config, frequency
    )


def inside(frequency, band):
    """Return (frequency,) bool: whether frequencies in Hz lie in a band (low, high)."""
    return (frequency >= band[0]) & (frequency <= band[1])


def driven_sensor(config, point):
    """Return the name of the sensor at a point in the driven direction, e.g. apex.y."""
    return f"{point}.{driven_axis(config.excitation.direction)}"
