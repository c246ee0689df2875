"""The plots of the page of a measured tube, and the controls that they follow."""

from __future__ import annotations

from typing import Any

from plotly.offline import get_plotlyjs

from vibroimpact.equivalent_support.measured.equivalent_of import MeasuredSupports
from vibroimpact.reports.equivalent_answer import places_of, with_places
from vibroimpact.reports.figures.study.linear_limits import shown_band
from vibroimpact.reports.figures.study.psd_table import driven_sensor
from vibroimpact.reports.figures.study.stabilisation import chart_panel
from vibroimpact.reports.measured_content import LEVELS, MeasuredContent
from vibroimpact.reports.study_page import PagePlots

from .equivalent import equivalent_plots
from .page_plot import Control, Frames, PagePlot, frame_places, shown_sections
from .spectrum import spectra_of_sensor, spectrum_plot


def measured_plots(content: MeasuredContent, found: MeasuredSupports) -> PagePlots:
    """Return the plots of the page, its controls, and the source of plotly.js."""
    gaps, pairs = places_of(content.answers)
    levels = sorted({case.load_rms_N for case in found.spectra})
    frames = frame_places(gaps, levels)
    sections = {
        "answer": [
            *equivalent_plots(content.answers, _summary(found), content.level_label),
            _stabilisation(found, frames),
        ],
        "response": [_spectrum(found, frames)],
        **{name: [] for name in ("contact", "stress", "energy")},
    }
    factor = LEVELS[found.levels][2]
    shown = [factor * level for level in levels]
    controls = [
        Control("gap", "Gap", [f"{1e3 * gap:.3g} mm" for gap in gaps]),
        Control("place", "Supports, direction", [", ".join(pair) for pair in pairs]),
        Control("load", "Level", [f"{level:.3g} {content.unit} RMS" for level in shown], shown),
    ]
    return PagePlots(shown_sections(sections), controls, get_plotlyjs())


def _summary(found: MeasuredSupports) -> list[dict[str, Any]]:
    """Return the rows of the summary, levels in the unit of the page."""
    factor = LEVELS[found.levels][2]
    rows = with_places(found.summary, found.rows[0]["direction"])
    return [{**row, "load_rms_N": factor * row["load_rms_N"]} for row in rows]


def _spectrum(found: MeasuredSupports, frames: Frames) -> PagePlot:
    """Return the plot of the spectrum at the response point."""
    files = {f"{case.id}.nc": dataset for case, dataset in found.spectra.items()}
    sensor = driven_sensor(found.config, found.config.identification.response_point)
    places = [place for _, place in frames]
    frequency, spectra = spectra_of_sensor(list(files), lambda path, _: files[path], sensor, places)
    band = shown_band(found.model, float(frequency[-1]))
    return spectrum_plot(frequency, spectra, frames, sensor, band, "segments and records")


def _stabilisation(found: MeasuredSupports, frames: Frames) -> PagePlot:
    """Return the plot of the charts by gap and load, of the first record of each."""
    identification = found.config.identification
    sensor = driven_sensor(found.config, identification.response_point)
    first = {(case.gap_m, case.load_rms_N): case for case in sorted(found.curves, reverse=True)}
    charts = {
        key: (found.curves[first[place]], found.spectra[first[place]])
        for key, place in frames
        if place in first and "chart_order" in found.curves[first[place]]
    }
    return PagePlot(
        "stabilisation",
        "Stabilisation chart of the LSCF pole",
        (
            f"Poles by model order over the spectrum of {sensor} (grey, right), first record of the"
            " level. The circles are the pole that was taken. Trust it if a column of stable"
            " poles stands at the peak."
        ),
        {
            key: chart_panel(*files, sensor, identification.lscf.band_Hz)
            for key, files in charts.items()
        },
        ("gap", "load"),
        empty="No pole was found at the main peak.",
        wide=True,
        height=420,
    )
