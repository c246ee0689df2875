"""The runs and the results of a study, in sentences."""

import math
from collections.abc import Sequence
from typing import Any

from vibroimpact.integration.energy_limit import ENERGY_LIMIT
from vibroimpact.study.method_agreement import AGREEMENT, COMPARED
from vibroimpact.study.reasons import agreement_sentence

from .equivalent_answer import ALL_SUPPORTS, Answer, Value, places_of
from .number_text import digits
from .study_statistics import StudyStatistics

STRUCTURES = {
    "u_tube": "A U-tube",
    "path": "A tube",
    "chain": "A chain of masses and springs",
    "matrices": "A structure given by its matrices",
    "identified": "A structure given by its measured modes",
}
NAMES = {"k": "Stiffness k", "c": "Damping c"}
MOST_PLACES = 4  # curves that have a sentence of their own


def load_unit(config: Any) -> str:
    """Return the unit of the loads: that of a force, or of the acceleration of the base."""
    return "m/s²" if config.excitation.kind == "base_motion" else "N"


def stiffness_unit(values: Sequence[float]) -> tuple[str, float]:
    """Return (unit, units per N/m) that the stiffnesses of a study are shown in."""
    largest = max((value for value in values if math.isfinite(value)), default=0.0)
    return ("N/m", 1.0) if largest <= 2e3 else ("kN/m", 1e-3)


def run_sentence(config: Any, statistics: StudyStatistics) -> str:
    """Return the sentences on the run: structure, supports, force, loads, gaps and seeds."""
    supports = len(config.supports)
    held = f" with {supports} gap support{'s' * (supports != 1)}" if supports else ""
    loads, gaps, seeds = statistics.loads, statistics.gaps, config.grid.seeds
    own = [support.gap_m for support in config.supports]
    kinds = [_count(range(seeds), "seed")]
    if supports and has_own_gaps(config):
        kinds.insert(0, f"gaps of their own ({_range(sorted(1e3 * gap for gap in own))} mm)")
    elif supports:
        *others, last = [digits(1e3 * gap) for gap in gaps]
        listed = f"{', '.join(others)} and {last}" if others else last
        kinds.insert(0, f"{_count(gaps, 'gap')} (radial, {listed} mm)")
    return (
        f"{STRUCTURES.get(config.structure.kind, 'A structure')}{held} under"
        f" {_excitation(config.excitation)}: {_count(loads, 'load')}"
        f" {_range(loads)} {load_unit(config)} RMS, {', '.join(kinds)};"
        f" {_count(range(statistics.cases), 'record')} of {digits(config.record.duration_s)} s."
    )


def _excitation(excitation: Any) -> str:
    kind = excitation.kind
    place = f" at {excitation.point}" if "point" in excitation else ""
    if kind == "band_limited":
        return f"a random force from {_band(excitation.band_Hz)}{place}"
    if kind == "harmonic":
        return f"a sinusoidal force of {digits(excitation.frequency_Hz)} Hz{place}"
    if kind == "base_motion":
        signal = excitation.signal
        what = (
            f"random, from {_band(signal.band_Hz)}"
            if signal.kind == "band_limited"
            else f"sinusoidal, {digits(signal.frequency_Hz)} Hz"
        )
        return f"a motion of its base ({what})"
    words = {"measured": "a measured force", "white_noise": "white noise", "none": "no force"}
    return words.get(kind, kind.replace("_", " ")) + place


def _band(band_Hz: Sequence[float]) -> str:
    return f"{digits(band_Hz[0])} to {digits(band_Hz[1])} Hz"


def _count(values: Sequence, word: str) -> str:
    return f"{len(values)} {word}{'s' * (len(values) != 1)}"


def _range(values: Sequence[float]) -> str:
    low, high = digits(values[0]), digits(values[-1])
    return f"of {low}" if low == high else f"from {low} to {high}"


def headline(config: Any, answers: Sequence[Answer], unit: str) -> list[str]:
    """Return the answer in sentences: how often k and c are resolved, and their course with load.

    config: of the study. unit: of the loads.
    """
    if not answers:
        return []
    places = list(dict.fromkeys(row.place for row in answers))
    several = len({place[1:] for place in places}) > 1
    sentences = [_agreement(answers, quantity, several) for quantity in ("k", "c")]
    each = several or any(row.group != ALL_SUPPORTS for row in answers)
    sentences += _readings(config, answers, each)
    scale = stiffness_unit([row.k.value for row in answers])
    for place in places[:MOST_PLACES]:
        rows = [row for row in answers if row.place == place]
        gap, group, direction = place
        where = f", {group}, direction {direction}".lower() if group != ALL_SUPPORTS else ""
        sentences.append(
            f"Gap {digits(1e3 * gap)} mm{where}: {_course(rows, 'k', scale, unit)};"
            f" {_course(rows, 'c', ('N s/m', 1.0), unit)}."
        )
    if len(places) > MOST_PLACES:
        sentences.append(f"The other {len(places) - MOST_PLACES} are in the table.")
    return sentences


def _agreement(answers: Sequence[Answer], quantity: str, several: bool) -> str:
    """Return how many cases agree, and the state of the others."""
    values = [getattr(row, quantity) for row in answers]
    kinds = [
        "bounded" if row.bounded else value.agreement
        for row, value in zip(answers, values, strict=True)
    ]
    cases = "cases of load, gap, supports and direction" if several else "pairs of load and gap"
    apart = max((value.apart for value in values if value.agreement == "agree"), default=AGREEMENT)
    return f"{NAMES[quantity]}: {agreement_sentence(quantity, kinds, cases, apart)}."


def _readings(config: Any, answers: Sequence[Answer], several: bool) -> list[str]:
    """Return the data that each method reads, and the contribution of the broadband one."""
    if several:
        return [
            "The broadband comparison and the shapes both read the whole band; the pole only"
            " corrects the result of the broadband comparison."
        ]
    others = [
        row.k.methods["broadband"] / (0.5 * (row.k.methods["lscf"] + row.k.methods["ods"])) - 1.0
        for row in answers
        if len(row.k.methods) == len(COMPARED)
    ]
    if not others:
        return []
    identification = config.identification
    return [
        "LSCF pole, peak width and deflection shape all read the main peak"
        f" ({_band(identification.peak_search_Hz)}): that they agree says little. The broadband PSD"
        f" reads every peak from {_band(identification.broadband.band_Hz)}: its k is"
        f" {100.0 * min(others):+.0f} to {100.0 * max(others):+.0f} % from the mean of pole and"
        " shape."
    ]


def _course(rows: Sequence[Answer], quantity: str, scale: tuple[str, float], load: str) -> str:
    """Return the first and the last resolved value with their loads."""
    found: list[tuple[float, Value]] = [
        (row.load_rms_N, getattr(row, quantity)) for row in rows if getattr(row, quantity).resolved
    ]
    unit, factor = scale
    if not found:
        return f"no {quantity} is recommended at any load"
    (first, low), (last, high) = found[0], found[-1]
    if len(found) == 1:
        return (
            f"{quantity} = {digits(factor * low.value)} {unit} at {digits(first)} {load} RMS only"
        )
    return (
        f"{quantity} from {digits(factor * low.value)} {unit} at {digits(first)} {load} RMS to"
        f" {digits(factor * high.value)} {unit} at {digits(last)} {load} RMS"
    )


def answers_by_place(content: Any) -> list[tuple[int, int, float, str]]:
    """Return (gap, group and direction, load, k and c as text) for the controls of the page.

    The first two are positions of the controls, the load is in its unit. content: StudyContent.
    """
    gaps, pairs = places_of(content.answers)
    scale = stiffness_unit([row.k.value for row in content.answers])
    return [
        (
            gaps.index(row.gap_m),
            pairs.index((row.group, row.direction)),
            row.load_rms_N,
            f"{answer_in_words(row, scale)} In a shell: vibroimpact equivalent {content.name}"
            f" --load {row.load_rms_N:g} --gap {row.gap_m:g}",
        )
        for row in content.answers
    ]


def answer_in_words(row: Answer, scale: tuple[str, float]) -> str:
    """Return k and c of a case with their intervals, or why there are none.

    scale: unit of k, and units per N/m.
    """
    parts = []
    for name, value, (unit, factor) in (("k", row.k, scale), ("c", row.c, ("N s/m", 1.0))):
        if value.resolved:
            ends = f"{digits(factor * value.low)} to {digits(factor * value.high)}"
            more = f": {value.reason}" if value.reason else ""
            parts.append(f"{name} = {digits(factor * value.value)} {unit} ({ends}){more}")
        elif name == "k" or value.reason != row.k.reason:
            parts.append(value.reason if row.bounded else f"no {name}: {value.reason}")
    text = "; ".join(parts)
    return text[:1].replace("n", "N") + text[1:] + "."  # but k stays k


def energy_sentences(config: Any, statistics: StudyStatistics) -> list[str]:
    """Return that energy balances are open so far that numbers are of no use, or nothing."""
    found = statistics.open_balances()
    if not found:
        return []
    worst, gap, load = found[0]
    pairs = len(statistics.gaps) * len(statistics.loads)
    return [
        f"Not to be used: in {len(found)} of {pairs} pairs of load and gap the energy balance is"
        f" open by more than {100 * ENERGY_LIMIT:g} % of the input work"
        f" ({digits(100 * worst)} % {_where(config, gap, load)}). Nothing is identified from these"
        " records; do not trust their levels, forces and stresses: raise"
        " integration.steps_per_second."
    ]


def contact_sentences(config: Any, statistics: StudyStatistics) -> list[str]:
    """Return the remarks on contact, wear and stress."""
    sentences = []
    touching, gap, load, _ = statistics.largest("contact_fraction")
    if math.isfinite(touching):
        sentences.append(
            f"Most contact: {digits(100.0 * touching)} % of the time, {_where(config, gap, load)}."
            if touching > 0.0
            else "No support is touched in any case."
        )
    wear, gap, load, _ = statistics.largest("wear_work_rate")
    if math.isfinite(wear) and wear > 0.0:
        sentences.append(f"Largest wear work rate: {digits(wear)} W, {_where(config, gap, load)}.")
    stress = statistics.largest("stress_peak").value
    if math.isfinite(stress):
        limit = f"the limit of {digits(1e-6 * config.record.stress_limit_Pa)} MPa"
        flagged = [_where(config, gap, load) for gap, load in statistics.flagged()]
        more = f" and {len(flagged) - 4} more" if len(flagged) > 4 else ""
        beyond = f". Above {limit}: {'; '.join(flagged[:4])}{more}."
        told = beyond if flagged else f"; no case exceeds {limit}."
        sentences.append(f"Largest stress: {digits(1e-6 * stress)} MPa{told}")
    return sentences


def has_own_gaps(config: Any) -> bool:
    """Whether every support has a gap of its own, so that the gap of a case means nothing."""
    return all(support.gap_m is not None for support in config.supports)


def _where(config: Any, gap_m: float, load: float) -> str:
    gap = "" if has_own_gaps(config) else f" and a gap of {digits(1e3 * gap_m)} mm"
    return f"at {digits(load)} {load_unit(config)} RMS{gap}"
