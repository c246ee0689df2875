"""The probabilities of the explanations."""

from vibroimpact.diagnosis.verdict.content import Verdict, not_run_sentence
from vibroimpact.reports.explanations import chance_text, explanations_of, not_explained
from vibroimpact.reports.figures.plot import Axis, Bars, Panel, Plot
from vibroimpact.reports.figures.sheet import WIDTH_IN
from vibroimpact.reports.figures.style import BLUE, GREY, ORANGE

from .states import empty_plot

MOST_BARS = 14
NONE_KNOWN = "no probabilities are known that the verdict stands by"

CAPTION = (
    "Probability of each explanation among all that are shown, given the records and the prior"
    " probabilities; the places of one effect together. Orange: the named one, or all that are not"
    " distinguished. Grey: nothing is missing, and something {rest}.{left_out}"
)


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
