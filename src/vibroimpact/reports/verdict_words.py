"""The words of a verdict: its explanations with their probabilities, its sentence, why candidates
were ruled out, and the next steps.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from vibroimpact.diagnosis.verdict.content import Estimate, Verdict, not_run_sentence
from vibroimpact.effects.places import at_place
from vibroimpact.effects.registry import effects_in_words
from vibroimpact.io.display_units import display_unit

from .number_text import digits, percent

NOTHING = "nothing is missing"
OTHERS = "others of the catalogue, not found"
LEAST_SHOWN = 0.005
SURE = 0.5  # above it an explanation speaks against a verdict that does not name it


@dataclass(frozen=True)
class Explanation:
    """An explanation in words with its probability.

    told: whether the verdict names it. open: nothing, something else, or others.
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
    left = 1.0 - sum(known.values()) - sum(row.probability for row in rows if row.open)
    if known and left >= LEAST_SHOWN and verdict.probability_none is not None:
        rows.append(Explanation(OTHERS, left, open=True))
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


def verdict_sentence(verdict: Verdict) -> str:
    """Return the verdict in one or two sentences."""
    shrinks = _shrinks(verdict, "it")
    named = "; and ".join(map(_with_parameters, verdict.effects))
    own = _ids(verdict.effects)
    wanted = NOTHING if verdict.verdict == "none" else effects_in_words(own)
    known = [row.probability for row in explanations_of(verdict) if row.words == wanted]
    sure = f" The probability of this is {chance_text(known[0])}." if known else ""
    alternatives = [ids for ids in verdict.ambiguity_set if sorted(ids) != own]
    others = (
        f" This campaign can not distinguish it from {sets_in_words(alternatives)}."
        if named and alternatives
        else ""
    )
    near = [] if verdict.withdrawn else [effect.id for effect in verdict.most_probable]
    nearest = f" The best candidate, {effects_in_words(near)}, does not explain it." if near else ""
    refusals = " ".join(row.message for row in verdict.checks if row.level == "refuse")
    sentences = {
        "none": _nothing_missing(verdict) + sure,
        "named": f"The model lacks {named}.{sure}{shrinks}{others}",
        "partly_explained": (
            f"The model lacks {named}, and something else {not_explained(verdict)}: the"
            f" remaining difference is significant.{shrinks}{others}"
        ),
        "ambiguous": (
            "One of these is missing, and this campaign can not decide which:"
            f" {sets_in_words(verdict.ambiguity_set)}."
            + _shrinks(verdict, "the most probable of them")
        ),
        "unknown": (
            f"The model and the measurement disagree, and no effect {_tried(verdict)} explains it:"
            f" the figures show the largest differences.{nearest}"
        ),
        "not_testable": f"The campaign can not be judged. {refusals}".strip(),
    }
    return sentences[verdict.verdict] + not_run_sentence(verdict.not_run)


def _shrinks(verdict, added):
    """Return by how much the spectra of free runs come nearer with an addition, "" if unknown."""
    apart = verdict.misfit.holdout
    if apart is None or (closed := apart.closed_fraction) is None:
        return ""
    if closed <= 0.0:
        return f" Spectra of free runs on records that took no part are no nearer with {added}."
    share = percent(closed)
    return f" Adding {added} closes {share} of the excess misfit on records that took no part."


def _tried(verdict):
    """Return which effects were tried."""
    return "that could be run" if verdict.not_run else "of the catalogue"


def _nothing_missing(verdict):
    """Return the sentence of the verdict `none`."""
    return (
        f"No effect is {'found' if verdict.not_run else 'missing'}: none {_tried(verdict)}"
        " brings the model nearer to records that took no part than small errors of a right model"
        " do."
    )


def sets_in_words(sets: Sequence[Sequence[str]]) -> str:
    """Return the members of an ambiguity set: dry friction, or lobed hole."""
    return ", or ".join(effects_in_words(ids) for ids in sets)


def _with_parameters(effect):
    """Return an effect in words with its parameters.

    Example: dry friction at both plates (mu 0.149, between 0.128 and 0.171).
    """
    values = ", ".join(
        f"{name.replace('_', ' ')} {digits(value['value'])}{unit_text(value['unit'])}, between"
        f" {digits(value['low'])} and {digits(value['high'])}"
        for name, value in ((name, for_reading(row)) for name, row in effect.parameters.items())
    )
    place, words = at_place(effect.location), effects_in_words([effect.id])
    told = f" ({values})" if values else ""
    if effect.law_fits == "no":
        return (
            f"something of the family “{effect.family or words}”{place}: of its laws"
            f" {words}{told} comes nearest and leaves more than chance does"
        )
    return f"{words}{place}{told}"


def withdrawn_sentence(verdict: Verdict) -> str:
    """Return the effects that were tried and are not offered, empty if there are none."""
    if verdict.withdrawn is None:
        return ""
    misfit, tried = (
        verdict.withdrawn.misfit,
        effects_in_words([e.id for e in verdict.withdrawn.effects]),
    )
    numbers = [
        f"{name}, {digits(split.before_dB)} dB before, {digits(split.after_dB)} dB after"
        for name, split in (
            ("those that it was fitted to", misfit.fit),
            ("those that took no part", misfit.holdout),
        )
        if split is not None and split.before_dB is not None
    ]
    told = ": " + "; ".join(numbers) if numbers else ""
    return f"Tried and not offered: {tried}. It does not bring all records nearer{told}."


def judgement(verdict: Verdict, row: dict, first: bool) -> str:
    """Return why a candidate was taken or ruled out, in words.

    row: of verdict.ranking in plain values; first: whether it is the first of these effects.
    """
    ids, shown = sorted(row["ids"]), _ids(verdict.shown_effects())
    if verdict.withdrawn and ids == _ids(verdict.withdrawn.effects) != []:
        return "makes records worse, or hardly better"
    if ids == shown and first:
        return "the most probable" if verdict.verdict == "ambiguous" else "named"
    if ids == shown:
        return "the same at another place, which explains less"
    if ids in [sorted(row) for row in verdict.ambiguity_set]:
        return "not distinguished from it"
    if shown:
        return "less probable, by the records that were fitted"
    if (row["heldout_score"] or 0.0) <= 0.0:
        return "gains nothing on records that it was not fitted to"
    if verdict.verdict == "none":
        return "gains no more than small errors of a right model do"
    return "leaves a difference beyond chance"


def _ids(effects: Iterable) -> list[str]:
    return sorted(effect.id for effect in effects)


def next_steps(verdict: Verdict, model: str) -> list[dict]:
    """Return [{words, command}] of the next steps; command: None if there is none.

    model: path of the completed model.
    """
    if verdict.verdict == "not_testable":
        return [
            _step("Correct the faults that the checks refuse, then give the same command again.")
        ]
    if verdict.verdict == "none":
        known = " by the effects that could be run" if verdict.not_run else ""
        return [_step(f"Nothing: the model stands as it is for records like these{known}.")]
    if not verdict.shown_effects():
        return [
            _step(
                "No completed model is offered. Look at the places of the largest"
                " differences: at the supports, lengths and sensors there."
            ),
            _step("Try a model from the records alone:", "discrepancy", "FILE model=identified"),
        ]
    which = " most probable" if verdict.verdict == "ambiguous" else ""
    steps = [
        _step(f"Run the study with the{which} completed model:", configfile=model),
        _step(
            "Diagnose the completed model, by this campaign or by another one:",
            "discrepancy",
            f"FILE model={model}",
        ),
    ]
    if verdict.verdict == "partly_explained":
        steps.insert(0, _step("Look at the differences that remain, by sensor and band."))
    return steps


def _step(words, target="", campaign="", configfile=""):
    parts = ["snakemake -j2", target]
    parts += [f"--config campaign={campaign}"] if campaign else []
    parts += [f"--configfile {configfile}"] if configfile else []
    command = " ".join(filter(None, parts)) if campaign or configfile else None
    return {"words": words, "command": command}


def unit_text(unit: str | None) -> str:
    """Return a unit after a space, nothing if there is none."""
    return "" if unit in ("1", "", "-", None) else f" {unit}"


def for_reading(row: Estimate) -> dict[str, Any]:
    """Return {value, low, high, unit} of an Estimate in the unit that it is shown in."""
    values = {"value": row.value, "low": row.low, "high": row.high}
    unit, factor = display_unit(row.unit, values.values())
    return {
        "unit": unit,
        **{key: None if value is None else factor * value for key, value in values.items()},
    }
