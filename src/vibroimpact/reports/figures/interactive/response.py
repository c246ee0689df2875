"""The response at any load: the spectrum of a sensor, mean over segments and seeds, with their
extremes, and the deflection shape along the tube, animated.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.identify.spectra.welch import complex_values, psd_statistics, segment_spectra
from vibroimpact.reports.figures.plot import Axis, Panel, Series
from vibroimpact.reports.figures.study.cases_of_gap import paths_at
from vibroimpact.reports.figures.study.psd_table import STATISTICS, pooled
from vibroimpact.reports.figures.study.shapes import linear_limits, supports
from vibroimpact.reports.figures.style import BLUE, GREY

from .page_plot import PagePlot, Place

SERIES = ("displacement",)
MOST_DECADES = 10.0  # of the axis; below is round-off of a sine
OUTSIDE = 1e-4  # share of the power that a band may leave out at each end
Band = tuple[float, float]
BLOCKS = 700  # of the frequency axis
COLUMN = "psd_m2_per_Hz"


def spectra_of_sensor(
    paths: Sequence[str | Path], read: Callable, sensor: str, places: Sequence[Place]
) -> tuple[np.ndarray, dict[Place, dict[str, np.ndarray]]]:
    """Return (frequency in Hz, {(gap in m, load): {statistic: PSD in m²/Hz}}) of one sensor.

    paths: files of spectra named after their cases; read: function (path, names).
    places: the (gap, load) that are wanted.

    The mean is over segments and seeds, min and max over both.
    """
    names = {statistic: f"psd_displacement_{statistic}" for statistic in STATISTICS}
    found: dict[Place, dict[str, np.ndarray]] = {}
    counts, frequency = Counter[Place](), np.zeros(0)
    for place, path in paths_at(paths, places):
        dataset = read(path, [*names.values()])
        at = [str(name) for name in dataset["sensor"].values].index(sensor)
        frequency = dataset["frequency"].values
        psds = {key: dataset[name].values[at].astype(float) for key, name in names.items()}
        found[place] = pooled(found.get(place), psds)
        counts[place] += 1
    for place, psds in found.items():
        psds["mean"] = psds["mean"] / counts[place]
    return frequency, found


def spectra_of_series(
    paths: Sequence[str | Path], read: Callable, settings: Any, places: Sequence[Place]
) -> tuple[str, np.ndarray, dict[Place, dict[str, np.ndarray]]]:
    """Return (sensor, frequency, spectra) as spectra_of_sensor does, from time series.

    For a study that keeps its time series and identifies nothing. The sensor is the one that moves
    most at the largest load; the spectra are those of the first seed. They are empty if no
    segment fits in a record.

    paths: files of time series named after their cases.
    settings: section of the configuration with segment_s, overlap and window.
    """
    first: dict[Place, str | Path] = {}
    for place, path in paths_at(paths, places):
        first.setdefault(place, path)
    if not first:
        return "", np.zeros(0), {}
    loudest = read(first[max(first, key=lambda place: place[1])], SERIES)
    at = int(np.argmax(np.mean(np.square(loudest["displacement"].values), axis=-1)))
    found, frequency = {}, np.zeros(0)
    for place, path in first.items():
        dataset = read(path, SERIES)
        rate = float(dataset.attrs["sampling_frequency"])
        signal = dataset["displacement"].values[at]
        if signal.size < settings.segment_s * rate:
            return "", np.zeros(0), {}
        segments = segment_spectra(signal, rate, settings)
        frequency = segments.frequency
        found[place] = {
            name: values[0].astype(float)
            for name, values in zip(STATISTICS, psd_statistics(segments.values), strict=True)
        }
    return str(loudest["sensor"].values[at]), frequency, found


def band_of(frequency: np.ndarray, spectra: dict[Place, dict[str, np.ndarray]]) -> Band:
    """Return (low, high) in Hz of the band that holds nearly all of the motion at every load."""
    low, high = frequency[-1], frequency[1]
    for values in spectra.values():
        power = np.cumsum(values["mean"][1:])
        inside = frequency[1:][(power > OUTSIDE * power[-1]) & (power < (1 - OUTSIDE) * power[-1])]
        if inside.size:
            low, high = min(low, inside[0]), max(high, inside[-1])
    return max(0.5 * low, frequency[1]), min(1.5 * high, frequency[-1])


def blocks_of(frequency: np.ndarray, band_Hz: Band) -> np.ndarray:
    """Return the first indices of blocks of lines inside a band, then the index after the last.

    Blocks grow with frequency: a low one holds one line, so that no low peak is blunted.
    """
    first, last = np.searchsorted(frequency, band_Hz)
    if last - first <= BLOCKS:
        return np.arange(first, last + 1)
    wanted = np.geomspace(max(frequency[first], 1e-6), frequency[last - 1], BLOCKS)
    starts = np.unique(np.searchsorted(frequency, wanted))
    return np.append(starts[(starts >= first) & (starts < last)], last)


def spectrum_plot(
    frequency: np.ndarray,
    spectra: dict[Place, dict[str, np.ndarray]],
    sensor: str,
    band_Hz: Band,
    over: str,
) -> PagePlot:
    """Return the plot of the spectrum of a sensor by gap and load.

    frequency, spectra: of spectra_of_sensor.
    band_Hz: the band that is shown.
    over: the things that the mean is over.
    """
    edges = blocks_of(frequency, band_Hz)
    sizes = np.diff(edges)
    inside = slice(edges[0], edges[-1])
    starts = edges[:-1] - edges[0]
    middle = np.add.reduceat(frequency[inside], starts) / sizes
    curves = {}
    for place, values in spectra.items():
        mean = np.add.reduceat(values["mean"][inside], starts) / sizes
        low = np.minimum.reduceat(values["min"][inside], starts)
        high = np.maximum.reduceat(values["max"][inside], starts)
        look: dict[str, Any] = {"label": "mean", "colour": BLUE, "width": 1.4}
        curves[place] = Series("spectrum", middle, mean, {}, low, high, True, **look)
    axis = Axis("frequency_Hz", False, float(middle[0]), float(middle[-1]))
    levels = _levels(curves)
    return PagePlot(
        "spectrum",
        f"Spectrum of the displacement at {sensor}",
        (
            f"Power spectral density at the chosen gap and load: mean over {over}"
            " (line), smallest and largest segment (band). Move the slider to see the peaks move"
            " and widen as the contact sets in; the axis follows the level and keeps its decades."
        ),
        {place: Panel(axis, levels[place], [curve]) for place, curve in curves.items()},
        ("gap", "load"),
        empty="No spectrum of this load was read: the slider shows a selection of the loads.",
        wide=True,
        height=420,
    )


def _levels(curves: dict[Place, Series]) -> dict[Place, Axis]:
    """Return {place: vertical axis}, each of the same number of decades below its largest value."""
    ends = {}
    for key, curve in curves.items():
        mean = np.asarray(curve.y)
        if np.any(mean > 0.0):
            low, high = 0.1 * mean[mean > 0.0].min(), 2.0 * np.array(curve.high, dtype=float).max()
            ends[key] = high / low, high
    decades = min(max((ratio for ratio, _ in ends.values()), default=1.0), 10.0**MOST_DECADES)
    return {
        key: Axis(COLUMN, True, ends[key][1] / decades, ends[key][1])
        if key in ends
        else Axis(COLUMN)
        for key in curves
    }


def shapes_of(
    paths: Sequence[str | Path], read: Callable, places: Sequence[Place]
) -> dict[Place, np.ndarray]:
    """Return {(gap, load): complex deflection shape (line_point,)} of the first seed that has one.

    The largest component has length one.

    paths: files of estimates named after their cases; read: function as records.read_record.
    """
    found: dict[Place, np.ndarray] = {}
    for place, path in paths_at(paths, places):
        if place in found:
            continue
        dataset = read(path)
        if "ods_re" in dataset:  # no main peak, no shape
            shape = complex_values(dataset, "ods")
            found[place] = shape / np.abs(shape).max()
    return found


def shape_plot(model: Any, shapes: dict[Place, np.ndarray], direction: str) -> PagePlot:
    """Return the plot of the deflection shape by gap and load.

    shapes: of shapes_of.
    direction: of the displacement, such as y.
    """
    along = model.line_arc_length
    behind = [*supports(model), *linear_limits(model, colour=GREY)]
    step = along[1] - along[0]  # the ends of the tube are no line points
    axes = (
        Axis("arc_length_m", False, along[0] - step, along[-1] + step),
        Axis("shape", False, -1.15, 1.15, f"Shape, {direction} (largest = 1)"),
    )
    frames: dict[tuple, Panel] = {}
    look: dict[str, Any] = {"colour": BLUE, "marker": "o", "size": 2.5, "width": 2.0}
    look |= {"label": "with contact", "band": True}
    for place, shape in shapes.items():
        size = np.abs(shape)  # its envelope
        motion: dict[str, Any] = {"low": -size, "high": size, "moving": shape.imag}
        item = Series("with contact", along, shape.real, **motion, **look)
        frames[place] = Panel(*axes, [*behind, item])
    return PagePlot(
        "shape",
        "Deflection shape along the tube",
        (
            "Shape of the motion around the main peak (largest = 1): its value over one cycle"
            " (blue, Play moves it), its envelope (pale), and the first mode of the linear tube"
            " (grey). Vertical lines are the supports; a shape that moves as one has no part left"
            " where it passes through zero."
        ),
        frames,
        ("gap", "load"),
        empty="No shape of this load: no main peak was found, or the load is not in the selection.",
        height=400,
    )
