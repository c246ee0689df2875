"""The plots of a study's page, by section, and the controls that they follow."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from plotly.offline import get_plotlyjs

from vibroimpact.identify.spectra.welch import driven_axis
from vibroimpact.reports.centred_wear import centred_in
from vibroimpact.reports.equivalent_answer import ALL_SUPPORTS, places_of, with_places
from vibroimpact.reports.evenly_spread import spread_evenly
from vibroimpact.reports.figures.study.linear_limits import contact_stiffness, shown_band
from vibroimpact.reports.figures.study.psd_table import driven_sensor
from vibroimpact.reports.study_content import StudyContent
from vibroimpact.reports.study_page import PagePlots
from vibroimpact.reports.study_words import load_label

from .equivalent import equivalent_plots, load_axis
from .page_plot import Control, PagePlot, frame_places, shown_sections
from .shape import contact_along_plot, shape_plot, shapes_of
from .spectrum import band_of, spectra_of_sensor, spectra_of_series, spectrum_plot
from .statistics import contact_plots, energy_plots, stress_plots

MOST_FRAMES = 144  # spectra on the page, gaps times loads: 20 kB each


class StudyFiles(NamedTuple):
    """The data of the plots; spectra and curves are empty without an identification.

    model: ModalModel.
    series: paths of the time series, which are used if there are no spectra.
    spectra, curves: paths of the spectra and of the estimates, named after their cases.
    summary: rows of consistency_summary.csv.
    read: function (path, names) as records.read_record.
    """

    model: Any
    series: Sequence[str]
    spectra: Sequence[str]
    curves: Sequence[str]
    summary: Sequence[dict]
    read: Callable


def direction_of(config: Any) -> str:
    """Return the axis that the drive acts along; y for none, which names no result."""
    excitation = config.excitation
    return driven_axis(excitation.direction) if "direction" in excitation else "y"


def shown_loads(gaps: Sequence[float], loads: Sequence[float]) -> list[float]:
    """Return the loads of the slider: all of them, or a selection if there are many."""
    return spread_evenly(loads, max(2, MOST_FRAMES // max(len(gaps), 1)))


def study_plots(content: StudyContent, files: StudyFiles) -> PagePlots:
    """Return the plots of the page, its controls, and the source of plotly.js."""
    config, statistics = content.config, content.statistics
    gaps, loads = statistics.gaps, shown_loads(statistics.gaps, statistics.loads)
    title = load_label(config)
    axis = load_axis(title, statistics.loads)
    frames = frame_places(gaps, loads)
    contact = contact_plots(statistics, axis, centred_in(config))
    respond = _response_plots if files.spectra else _response_of_series
    response = respond(content, files, frames)
    if contact:
        beside_shape = any(plot.name == "shape" for plot in response)
        along = contact_along_plot(statistics, frames, files.model)
        (response if beside_shape else contact).append(along)
    sections = {
        "answer": _answer_plots(content, files, title),
        "response": response,
        "contact": contact,
        "stress": stress_plots(statistics, axis, frames, config.record.stress_limit_Pa),
        "energy": energy_plots(statistics, axis, content.limits),
    }
    return PagePlots(shown_sections(sections), _controls(content, gaps, loads), get_plotlyjs())


def _controls(content: StudyContent, gaps: Sequence[float], loads: Sequence[float]):
    _, pairs = places_of(content.answers)
    places = [
        f"{'all supports' if group == ALL_SUPPORTS else group}, {direction}"
        for group, direction in pairs
    ]
    return [
        Control("gap", "Gap", [f"{1e3 * gap:.3g} mm" for gap in gaps]),
        Control("place", "Supports, direction", places or ["all"]),
        Control("load", "Load", [f"{load:.3g} {content.unit} RMS" for load in loads], loads),
    ]


def _answer_plots(content: StudyContent, files: StudyFiles, title: str) -> list[PagePlot]:
    if not content.answers:
        return []
    summary = with_places(files.summary, direction_of(content.config))
    return equivalent_plots(content.answers, summary, title)


def _response_of_series(content, files, frames):
    places = [place for _, place in frames]
    settings = content.config.spectra
    sensor, frequency, spectra = spectra_of_series(files.series, files.read, settings, places)
    if not spectra:
        return []
    band, over = band_of(frequency, spectra), "segments of the first seed"
    return [spectrum_plot(frequency, spectra, frames, sensor, band, over)]


def _response_plots(content, files, frames):
    config, model = content.config, files.model
    places = [place for _, place in frames]
    sensor = driven_sensor(config, config.identification.response_point)
    frequency, spectra = spectra_of_sensor(files.spectra, files.read, sensor, places)
    plots = []
    if spectra:
        band = shown_band(model, float(frequency[-1]))
        plots.append(spectrum_plot(frequency, spectra, frames, sensor, band))
    shapes = shapes_of(files.curves, files.read, places)
    if shapes:
        direction = config.record.shape_line.direction
        plots.append(shape_plot(model, shapes, frames, contact_stiffness(model), direction))
    return plots
