"""The equivalent support of a study at any load and gap inside its grid."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.identify.estimate import METHODS
from vibroimpact.identify.linear.support_groups import acting_directions
from vibroimpact.io.records import RecordError
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.equivalent_table import VALUES
from vibroimpact.study.method_agreement import VERDICTS
from vibroimpact.study.reasons import bound_text

from .answer import NOT_MOVED, Answer, EquivalentError, GroupAnswer, MethodAnswer
from .homogeneity import effects_with_a_scale
from .interpolation import SAME, Reading, ranges_of_agreement, read_at
from .missing_case import no_study_sentence, outside_sentence, require_metres
from .study_tables import RECOMMENDED, SUMMARY, recommended_rows_of, summary_rows_of

Rows = list[dict[str, Any]]


def equivalent(
    study: str | Path, load_rms_N: float, gap_m: float, model: ModalModel | None = None
) -> Answer:
    """Return the Answer of a finished study at a load and a gap.

    If the model is homogeneous of degree one, k and c depend on load over gap alone: they are
    interpolated over it, from every gap of the study that reaches there. Otherwise they are
    interpolated over the load, at a gap of the study. Nothing is extrapolated.

    study: folder of its results, or its name under results/.
    load_rms_N: RMS of the force in N. gap_m: radial gap in m.
    model: reduced model of the study; that of its model.nc by default.

    Raises EquivalentError if there is no answer; the message states the remedy.
    """
    folder = study_folder(study)
    for name, value, unit in (("load", load_rms_N, "N"), ("gap", gap_m, "m")):
        if not (np.isfinite(value) and value > 0.0):
            raise EquivalentError(f"the {name} is {value:g} {unit}: give a positive number")
    model = model_of(folder) if model is None else model
    summary = summary_rows_of(folder)
    recommended = recommended_rows_of(folder, summary)
    require_metres(gap_m, [row["gap_m"] for row in recommended])
    effects = effects_with_a_scale(model)
    if effects:
        gap = _gap_of_the_grid(folder.name, recommended, gap_m, effects)
        recommended = [row for row in recommended if row["gap_m"] == gap]
        summary = [row for row in summary if row["gap_m"] == gap]
    for row in (*recommended, *summary):
        row["level"] = float(row["load_rms_N"]) / (1.0 if effects else float(row["gap_m"]))
    level = load_rms_N / (1.0 if effects else gap_m)
    levels = [row["level"] for row in recommended]
    if np.isnan(levels).all():
        raise EquivalentError(
            f"'{folder.name}' was measured without a force, its records have no load: read k and c"
            f" by the RMS of the response in {folder / RECOMMENDED}"
        )
    if not min(levels) * (1.0 - SAME) <= level <= max(levels) * (1.0 + SAME):
        raise EquivalentError(
            outside_sentence(folder.name, recommended, load_rms_N, gap_m, bool(effects))
        )
    keys = dict.fromkeys((row["group"], row["direction"]) for row in recommended)
    asked = _Asked(load_rms_N, gap_m, level, not effects)
    answers = tuple(
        _group_answer(
            asked,
            *key,
            members(*key, model),
            [
                [row for row in rows if (row["group"], row["direction"]) == key]
                for rows in (recommended, summary)
            ],
        )
        for key in keys
    )
    return Answer(folder.name, "study", load_rms_N, gap_m, answers, not effects, _notes(effects))


@dataclass(frozen=True)
class _Asked:
    """The question: load in N, gap in m, and the level that the tables are read at."""

    load_rms_N: float
    gap_m: float
    level: float
    homogeneous: bool

    def rows_of(self, rows: Rows) -> Rows:
        """Return the rows of the very case if the study has it, else all rows."""
        same = [
            row
            for row in rows
            if abs(row["gap_m"] / self.gap_m - 1.0) <= SAME
            and abs(row["load_rms_N"] / self.load_rms_N - 1.0) <= SAME
        ]
        return same or rows

    def read(self, rows: Rows, name: str, columns: tuple[str, str, str]) -> Reading:
        """Return the Reading of k or c."""
        return read_at(self.rows_of(rows), self.level, columns, name == "k")


def study_folder(study: str | Path) -> Path:
    """Return the folder of a study's results.

    study: the folder, or its name under results/. Raises EquivalentError.
    """
    folders = (Path(study), Path("results") / study)
    for folder in folders:
        if os.path.isfile(folder / SUMMARY):
            return folder.resolve() if folder.name in ("", ".", "..") else folder
    raise EquivalentError(no_study_sentence(study, [folder / SUMMARY for folder in folders]))


def model_of(folder: Path) -> ModalModel:
    """Return the reduced model of a study's folder. Raises EquivalentError."""
    try:
        return read_model(folder / "model.nc")
    except (RecordError, ValueError) as error:
        raise EquivalentError(
            f"{error}. Or give the study's configuration with --config FILE"
        ) from error


def members(group: str, direction: str, model: ModalModel) -> tuple[str, ...]:
    """Return the supports of a group that act in a direction.

    group: "all", the name of a support, or names joined by "+", as in plate_1+plate_2.

    Raises EquivalentError for a name that is not a support, and if none acts in the direction.
    """
    wanted = model.support_names
    if group != "all":
        wanted = (group,) if group in wanted else tuple(group.split("+"))
    unknown = [name for name in wanted if name not in model.support_names]
    if unknown:
        raise EquivalentError(
            f"group '{group}' names no supports of the study's model"
            f" ({', '.join(model.support_names)}): the tables and the model belong to different"
            " studies"
        )
    acting = {
        model.support_names[number]
        for point, number in enumerate(model.support_of_point)
        if direction in acting_directions(model, point)
    }
    found = tuple(name for name in wanted if name in acting)
    if not found:
        raise EquivalentError(
            f"no support of group '{group}' acts in the direction '{direction}': the tables and the"
            " model belong to different studies"
        )
    return found


def _gap_of_the_grid(study: str, rows: Rows, gap_m: float, effects: list[str]) -> float:
    """Return the gap of the study that was asked for. Raises EquivalentError for another one."""
    gaps = sorted({float(row["gap_m"]) for row in rows})
    same = [gap for gap in gaps if abs(gap / gap_m - 1.0) <= SAME]
    if same:
        return same[0]
    raise EquivalentError(
        f"gap {gap_m:g} m is none of study '{study}' ({', '.join(f'{gap:g}' for gap in gaps)} m)."
        f" It can not be interpolated, because the model has {'; '.join(effects)}: k does not"
        " depend on load over gap alone. " + outside_sentence(study, rows, None, gap_m, True)
    )


def _group_answer(
    asked: _Asked, group: str, direction: str, supports: tuple[str, ...], tables: list[Rows]
) -> GroupAnswer:
    """Return the GroupAnswer from the recommended and the summary rows of a group."""
    recommended, summary = tables
    k = asked.read(recommended, "k", (VALUES["k"], "k_low", "k_high"))
    c = asked.read(recommended, "c", (VALUES["c"], "c_low", "c_high"))
    reasons = {"k": _reason(k, "k"), "c": _reason(c, "c")}
    bound = _bound(k)
    if np.isfinite(bound):
        touching = max(row["contact_fraction"] for row in k.rows)
        reasons = dict.fromkeys(reasons, bound_text(bound, touching))
    secant = {
        name: asked.read(recommended, name, (f"secant_{column}",) * 3).span.value
        for name, column in VALUES.items()
    }
    return GroupAnswer(
        group=group,
        supports=supports,
        direction=direction,
        k=k.span,
        c=c.span,
        agreement_k=_agreement(k, "k"),
        agreement_c=_agreement(c, "c"),
        reason_k=reasons["k"],
        reason_c=reasons["c"],
        bound=bound,
        flag=next((row["flag"] for row in k.rows if row["flag"]), ""),
        secant_k=secant["k"],
        secant_c=secant["c"],
        methods=tuple(
            MethodAnswer(
                method,
                *(
                    asked.read(own, name, (f"{name}_median", f"{name}_low", f"{name}_high")).span
                    for name in "kc"
                ),
            )
            for method in METHODS
            if (own := [row for row in summary if row["method"] == method])
        ),
        how=_how(asked, k if k.gaps else c, recommended),
        agreeing=_agreeing_range(asked, recommended),
    )


def _agreement(reading: Reading, name: str) -> str:
    """Return the weakest agreement of the rows behind a value, or of those that lack it."""
    said = {row[f"agreement_{name}"] for row in reading.rows}
    if not reading.span.resolved:
        return "differ" if "differ" in said else "unresolved"
    return max(said, key=VERDICTS.index, default="unresolved")


def _reason(reading: Reading, name: str) -> str:
    """Return why there is no value, from the first case of the study that lacks it; if there is
    one, a remark on it, from the case in which the methods agree least.
    """
    if reading.span.resolved:
        row = max(reading.rows, key=lambda row: VERDICTS.index(row[f"agreement_{name}"]))
        return str(row[f"reason_{name}"])
    lacking = [row for row in reading.rows if not np.isfinite(row[VALUES[name]])]
    if not lacking:
        return ""
    lacking.sort(key=lambda row: row[f"agreement_{name}"] != "differ")
    text = lacking[0][f"reason_{name}"] or "no value in the study"
    if text.startswith(NOT_MOVED):
        return NOT_MOVED
    if len(reading.rows) == 1:
        return str(text)
    place = f"{lacking[0]['load_rms_N']:.3g} N at {1e3 * lacking[0]['gap_m']:.4g} mm"
    others = len(lacking) - 1
    more = f", and likewise {others} more case{'s' if others > 1 else ''}"
    return f"{text} ({place}{more if others else ''})"


def _bound(reading: Reading) -> float:
    """Return the upper bound of k (N/m) at a level: the largest bound or value of the cases next to
    it.

    NaN if k is resolved, or a case has neither.
    """
    if reading.span.resolved or not reading.rows:
        return np.nan
    ends = [row["k_bound"] if np.isnan(row[VALUES["k"]]) else row["k_high"] for row in reading.rows]
    return float(np.max(ends))


def _how(asked: _Asked, reading: Reading, rows: Rows) -> str:
    """Return the sentence on the origin of a value."""
    if asked.rows_of(rows) is not rows:
        return f"a case of the study: {asked.load_rms_N:g} N RMS at {1e3 * asked.gap_m:.4g} mm"
    if not reading.gaps:
        return "between cases of the study that are not resolved"
    low, high = reading.bracket
    if not asked.homogeneous:
        return (
            f"interpolated between {low:.3g} and {high:.3g} N RMS at gap"
            f" {1e3 * reading.gaps[0]:.4g} mm"
        )
    gaps = _listed([f"{1e3 * gap:.4g}" for gap in reading.gaps])
    collapse = (
        f"collapse within {100.0 * (reading.ratio - 1.0):.0f} %"
        if len(reading.gaps) > 1
        else "no other gap reaches there"
    )
    if reading.blocked:
        unresolved = _listed([f"{1e3 * gap:.4g}" for gap in reading.blocked])
        collapse = f"{collapse if len(reading.gaps) > 1 else ''}; not resolved at {unresolved} mm"
        collapse = collapse.removeprefix("; ")
    several = "s" if len(reading.gaps) > 1 else ""
    return (
        f"interpolated between {low:.2e} and {high:.2e} N/m of load over gap, from gap{several}"
        f" {gaps} mm; {collapse}"
    )


def _listed(words: Sequence[str]) -> str:
    """Return "a", "a and b" or "a, b and c"."""
    return " and ".join(filter(None, [", ".join(words[:-1]), words[-1]]))


def _agreeing_range(asked: _Asked, rows: Rows) -> tuple[float, float] | None:
    """Return the range of level nearest to the one asked for in which the methods agree on k."""
    ranges = ranges_of_agreement(rows, "agreement_k")
    x = np.log(asked.level)

    def distance(ends: tuple[float, float]) -> float:
        low, high = np.log(ends)
        return float(max(low - x, x - high, 0.0))

    return min(ranges, key=distance) if ranges else None


def _notes(effects: list[str]) -> tuple[str, ...]:
    """Return the remarks on the interpolation."""
    if not effects:
        return ()
    return (
        f"The model has {'; '.join(effects)}: it is not homogeneous, and k does not depend on load"
        " over gap alone. Values are interpolated over the load at fixed gap.",
    )
