"""All figures of a diagnosis."""

from functools import partial

import xarray as xr

from vibroimpact.config.schema import Config
from vibroimpact.diagnosis.verdict.content import Verdict
from vibroimpact.reports.figures.plot import Plot
from vibroimpact.reports.figures.sheet import Sheet

from .free_sensor import free_sensor_figure
from .holding import holding_figure
from .law import law_figure
from .place import place_figure
from .psd import psd_figure
from .ranking import ranking_figure
from .states import empty_plot

REFUSED = "the campaign was refused"
NO_PLACE = "the structure has no support and no local element"
NO_SENSOR = "No sensor is left free"
ALONE = "fewer than two sensors measure a motion, and nothing would be held"


def diagnosis_figures(
    evidence: xr.Dataset, psd: xr.Dataset, verdict: Verdict, config: Config | None = None
) -> list[Plot | Sheet]:
    """Return the Plots of a diagnosis, in the order of its page: as many for every verdict.

    evidence: of diagnosis.evidence.evidence_of, empty of a campaign that was refused. psd: see
    psd.psd_figure, empty alike. config: of the model, whose structure is drawn. A figure whose
    content the campaign can not give says why, and has no table; evidence whose attribute left_out
    says so itself is believed.
    """
    spectra = partial(psd_figure, verdict=verdict)
    return [
        place_figure(config, evidence, verdict.shown_effects()),
        _drawn("holding", holding_figure, evidence, "holding_force", "Holding force", REFUSED),
        _drawn("law", law_figure, evidence, "demanded_force", "The law at the supports", NO_PLACE),
        ranking_figure(verdict),
        _drawn("free_sensor", free_sensor_figure, evidence, "free_error", NO_SENSOR, ALONE),
        _drawn("psd", spectra, psd, "psd", "Spectra of free runs", REFUSED),
    ]


def _drawn(name, figure, data, variable, title, why):
    """Return the Plot of a figure, one that says why there is none if data lack a variable."""
    if variable in data:
        return figure(data)
    why = data.attrs.get("left_out", why) if data else REFUSED
    return empty_plot(f"diagnosis_{name}", title, why)
