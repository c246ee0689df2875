"""The stabilisation chart of LSCF at any load: poles by model order over the spectrum."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import xarray as xr

from vibroimpact.reports.figures.study.stabilisation import chart_panel
from vibroimpact.study.cases import Case

from .page_plot import PagePlot

Place = tuple[float, float]  # gap in m, load


def stabilisation_plot(
    curves: Mapping[Case, xr.Dataset],
    spectra: Mapping[Case, xr.Dataset],
    places: Sequence[tuple[str, Place]],
    sensor: str,
    band_Hz: tuple[float, float],
) -> PagePlot:
    """Return the plot of the charts by gap and load, of the first seed of each.

    curves, spectra: of identify.identify_case and study.case_spectra.
    places: (key of the frame, (gap, load)).
    sensor: whose PSD is drawn behind the poles.
    """
    first = {(case.gap_m, case.load_rms_N): case for case in sorted(curves, reverse=True)}
    return PagePlot(
        "stabilisation",
        "Stabilisation chart of the LSCF pole",
        (
            f"Poles by model order over the spectrum of {sensor} (grey, right), first record of the"
            " level. The circles are the pole that was taken. Trust it if a column of stable"
            " poles stands at the peak."
        ),
        {
            key: chart_panel(curves[first[place]], spectra[first[place]], sensor, band_Hz)
            for key, place in places
            if place in first and "chart_order" in curves[first[place]]
        },
        ("gap", "load"),
        empty="No pole was found at the main peak.",
        wide=True,
        height=420,
    )
