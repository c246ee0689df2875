"""The stabilisation chart of LSCF at any load: poles by model order over the spectrum."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.figures.style import BLUE, GREEN, GREY, ORANGE, RED
from vibroimpact.study.cases import Case

from .plot import Plot, axis, label, layout, numbers

Place = tuple[float, float]  # gap in m, load
KINDS = {
    # name: (colour, symbol)
    "new": (ORANGE, "x"),
    "stable in frequency": (BLUE, "circle-open"),
    "stable in frequency, damping and participation": (GREEN, "circle"),
}


def stabilisation_plot(
    curves: Mapping[Case, xr.Dataset],
    spectra: Mapping[Case, xr.Dataset],
    poles_Hz: Mapping[Case, float],
    places: Sequence[tuple[str, Place]],
    sensor: str,
    band_Hz: tuple[float, float],
) -> Plot:
    """Return the Plot of the charts by gap and load, of the first seed of each.

    curves, spectra: of identify.identify_case and study.case_spectra.
    poles_Hz: frequency of the pole that was taken, NaN for none.
    places: (key of the frame, (gap, load)).
    sensor: whose PSD is drawn behind the poles.
    """
    first = {(case.gap_m, case.load_rms_N): case for case in sorted(curves, reverse=True)}
    frames = {}
    for key, place in places:
        case = first.get(place)
        if case is not None and "chart_order" in curves[case]:
            behind = _spectrum(spectra[case], sensor, band_Hz)
            frames[key] = [behind, *_poles(curves[case], band_Hz, poles_Hz[case])]
    return Plot(
        "stabilisation",
        "Stabilisation chart of the LSCF pole",
        (
            f"Poles by model order over the spectrum of {sensor} (grey, right), first record of the"
            " level. The circle is the pole that was taken. Trust it where a column of stable poles"
            " stands at the peak."
        ),
        _layout(band_Hz),
        frames,
        ("gap", "load"),
        empty="No pole was found at the main peak.",
        wide=True,
    )


def _layout(band_Hz: tuple[float, float]) -> dict[str, Any]:
    """Return the layout: model order on the left, the spectrum on the right."""
    return layout(
        axis("Frequency (Hz)", range=list(band_Hz)),
        axis(label("model_order")),
        height=420,
        margin={"l": 60, "r": 70, "t": 32, "b": 50},
        yaxis2={
            "overlaying": "y",
            "side": "right",
            "type": "log",
            "showgrid": False,
            "dtick": 2,
            "exponentformat": "power",
            "title": {"text": label("psd_m2_per_Hz")},
        },
    )


def _spectrum(spectrum: xr.Dataset, sensor: str, band_Hz: tuple[float, float]) -> dict[str, Any]:
    frequency = spectrum["frequency"].values
    inside = (frequency >= band_Hz[0]) & (frequency <= band_Hz[1])
    return {
        "type": "scatter",
        "mode": "lines",
        "name": "spectrum",
        "x": numbers(frequency[inside]),
        "y": numbers(spectrum["psd_displacement_mean"].sel(sensor=sensor).values[inside]),
        "yaxis": "y2",
        "line": {"color": GREY, "width": 0.9},
        "hoverinfo": "skip",
    }


def _poles(
    fitted: xr.Dataset, band_Hz: tuple[float, float], taken_Hz: float
) -> list[dict[str, Any]]:
    """Return the traces of the poles by how stable they are, and the one that was taken."""
    place, ratio = fitted["chart_frequency"].values, fitted["chart_damping_ratio"].values
    order = fitted["chart_order"].values.astype(float)
    flags = [
        fitted[f"chart_stable_{name}"].values.astype(bool)
        for name in ("frequency", "damping", "participation")
    ]
    stable = flags[0] & flags[1] & flags[2]
    inside = (ratio > 0.0) & (place >= band_Hz[0]) & (place <= band_Hz[1])
    chosen = dict(zip(KINDS, (~flags[0], flags[0] & ~stable, stable), strict=True))
    traces = [
        _markers(name, place, order, ratio, inside & chosen[name], colour, symbol, 6)
        for name, (colour, symbol) in KINDS.items()
    ]
    here = np.flatnonzero(inside & (order == fitted["chart_orders_taken"].values[0]))
    if here.size and np.isfinite(taken_Hz):
        nearest = np.zeros(order.size, bool)
        nearest[here[np.argmin(np.abs(place[here] - taken_Hz))]] = True
        traces.append(_markers("taken", place, order, ratio, nearest, RED, "circle-open", 14))
    return traces


def _markers(name, place, order, ratio, chosen, colour, symbol, size) -> dict[str, Any]:
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": numbers(place[chosen]),
        "y": numbers(order[chosen]),
        "customdata": numbers(100.0 * ratio[chosen]),
        "marker": {"color": colour, "symbol": symbol, "size": size},
        "hovertemplate": "%{x:.2f} Hz, damping ratio %{customdata:.2f} %, order %{y}"
        f"<extra>{name}</extra>",
    }
