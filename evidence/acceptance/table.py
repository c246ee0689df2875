"""The acceptance table: each row a question to the verdicts of one kind of campaigns.

Every row has its count, its rate with the 95 % interval, and its target.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .calibration import calibration_error
from .intervals import wilson
from .judging import SINGLE

WORST = 3.0  # the costliest verdict over the target of the median
MINUTES = {"nothing": 0.5, "one effect": 1.0, "two effects": 2.0}  # of CPU, median
CERTAIN = 0.99  # probability that counts as certain
SAID = 0.1  # from which it counts for calibration: the many that are near 0 would hide the others
EFFECTS = (*SINGLE, "two")
NO_FAULT = (
    "nothing",
    *SINGLE,
    "weak",
    "faint",
    "two",
    "masked",
    "other_law",
    "out_of_catalogue",
)
GROUPS = {
    "nothing": "nothing",
    "fault": "fault",
    "out_of_catalogue": "stranger",
    "other_law": "another law",
}  # of the confusion matrix; others are in the catalogue
Row = dict[str, Any]


@dataclass(frozen=True)
class Question:
    """A share of the campaigns of some kinds, empty for all.

    key: column of the answer. least, most: its target. given: column that a campaign counts by.
    """

    kinds: tuple[str, ...]
    quantity: str
    key: str
    least: float | None = None
    most: float | None = None
    given: str = ""

    @property
    def name(self) -> str:
        """Return the kinds in words."""
        groups = {NO_FAULT: "no fault", SINGLE: "one effect", EFFECTS: "one or two effects"}
        if self.kinds in groups:
            return groups[self.kinds]
        return " and ".join(kind.replace("_", " ") for kind in self.kinds) or "all"


QUESTIONS = (
    Question(("nothing",), "an effect asserted", "false_name", most=0.03),
    Question(SINGLE, "first", "first", least=0.96),
    Question(SINGLE, "among the first three", "first_three", least=0.99),
    Question(("weak",), "first", "first", least=0.85),
    Question(("weak",), "wrong name", "wrong", most=0.03),
    Question(("exact_alias",), "both in the set", "both", least=0.95),
    Question(("near_alias",), "both, or the right one alone", "both", least=0.95),
    Question(("two",), "pair in the set", "in_set", least=0.90),
    Question(("two",), "one right", "one_right", least=0.99),
    Question(("masked",), "one right", "one_right", least=0.99),
    Question(("out_of_catalogue",), "open", "open", least=0.95),
    Question(("out_of_catalogue",), "wrong single name", "single_name", most=0.05),
    Question(("other_law",), "family named or in the set", "family", least=0.95),
    Question((), "right, given a single name", "named_right", least=0.98, given="single_name"),
    Question(("fault",), "flagged", "flagged", least=0.95),
    Question(NO_FAULT, "flagged", "flag_not_due", most=0.03),
    Question((), "parameters covered", "covered", least=0.85, most=0.95),
    Question(EFFECTS, "held out, 0.8 closed", "closes", least=0.90, given="in_set"),
)


def acceptance_table(rows: list[Row], stated: Sequence[tuple[float, bool]]) -> list[Row]:
    """Return rows {kind, quantity, campaigns, count, rate, low, high, least, most, standing}.

    rows: judged campaigns. stated: (probability, whether it is true) of all their statements.

    count: campaigns that answer with yes. low, high: 95 % interval of a share (Wilson), quartiles
    of a median. standing: met, missed, or no campaigns; by the rate itself.
    """
    table = [_share(question, rows) for question in QUESTIONS]
    error = np.array([calibration_error([pair for pair in stated if pair[0] >= SAID])])
    quantity = f"expected calibration error, from {SAID:g} on"
    table.append(_number("all", quantity, error[np.isfinite(error)], most=0.05))
    certain = [{"kind": "", "false": not true} for p, true in stated if p >= CERTAIN]
    table.append(_share(Question((), "stated certain, and false", "false", most=0.02), certain))
    errors = _finite(rows, "parameter_error", lambda row: True)
    table.append(_number("all", "parameters: median error", errors, most=0.01))
    for words, number in (("nothing", 0), ("one effect", 1), ("two effects", 2)):
        spent = _finite(rows, "cpu_seconds", _costs(number)) / 60.0
        most = MINUTES[words]
        table.append(_number(words, "CPU per verdict, min, median", spent, most=most))
        worst = np.array([spent.max()]) if spent.size else spent
        row = _number(words, "CPU per verdict, min, worst", worst, most=WORST * most)
        table.append(row | {"campaigns": spent.size})
    return table


def _costs(effects: int) -> Callable[[Row], bool]:
    """Return whether a row counts for the cost of so many effects; faults cost what they cost."""
    return lambda row: row["effects"] == effects and row["kind"] != "fault"


def _finite(rows: list[Row], key: str, counts: Callable[[Row], bool]) -> np.ndarray:
    """Return the finite numbers of a column in the rows that count."""
    values = np.array([row[key] for row in rows if counts(row)], float)
    return values[np.isfinite(values)]


def _share(question: Question, rows: list[Row]) -> Row:
    """Return the row of a question."""
    answers = [
        row.get(question.key, np.nan)  # rows judged before it was asked do not answer
        for row in rows
        if (not question.kinds or row["kind"] in question.kinds)
        and (not question.given or row[question.given])
    ]
    kept = [bool(answer) for answer in answers if np.isfinite(answer)]
    count, total = sum(kept), len(kept)
    rate = count / total if total else float("nan")
    low, high = wilson(count, total) if total else (float("nan"), float("nan"))
    return _row(question.name, question.quantity, total, count, (rate, low, high), question)


def _number(kind: str, quantity: str, values: np.ndarray, most: float) -> Row:
    """Return the row of a median, with its quartiles."""
    middle = np.quantile(values, [0.5, 0.25, 0.75]) if values.size else np.full(3, np.nan)
    return _row(kind, quantity, values.size, None, middle, Question((), "", "", most=most))


def _row(kind, quantity, total, count, numbers, target) -> Row:
    rate, low, high = (float(number) for number in numbers)
    return {
        "kind": kind,
        "quantity": quantity,
        "campaigns": total,
        "count": count,
        "rate": rate,
        "low": low,
        "high": high,
        "least": np.nan if target.least is None else target.least,
        "most": np.nan if target.most is None else target.most,
        "standing": standing(rate, target.least, target.most),
    }


def standing(rate: float, least: float | None, most: float | None) -> str:
    """Return "met" or "missed" of a rate and its target, "no campaigns" where it is NaN."""
    if np.isnan(rate):
        return "no campaigns"
    low_enough = most is None or rate <= most
    return "met" if low_enough and (least is None or rate >= least) else "missed"


def confusion(rows: list[Row]) -> list[Row]:
    """Return rows {group, hidden, first_name, campaigns}: what was hidden against what came first,
    or the verdict where nothing was named.
    """
    counts: dict[tuple[str, str, str], int] = {}
    for row in rows:
        named = row["any_name"] or (row["verdict"] == "partly_explained" and row["named"])
        key = (
            GROUPS.get(row["drawn_as"], "in the catalogue"),
            row["hidden"] or "nothing",
            row["first_name"] if named else row["verdict"],
        )
        counts[key] = counts.get(key, 0) + 1
    return [
        {"group": group, "hidden": hidden, "first_name": name, "campaigns": count}
        for (group, hidden, name), count in sorted(counts.items())
    ]
