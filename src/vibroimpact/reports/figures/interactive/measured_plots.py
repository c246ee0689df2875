"""The plots of the page of a measured tube: those of a study, and its stabilisation charts."""

from vibroimpact.equivalent_support.measured.equivalent_of import MeasuredSupports
from vibroimpact.reports.figures.study.psd_table import driven_sensor
from vibroimpact.reports.figures.study.stabilisation import chart_panel
from vibroimpact.reports.study_content import StudyContent
from vibroimpact.reports.study_page import PagePlots

from .page_plot import PagePlot
from .study_plots import StudyFiles, study_plots


def measured_plots(content: StudyContent, found: MeasuredSupports) -> PagePlots:
    """Return the plots of the page, its controls, and the source of plotly.js."""
    files = {f"{case.id}.nc": dataset for case, dataset in found.spectra.items()}
    factor = content.load_factor
    summary = [{**row, "load_rms_N": factor * row["load_rms_N"]} for row in found.summary]
    given = StudyFiles(found.model, [], [*files], [], summary, lambda path, _=(): files[path])
    plots = study_plots(content, given)
    chart = _stabilisation(found)
    answer = [*plots.sections["answer"], *([chart] if chart.has_traces() else [])]
    return plots._replace(sections={**plots.sections, "answer": answer})


def _stabilisation(found: MeasuredSupports) -> PagePlot:
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
