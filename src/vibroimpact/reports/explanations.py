"""The explanations of a verdict with their probabilities, as page and figure show them."""

from dataclasses import dataclass

from vibroimpact.diagnosis.verdict.content import Verdict
from vibroimpact.effects.registry import effects_in_words

NOTHING = "nothing is missing"
LEAST_SHOWN = 0.005
SURE = 0.5  # above it an explanation speaks against a verdict that does not name it


@dataclass(frozen=True)
class Explanation:
    """An explanation in words with its probability.

    told: whether the verdict names it. open: nothing, or something else.
    """

    words: str
    probability: float
    told: bool = False
    open: bool = False


def not_explained(verdict: Verdict) -> str:
    """Return the name of an unexplained rest, in words after "something"."""
    return f"that {'could not be run, or ' if verdict.not_run else ''}is not in the catalogue"


def explanations_of(verdict: Verdict) -> list[Explanation]:
    """Return the Explanations worth a row, at all places together, the most probable first.

    Empty if no probabilities are known, or if they speak against the verdict: an effect of
    100 % has no place under a verdict that names none.
    """
    known: dict[tuple[str, ...], float] = {}
    for row in verdict.ranking:
        if row.probability is not None:
            ids = tuple(sorted(row.ids))
            known[ids] = known.get(ids, 0.0) + row.probability
    sets = zip(verdict.ambiguity_set, verdict.ambiguity_probability, strict=False)
    known |= {tuple(sorted(ids)): chance for ids, chance in sets}
    told = {tuple(sorted(ids)) for ids in verdict.ambiguity_set}
    rows = [
        Explanation(effects_in_words(ids), chance, ids in told)
        for ids, chance in known.items()
        if chance >= LEAST_SHOWN
    ]
    for words, chance in (
        (NOTHING, verdict.probability_none),
        (f"something {not_explained(verdict)}", verdict.probability_something_else),
    ):
        if chance is not None:
            rows.append(Explanation(words, chance, open=True))
    rows.sort(key=lambda row: -row.probability)
    return rows if _agree(verdict, rows) else []


def _agree(verdict: Verdict, rows: list[Explanation]) -> bool:
    """Return whether rows, the most probable first, do not speak against the verdict."""
    if not rows or rows[0].probability < SURE:
        return True
    first, rest = rows[0], f"something {not_explained(verdict)}"
    if verdict.verdict in ("named", "ambiguous"):
        return first.told
    if verdict.verdict == "partly_explained":
        return first.told or first.words == rest
    return first.words == (NOTHING if verdict.verdict == "none" else rest)


def chance_text(value: float | None) -> str:
    """Return a probability in per cent: no small one is called 0, no large one 100; - for none."""
    if value is None:
        return "-"
    if value < 0.01:
        return "below 1 %"
    return "over 99 %" if value > 0.99 else f"{100.0 * value:.0f} %"
