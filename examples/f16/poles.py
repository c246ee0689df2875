"""Poles and shapes of the F-16 near 7.3 Hz, where its wing carries a payload on a loose mounting.

    python examples/f16/poles.py POLES.csv FILE.mat [FILE.mat ...]

Source of the data: J.P. Noel, M. Schoukens, "F-16 aircraft benchmark based on ground vibration test
data", Workshop on Nonlinear System Identification Benchmarks, 2017. The force is a random-phase
multisine of whole periods: spectra at its lines need no window. Since the force was measured, the
methods work on frequency responses instead of output spectra. There is no model: no (k, c).
"""

import re
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.io import loadmat

from vibroimpact.identify.linear.poles import frequency_of
from vibroimpact.identify.lscf import NormalEquations
from vibroimpact.identify.ods import deflection_shape
from vibroimpact.identify.peak import LEVELS, find_peak, fit_peak
from vibroimpact.identify.spectra.window_leakage import spectral_kernel
from vibroimpact.identify.stabilisation import nearest_pole, stabilisation_chart
from vibroimpact.io.records import write_table

PERIOD_SAMPLES = 8192
TRANSIENT_PERIODS = 1
EXCITED_HZ = (2.0, 15.0)
SEARCH_HZ = (6.8, 7.8)  # the mode of the payload's mounting
PAYLOAD = 2  # channel 3, on the payload's side of the mounting
HIGHEST_ORDER = 40
REACH_HZ = 0.35
WEAK_ABOVE = 0.25  # relative standard error of the damping ratio


@dataclass(frozen=True)
class Response:
    """Response of one level: frequency (line,) Hz, contiguous from 0; per_force (channel, line)
    (m/s²)/N, zero outside the excited lines; level number; load_rms_N over the periods used.
    """

    level: int
    load_rms_N: float
    frequency: np.ndarray
    per_force: np.ndarray

    def receptance(self):
        """Return (channel, line) displacement per force in m/N."""
        omega = 2.0 * np.pi * np.maximum(self.frequency, self.frequency[1])
        return self.per_force / -(omega**2)


def read_response(path):
    """Return the Response of one MAT file of the benchmark: mean over the periods after the
    transient one, line by line.

    Raises ValueError when the file's name has no level, or the record is no whole number of
    periods.
    """
    found = re.search(r"Level(\d+)", Path(path).stem)
    if found is None:
        raise ValueError(
            f"{path}: the name must hold the level, as in F16Data_FullMSine_Level3.mat"
        )
    data = loadmat(path)
    force = data["Force"].ravel()
    acceleration = data["Acceleration"]
    rate = float(data["Fs"].ravel()[0])
    if force.size % PERIOD_SAMPLES:
        raise ValueError(
            f"{path}: {force.size} samples are no whole number of periods of {PERIOD_SAMPLES}"
        )
    force = force.reshape(-1, PERIOD_SAMPLES)[TRANSIENT_PERIODS:]
    periods = acceleration.reshape(len(acceleration), -1, PERIOD_SAMPLES)[:, TRANSIENT_PERIODS:]
    frequency = np.fft.rfftfreq(PERIOD_SAMPLES, 1.0 / rate)
    excited = (frequency >= EXCITED_HZ[0]) & (frequency <= EXCITED_HZ[1])
    lines, driven = np.fft.rfft(periods.mean(axis=1), axis=-1), np.fft.rfft(force.mean(axis=0))
    per_force = np.where(excited, lines / np.where(excited, driven, 1.0), 0.0)
    return Response(int(found.group(1)), float(np.sqrt(np.mean(force**2))), frequency, per_force)


def pole_table(paths):
    """Return the rows of poles.csv, dicts, one per level and method, levels ascending.

    peak_line_Hz and channel_3_per_force (m/s²)/N: the line where the payload's response per force
    is largest in SEARCH_HZ, and its size. shape_<n>_re and _im: channel n over channel 1, at that
    line (peak methods), as residue (lscf), as first singular vector (ods).
    """
    rows = []
    for response in sorted((read_response(path) for path in paths), key=lambda item: item.level):
        inside = np.flatnonzero(
            (response.frequency >= SEARCH_HZ[0]) & (response.frequency <= SEARCH_HZ[1])
        )
        line = inside[np.argmax(np.abs(response.per_force[PAYLOAD, inside]))]
        shared = {"level": response.level, "load_rms_N": response.load_rms_N}
        peak = {
            "peak_line_Hz": float(response.frequency[line]),
            "channel_3_per_force": float(np.abs(response.per_force[PAYLOAD, line])),
        }
        for method, pole, shape in _methods(response, line):
            rows.append(
                shared
                | {"method": method}
                | pole
                | peak
                | _shape_columns(shape)
                | {"quality": _quality(method, pole)}
            )
    return rows


def _methods(response, line):
    """Yield (method, pole columns, shape (channel,) complex) of every method."""
    fits = {method: _fit_peak(response, level) for method, level in LEVELS.items()}
    for method, (pole, _) in fits.items():
        yield method, pole, response.per_force[:, line]
    yield "lscf", *_lscf(response, line)
    edges = fits["peak_25th"][1].edges_Hz if fits["peak_25th"][1] is not None else SEARCH_HZ
    yield (
        "ods",
        _pole_columns(),
        deflection_shape(response.receptance()[:, None, :], response.frequency, edges).shape,
    )


def _fit_peak(response, level):
    """Return (pole columns, PeakFit or None) of the payload's peak at one level.

    The lines of one multisine scatter about the curve by the structure's own distortion; that
    scatter sets the standard error.
    """
    kernel = spectral_kernel("none", 1.0 / response.frequency[1])
    psd = np.abs(response.receptance()[PAYLOAD]) ** 2
    fit = fit_peak(
        response.frequency,
        psd,
        kernel,
        level,
        find_peak(response.frequency, psd, SEARCH_HZ, smoothing_bins=3),
        averages=2.0,
    )
    if fit is None:
        return _pole_columns(), None
    weights = np.minimum(1.0, level * fit.curve / fit.curve.max())
    scatter = (
        np.sum(weights * (psd[fit.bins] / fit.curve - 1.0) ** 2)
        / np.sum(weights)
        * fit.curve.size
        / (fit.curve.size - 3.0)
    )
    return (
        _pole_columns(
            (fit.frequency, fit.damping_ratio), np.sqrt(scatter * np.diag(fit.covariance))
        ),
        fit,
    )


def _lscf(response, line):
    """Return (pole columns, shape (channel,)) of the pole nearest to the payload's peak, from the
    longest stable column of the chart.
    """
    excited = (response.frequency >= EXCITED_HZ[0]) & (response.frequency <= EXCITED_HZ[1])
    frequency, values = response.frequency[excited], response.per_force[:, None, excited]
    chart = stabilisation_chart(
        NormalEquations(frequency, values, HIGHEST_ORDER), 0.0, range(2, HIGHEST_ORDER + 1)
    )
    poles = stable_column(chart, 2j * np.pi * response.frequency[line], REACH_HZ)
    if poles.size == 0:
        return _pole_columns(), np.full(len(response.per_force), np.nan)
    places, ratios = frequency_of(poles)
    found = float(np.median(places)), float(np.median(ratios))
    near = np.abs(frequency - found[0]) < REACH_HZ
    omega, pole = 2j * np.pi * frequency[near], poles[np.argmin(np.abs(ratios - found[1]))]
    # The other modes are a constant and a slope this near to the pole.
    columns = np.stack(
        [1.0 / (omega - pole), 1.0 / (omega - pole.conj()), np.ones(near.sum()), omega], axis=1
    )
    residues = np.linalg.lstsq(columns, values[:, 0, near].T, rcond=None)[0]
    return _pole_columns(found, (np.std(places), np.std(ratios))), residues[0]


def stable_column(chart, start, radius_Hz):
    """Return the poles (order,) in rad/s of the longest run of orders with a stable pole.

    It serves frequency responses of a structure without a model: there is little noise, and the
    order must grow until every mode of the band has found its pole. Empty if there is none.
    Arguments as in first_stable_order.
    """
    longest = []
    run = []
    last = start
    for order in np.unique(chart.order):
        here = np.flatnonzero((chart.order == order) & chart.stable)
        chosen = nearest_pole(chart.pole[here], last, radius_Hz)
        if chosen is None:
            run = []
            continue
        last = chart.pole[here[chosen]]
        run = [*run, last]
        longest = run if len(run) > len(longest) else longest
    return np.array(longest)


def _pole_columns(pole=(np.nan, np.nan), errors=(np.nan, np.nan)):
    return {
        "frequency_Hz": float(pole[0]),
        "frequency_standard_error_Hz": float(errors[0]),
        "damping_ratio": float(pole[1]),
        "damping_ratio_standard_error": float(errors[1]),
    }


def _shape_columns(shape):
    """Return the shape over channel 1 as columns."""
    relative = shape / shape[0]
    return {
        f"shape_{channel + 1}_{part}": float(getattr(value, name))
        for channel, value in enumerate(relative)
        for part, name in (("re", "real"), ("im", "imag"))
    }


def _quality(method, pole):
    """Return ok, weak or unresolved; a shape alone has no pole to be judged by."""
    if method == "ods":
        return "ok"
    if not np.isfinite(pole["frequency_Hz"]):
        return "unresolved"
    return (
        "ok"
        if pole["damping_ratio_standard_error"] <= WEAK_ABOVE * pole["damping_ratio"]
        else "weak"
    )


if __name__ == "__main__":
    poles_file, *record_files = sys.argv[1:]
    try:
        write_table(pole_table(record_files), poles_file)
    except ValueError as error:
        sys.exit(str(error))
