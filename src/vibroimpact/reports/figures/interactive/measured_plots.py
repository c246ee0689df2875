"""The plots of the page of a measured tube, and the controls that they follow."""

from __future__ import annotations

from typing import Any

from vibroimpact.equivalent_support.measured.equivalent_of import MeasuredSupports
from vibroimpact.reports.equivalent_answer import with_places
from vibroimpact.reports.figures.study.linear_limits import shown_band
from vibroimpact.reports.figures.study.psd_table import driven_sensor
from vibroimpact.reports.measured_content import LEVELS, MeasuredContent
from vibroimpact.reports.study_page import PagePlots

from .equivalent import equivalent_plots, places_of
from .page_plot import Control, plotly_library
from .spectrum import frame_places, spectra_of_sensor, spectrum_plot
from .stabilisation import stabilisation_plot


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
    drawn = {
        name: [each for each in plots if each.has_traces()] for name, plots in sections.items()
    }
    return PagePlots(drawn, controls, plotly_library())


def _summary(found: MeasuredSupports) -> list[dict[str, Any]]:
    """Return the rows of the summary, levels in the unit of the page."""
    factor = LEVELS[found.levels][2]
    rows = with_places(found.summary, found.rows[0]["direction"])
    return [{**row, "load_rms_N": factor * row["load_rms_N"]} for row in rows]


def _spectrum(found, frames):
    files = {f"{case.id}.nc": dataset for case, dataset in found.spectra.items()}
    sensor = driven_sensor(found.config, found.config.identification.response_point)
    places = [place for _, place in frames]
    frequency, spectra = spectra_of_sensor(
        list(files), lambda path, names: files[path], sensor, places
    )
    band = shown_band(found.model, float(frequency[-1]))
    over = "segments and records"
    return spectrum_plot(frequency, spectra, frames, sensor, band, over)


def _stabilisation(found, frames):
    identification = found.config.identification
    return stabilisation_plot(
        found.curves,
        found.spectra,
        frames,
        driven_sensor(found.config, identification.response_point),
        identification.lscf.band_Hz,
    )
