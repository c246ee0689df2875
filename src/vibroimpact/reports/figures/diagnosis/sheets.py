"""All figures of a diagnosis, and that of the probabilities of its explanations."""

from functools import partial

import xarray as xr

from vibroimpact.config.schema import Config
from vibroimpact.diagnosis.verdict.content import Verdict, not_run_sentence
from vibroimpact.reports.figures.plot import Axis, Bars, Panel, Plot
from vibroimpact.reports.figures.sheet import WIDTH_IN, Sheet
from vibroimpact.reports.figures.style import BLUE, GREY, ORANGE
from vibroimpact.reports.verdict_words import chance_text, explanations_of, not_explained

from .free_sensor import free_sensor_figure
from .holding import holding_figure
from .law import law_figure
from .place import place_figure
from .psd import psd_figure
from .states import empty_plot

REFUSED = "the campaign was refused"
NO_PLACE = "the structure has no support and no local element"
NO_SENSOR = "No sensor is left free"
ALONE = "fewer than two sensors measure a motion, and nothing would be held"
MOST_BARS = 14
NONE_KNOWN = "no probabilities are known that the verdict stands by"
CAPTION = (
    "Probability of each explanation among all that are shown, given the records and the prior"
    " probabilities; the places of one effect together. Orange: the named one, or all that are not"
    " distinguished. Grey: nothing, others, and something {rest}.{left_out}"
)


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


def ranking_figure(verdict: Verdict) -> Plot:
    """Return the Plot of bars of the probabilities, the most probable first."""
    rows = explanations_of(verdict)
    if not rows:
        return empty_plot("diagnosis_ranking", "Probabilities", NONE_KNOWN)
    shown = rows[:MOST_BARS]
    left = sum(row.probability for row in rows[MOST_BARS:])
    words = f" {len(rows) - MOST_BARS} more have {100.0 * left:.2g} % together." if left else ""
    words += not_run_sentence(verdict.not_run)
    first = rows[0]
    values = [row.probability for row in shown]
    names = [row.words for row in shown]
    bars = Bars(
        "probability",
        range(len(shown)),
        values,
        {"explanation": names},
        texts=[*map(chance_text, values)],
        colours=[ORANGE if row.told else GREY if row.open else BLUE for row in shown],
    )
    axes = Axis("probability", False, 0.0, 1.12), Axis("explanation", names=names)
    return Plot(
        "diagnosis_ranking",
        f"Most probable: {first.words}, {chance_text(first.probability)}",
        CAPTION.format(rest=not_explained(verdict), left_out=words),
        {"main": Panel(*axes, [bars])},
        size=(WIDTH_IN, 1.2 + 0.3 * max(len(shown), 3)),
    )
