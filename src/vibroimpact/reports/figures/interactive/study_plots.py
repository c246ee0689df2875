"""The plots of the page of a study, or of a measured tube, by section, and the controls that they
follow.
"""

from collections.abc import Callable, Sequence
from itertools import product
from typing import Any, NamedTuple

from plotly.offline import get_plotlyjs

from vibroimpact.reports.equivalent_answer import ALL_SUPPORTS, places_of
from vibroimpact.reports.figures.plot import Axis, extent
from vibroimpact.reports.figures.study.linear_limits import shown_band
from vibroimpact.reports.figures.study.poles import chart_panel
from vibroimpact.reports.figures.study.psd_table import driven_sensor
from vibroimpact.reports.study_content import StudyContent
from vibroimpact.reports.study_page import PagePlots
from vibroimpact.reports.table import spread_evenly
from vibroimpact.reports.wear_life import centred_in

from .equivalent import equivalent_plots
from .page_plot import Control, PagePlot
from .response import (
    band_of,
    shape_plot,
    shapes_of,
    spectra_of_sensor,
    spectra_of_series,
    spectrum_plot,
)
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


def shown_loads(gaps: Sequence[float], loads: Sequence[float]) -> list[float]:
    """Return the loads of the slider: all of them, or a selection if there are many."""
    return spread_evenly(loads, max(2, MOST_FRAMES // max(len(gaps), 1)))


def study_plots(content: StudyContent, files: StudyFiles) -> PagePlots:
    """Return the plots of the page, its controls, and the source of plotly.js."""
    config, statistics, gaps = content.config, content.statistics, content.statistics.gaps
    slider, factor = shown_loads(gaps, statistics.loads), content.load_factor
    ends = extent([factor * load for load in statistics.loads], log=True)
    loads = Axis("load_rms_N", True, *ends, label=content.load_label)
    answers = content.answers
    sections = {
        "answer": equivalent_plots(answers, files.summary, loads) if answers else [],
        "response": _response_plots(content, files, [*product(gaps, slider)]),
        "contact": contact_plots(statistics, loads, centred_in(config)),
        "stress": stress_plots(statistics, loads, slider, config.record.stress_limit_Pa),
        "energy": energy_plots(statistics, loads, content.limits),
    }
    _, pairs = places_of(answers)
    places = [
        f"{'all supports' if group == ALL_SUPPORTS else group}, {direction}"
        for group, direction in pairs
    ]
    shown = [factor * load for load in slider]
    texts = [f"{load:.3g} {content.unit} RMS" for load in shown]
    controls = [
        Control("gap", "Gap", [f"{1e3 * gap:.3g} mm" for gap in gaps], gaps),
        Control("place", "Supports, direction", places or ["all"], pairs),
        Control("load", content.load_words[0], texts, slider, shown),
    ]
    drawn = {
        name: [plot for plot in plots if plot.has_traces()] for name, plots in sections.items()
    }
    return PagePlots(drawn, controls, get_plotlyjs())


def _response_plots(content, files, places):
    """Return the plots of spectrum and shape; those of time series where there are no spectra."""
    config, model = content.config, files.model
    if not files.spectra:
        settings, over = config.spectra, "segments of the first seed"
        sensor, frequency, spectra = spectra_of_series(files.series, files.read, settings, places)
        band = band_of(frequency, spectra) if spectra else ()
    else:
        sensor = driven_sensor(config, config.identification.response_point)
        frequency, spectra = spectra_of_sensor(files.spectra, files.read, sensor, places)
        band, over = shown_band(model, float(frequency[-1])), f"segments and {content.scatter}"
    shapes = shapes_of(files.curves, files.read, places)
    plots = [spectrum_plot(frequency, spectra, sensor, band, over)] if spectra else []
    if shapes:
        plots.append(shape_plot(model, shapes, config.record.shape_line.direction))
    return plots


def measured_plots(content: StudyContent, found: Any) -> PagePlots:
    """Return the PagePlots of MeasuredSupports: those of a study, and stabilisation charts."""
    files = {f"{case.id}.nc": dataset for case, dataset in found.spectra.items()}
    factor = content.load_factor
    summary = [{**row, "load_rms_N": factor * row["load_rms_N"]} for row in found.summary]
    given = StudyFiles(found.model, [], [*files], [], summary, lambda path, _=(): files[path])
    plots = study_plots(content, given)
    chart = _stabilisation(found)
    answer = [*plots.sections["answer"], *([chart] if chart.has_traces() else [])]
    return plots._replace(sections={**plots.sections, "answer": answer})


def _stabilisation(found: Any) -> PagePlot:
    """Return the plot of the charts by gap and load, of the first record of each."""
    identification = found.config.identification
    sensor = driven_sensor(found.config, identification.response_point)
    first = {(case.gap_m, case.load_rms_N): case for case in sorted(found.curves, reverse=True)}
    return PagePlot(
        "stabilisation",
        "Stabilisation chart of the LSCF pole",
        (
            f"Poles by model order over the spectrum of {sensor} (grey, right), first record of the"
            " level. The circles are the pole that was taken. Trust it if a column of stable"
            " poles stands at the peak."
        ),
        {
            place: chart_panel(
                found.curves[case], found.spectra[case], sensor, identification.lscf.band_Hz
            )
            for place, case in first.items()
            if "chart_order" in found.curves[case]
        },
        ("gap", "load"),
        empty="No pole was found at the main peak.",
        wide=True,
        height=420,
    )
