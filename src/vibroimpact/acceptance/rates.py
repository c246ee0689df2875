"""The suite's table: verdicts against the truths of sealed campaigns, arm by arm, with
intervals.
"""

import csv
import json
from pathlib import Path

import numpy as np
from scipy import stats

from vibroimpact.discrepancy.misfit import excess
from vibroimpact.verdict.content import OPEN
from vibroimpact.verdict.file import read_verdict

FAULT_CHECKS = {
    "clipping",
    "drop-outs",
    "delay",
    "swapped channels",
    "units",
    "gaps in time",
    "directions",
}
SENSOR = {"sensor_gain", "sensor_delay"}
GROUPS = {
    "null": "nothing",
    "stranger": "stranger",
    "left_out": "left out",
    "fault": "fault",
}  # others: in the catalogue
OUT_OF_CATALOGUE = (
    "stranger",
    "left_out",
)  # one arm of the acceptance table: what no name fits, and true effects taken out of the catalogue
NAMEABLE = ("strong", "medium", "weak", "two", "alias")  # arms whose truth is in the catalogue
STRONG, MEDIUM = 3.0, 1.0  # floors of excess
TARGETS = {  # arm, quantity -> (target, fails beyond); from the acceptance table
    ("null", "false name"): (0.05, 0.10),
    ("strong", "in the set"): (0.95, 0.80),
    ("strong", "first"): (0.85, 0.70),
    ("medium", "in the set"): (0.75, 0.60),
    ("medium", "wrong name"): (0.10, 0.15),
    ("alias", "both in the set"): (0.80, None),
    ("two", "pair in the set"): (0.60, 0.40),
    ("two", "one right"): (0.85, 0.70),
    ("stranger", "unknown or partly"): (0.80, None),
    ("stranger", "wrong single name"): (0.20, 0.33),
    ("fault", "flagged"): (0.90, 0.75),
    ("parameters", "median error"): (0.10, 0.20),
    ("parameters", "covered"): (0.80, 0.70),
    ("misfit", "closed on hold-out"): (0.80, 0.60),
}
ALIASES = {
    "gap": "sensor_gain",
    "sensor_gain": "gap",
    "hertz": "contact_stiffness",
    "contact_stiffness": "hertz",
    "hunt_crossley": "contact_damping",
    "contact_damping": "hunt_crossley",
    "added_mass": "mode_frequency_error",
    "mode_frequency_error": "added_mass",
}
# effect: (parameter of the truth, of the catalogue), one of each, the same in both codes; the
# profile of a hole is the same in no two
SAME_QUANTITY = {
    "gap": ("factor", "gap_factor"),
    "contact_damping": ("damping", "damping"),
    "hunt_crossley": ("alpha", "alpha"),
    "hertz": ("coefficient", "coefficient"),
    "dry_friction": ("mu", "mu"),
    "plate_flexibility": ("stiffness", "stiffness"),
    "root_stiffness": ("rotation", "rotation"),
    "modal_damping": ("factor", "factor"),
    "mode_frequency_error": ("factor", "factor"),
    "added_mass": ("mass", "mass"),
    "lateral_stinger": ("stiffness", "stiffness"),
    "fluid_added_mass_damping": ("mass", "mass"),
    "cubic_stiffness": ("stiffness", "coefficient"),
    "quadratic_stiffness": ("stiffness", "coefficient"),
    "saturation_stiffness": ("stiffness", "stiffness"),
    "quadratic_drag": ("drag", "coefficient"),
    "coulomb_friction": ("force", "force"),
    "clearance": ("half_gap", "half_gap"),
    "force_misalignment": ("angle", "angle"),
    "sensor_gain": ("factor", "factor"),
}


def strength_of(verdict, truth):
    """Return the excess of the bare model's misfit over its floor on the held-out records, in
    floors; NaN where neither file tells it.

    It is the truth's where that states it, else what the verdict reports of the bare model.
    """
    if "strength" in truth:
        return float(truth["strength"]["excess_over_floor"])
    gap = verdict.misfit.holdout
    return (
        excess(gap.before_dB, gap.floor_dB) / gap.floor_dB
        if gap.before_dB is not None and gap.floor_dB
        else float("nan")
    )


def arm_of(verdict, truth):
    """Return the arm of a campaign: one effect is strong from 3 floors of excess on the held-out
    records on, medium from 1 on, else weak.
    """
    floors = strength_of(verdict, truth)
    if truth["arm"] not in ("strong", "medium") or np.isnan(floors):
        return truth["arm"]
    return "strong" if floors >= STRONG else "medium" if floors >= MEDIUM else "weak"


def judged(verdict, truth):
    """Return the row of one campaign from its Verdict and the content of its truth file: arm,
    strength, what was hidden and what was said of it, which of the suite's questions it answers
    with yes, and the first named parameter that both codes state.
    """
    hidden = sorted(name for name, _ in truth["effects"])
    sets = [sorted(row) for row in verdict.ambiguity_set]
    named = {name for row in sets for name in row}
    first = sorted(verdict.ranking[0].ids) if verdict.ranking else []
    flagged = bool(
        {row.check for row in verdict.checks if row.level != "pass"} & FAULT_CHECKS
    ) or bool(named & SENSOR)
    single = verdict.verdict == "named"
    return {
        "arm": arm_of(verdict, truth),
        "strength": strength_of(verdict, truth),
        "hidden": "+".join(hidden),
        "verdict": verdict.verdict,
        "named": "|".join("+".join(row) for row in sets),
        "first_name": "+".join(first),
        "in_set": hidden in sets,
        "first": first == hidden,
        "one_right": bool(set(hidden) & named),
        "wrong": single and hidden not in sets,
        "any_name": bool(sets) and verdict.verdict in ("named", "ambiguous"),
        "open": verdict.verdict in OPEN,
        "flagged": flagged,
        "both": len(hidden) == 1 and {hidden[0], ALIASES.get(hidden[0])} <= named,
        "closed": verdict.misfit.holdout.closed_fraction,
        **_parameter(verdict, truth),
    }


def _parameter(verdict, truth):
    """Return {parameter, true, value, low, high, parameter_error, covered} of the first parameter
    that is the same quantity in both codes, in the catalogue's unit; "" and NaN where none is
    named.
    """
    for name, parameters in truth["effects"]:
        own = SAME_QUANTITY.get(name)
        for effect in verdict.effects:
            if own and effect.id == name and own[0] in parameters and own[1] in effect.parameters:
                found, true = effect.parameters[own[1]], parameters[own[0]]
                return {
                    "parameter": f"{name}.{own[1]}",
                    "true": true,
                    "value": found.value,
                    "low": found.low,
                    "high": found.high,
                    "parameter_error": abs(found.value / true - 1.0),
                    "covered": float(found.low <= true <= found.high),
                }
    return {
        "parameter": "",
        **dict.fromkeys(
            ("true", "value", "low", "high", "parameter_error", "covered"), float("nan")
        ),
    }


TURNS = 200  # of the labels


def by_chance(rows, arm, key):
    """Return the rate of "in_set" or "first" in an arm where what is hidden is dealt anew among all
    campaigns that hide something nameable, NaN for other keys.
    """
    if key not in ("in_set", "first"):
        return float("nan")
    dealt = [row["hidden"] for row in rows if row["arm"] in NAMEABLE and row["hidden"]]
    answers = [
        row["named"].split("|") if key == "in_set" else [row["first_name"]]
        for row in rows
        if row["arm"] == arm
    ]
    rng = np.random.default_rng(3)
    return float(
        np.mean(
            [
                label in answer
                for _ in range(TURNS)
                for label, answer in zip(rng.choice(dealt, len(answers)), answers, strict=True)
            ]
        )
    )


def share(hits, count):
    """Return (low, high), the 95 % interval of Clopper and Pearson of a share, hits of count."""
    low = stats.beta.ppf(0.025, hits, count - hits + 1) if hits else 0.0
    high = stats.beta.ppf(0.975, hits + 1, count - hits) if hits < count else 1.0
    return float(low), float(high)


def rates(rows):
    """Return rows {arm, quantity, campaigns, rate, low, high, by_chance, target, fails_beyond,
    standing}: point estimate, 95 % interval (Clopper-Pearson; quartiles of the two medians, which
    are no share of campaigns), the rate that shuffled labels give, and whether the target is met.
    """
    wanted = [
        ("null", "false name", "any_name", "null"),
        ("strong", "in the set", "in_set", "strong"),
        ("strong", "first", "first", "strong"),
        ("medium", "in the set", "in_set", "medium"),
        ("medium", "wrong name", "wrong", "medium"),
        ("alias", "both in the set", "both", "alias"),
        ("two", "pair in the set", "in_set", "two"),
        ("two", "one right", "one_right", "two"),
        ("stranger", "unknown or partly", "open", "stranger"),
        ("stranger", "wrong single name", "wrong", "stranger"),
        ("fault", "flagged", "flagged", "fault"),
    ]
    out = []
    for arm, quantity, key, of in wanted:
        chosen = [
            row[key]
            for row in rows
            if row["arm"] in (OUT_OF_CATALOGUE if of == "stranger" else (of,))
        ]
        if chosen:
            out.append(
                _rate(
                    arm,
                    quantity,
                    len(chosen),
                    float(np.mean(chosen)),
                    *share(sum(chosen), len(chosen)),
                    by_chance(rows, of, key),
                )
            )
    errors = [row["parameter_error"] for row in rows]
    closed = [
        row["closed"]
        for row in rows
        if row["arm"] == "strong" and row["in_set"] and row["closed"] is not None
    ]
    covered = [row["covered"] for row in rows if np.isfinite(row["covered"])]
    out += _middle("parameters", "median error", errors)
    if covered:
        out.append(
            _rate(
                "parameters",
                "covered",
                len(covered),
                float(np.mean(covered)),
                *share(sum(covered), len(covered)),
            )
        )
    return out + _middle("misfit", "closed on hold-out", closed)


def _middle(arm, quantity, values):
    """Return [row] of the median of values and their quartiles, [] where none is finite."""
    values = np.asarray(values, float)
    values = values[np.isfinite(values)]
    return (
        [
            _rate(
                arm,
                quantity,
                values.size,
                *(float(np.quantile(values, at)) for at in (0.5, 0.25, 0.75)),
            )
        ]
        if values.size
        else []
    )


def _rate(arm, quantity, count, rate, low, high, chance=float("nan")):
    target, limit = TARGETS[arm, quantity]
    return {
        "arm": arm,
        "quantity": quantity,
        "campaigns": count,
        "rate": rate,
        "low": low,
        "high": high,
        "by_chance": chance,
        "target": target,
        "fails_beyond": np.nan if limit is None else limit,
        "standing": standing(arm, quantity, rate),
    }


def standing(arm, quantity, rate):
    """Return "met", "missed", or "fails" where a rate lies beyond the limit too; a limit above its
    target bounds from above.
    """
    target, limit = TARGETS[arm, quantity]
    sense = -1.0 if limit is not None and limit > target else 1.0
    if sense * rate >= sense * target:
        return "met"
    return "missed" if limit is None or sense * rate >= sense * limit else "fails"


def confusion(rows):
    """Return rows {group, hidden, first_name, campaigns}: what was hidden against what came first,
    or the verdict where nothing was named; group: which kind of thing it was, by the names there
    were to give.
    """
    counts = {}
    for row in rows:
        key = (
            GROUPS.get(row["arm"], "in the catalogue"),
            row["hidden"] or "nothing",
            (
                row["first_name"]
                if row["any_name"] or (row["open"] and row["named"])
                else row["verdict"]
            ),
        )
        counts[key] = counts.get(key, 0) + 1
    return [
        {"group": group, "hidden": hidden, "first_name": name, "campaigns": count}
        for (group, hidden, name), count in sorted(counts.items())
    ]


def read(folder):
    """Return the judged rows of a folder of campaigns: <name>/verdict.json and
    truth/<name>.json.
    """
    rows = []
    for file in sorted(Path(folder).glob("*/verdict.json")):
        truth = Path(folder) / "truth" / f"{file.parent.name}.json"
        if truth.is_file():
            hidden = json.loads(truth.read_text(encoding="utf-8"))
            rows.append(
                {"suite": Path(folder).name, "campaign": file.parent.name}
                | judged(read_verdict(file), hidden)
            )
    return rows


def read_shards(folder, added):
    """Return the judged rows of a folder of campaigns and of campaigns.csv files of shards judged
    elsewhere, each campaign once: as judged here where it is in both.
    """
    rows = {row["campaign"]: row for file in added for row in read_table(file)} | {
        row["campaign"]: row for row in read(folder)
    }
    return [rows[name] for name in sorted(rows)]


TEXT = {
    "suite",
    "campaign",
    "arm",
    "hidden",
    "verdict",
    "named",
    "first_name",
    "parameter",
}  # columns of campaigns.csv
ANSWERS = {"in_set", "first", "one_right", "wrong", "any_name", "open", "flagged", "both"}


def read_table(file):
    """Return the judged rows of a campaigns.csv, as `read` returned them where it was written."""
    with open(file, newline="", encoding="utf-8") as table:
        return [
            {column: _cell(column, text) for column, text in row.items()}
            for row in csv.DictReader(table)
        ]


def _cell(column, text):
    if column in TEXT:
        return text
    if column in ANSWERS:
        return text == "True"
    return float(text) if text else None
