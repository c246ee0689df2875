"""The suite's table: verdicts against the truths of sealed campaigns, arm by arm, with intervals."""

import json
from pathlib import Path

import numpy as np
from scipy import stats

from vibroimpact.discrepancy.misfit import excess

EQUIVALENT = {"fluid": "fluid_added_mass_damping"}
FAULT_CHECKS = {"clipping", "drop-outs", "delay", "swapped channels", "units", "gaps in time", "directions"}
SENSOR = {"sensor_gain", "sensor_delay"}
NAMEABLE = ("strong", "medium", "weak", "two", "alias")  # arms whose truth is in the catalogue
STRONG, MEDIUM = 3.0, 1.0  # floors of excess
TARGETS = {  # arm, quantity -> (target, fails beyond); from the acceptance table
    ("null", "false name"): (0.05, 0.10), ("strong", "in the set"): (0.95, 0.80), ("strong", "first"): (0.85, 0.70),
    ("medium", "in the set"): (0.75, 0.60), ("medium", "wrong name"): (0.10, 0.15), ("alias", "both in the set"): (0.80, None),
    ("two", "pair in the set"): (0.60, 0.40), ("two", "one right"): (0.85, 0.70), ("stranger", "unknown or partly"): (0.80, None),
    ("stranger", "wrong single name"): (0.20, 0.33), ("fault", "flagged"): (0.90, 0.75), ("parameters", "median error"): (0.10, 0.20),
    ("parameters", "covered"): (0.80, 0.70), ("misfit", "closed on hold-out"): (0.80, 0.60),
}  # fmt: skip
ALIASES = {"gap": "sensor_gain", "sensor_gain": "gap", "hertz": "contact_stiffness", "contact_stiffness": "hertz", "hunt_crossley": "contact_damping",
           "contact_damping": "hunt_crossley", "added_mass": "mode_frequency_error", "mode_frequency_error": "added_mass"}  # fmt: skip
SAME_QUANTITY = {"gap": ("factor", "gap_factor"), "contact_damping": ("damping", "damping"), "hunt_crossley": ("alpha", "alpha"), "dry_friction": ("mu", "mu"),
                 "modal_damping": ("factor", "factor"), "added_mass": ("mass", "mass"), "force_misalignment": ("angle", "angle"),
                 "coulomb_friction": ("force", "force"), "quadratic_drag": ("coefficient", "coefficient"), "sensor_gain": ("factor", "factor")}  # fmt: skip


def arm_of(verdict, truth):
    """Return the arm of a campaign: one effect is strong from 3 floors of excess on the held-out records on, medium from 1 on, else weak.

    The excess is the truth's where that states it, else what the verdict reports of the bare model.
    """
    if truth["arm"] not in ("strong", "medium"):
        return truth["arm"]
    gap = verdict["misfit"]["holdout"]
    if "strength" in truth:
        floors = truth["strength"]["excess_over_floor"]
    elif gap["before_dB"] is None:
        return truth["arm"]
    else:
        floors = excess(gap["before_dB"], gap["floor_dB"]) / gap["floor_dB"]
    return "strong" if floors >= STRONG else "medium" if floors >= MEDIUM else "weak"


def judged(verdict, truth):
    """Return a row {arm, hidden, verdict, named, in_set, first, one_right, wrong, flagged, closed, errors} of one campaign; contents of the two files."""
    hidden = sorted(EQUIVALENT.get(name, name) for name, _ in truth["effects"])
    sets = [sorted(row) for row in verdict["ambiguity_set"]]
    named = {name for row in sets for name in row}
    first = sorted(verdict["ranking"][0]["ids"]) if verdict["ranking"] else []
    flagged = bool({row["check"] for row in verdict["checks"] if row["level"] != "pass"} & FAULT_CHECKS) or bool(named & SENSOR)
    single = verdict["verdict"] == "named"
    return {"arm": arm_of(verdict, truth), "hidden": "+".join(hidden), "verdict": verdict["verdict"], "named": "|".join("+".join(row) for row in sets), "first_name": "+".join(first),
            "in_set": hidden in sets, "first": first == hidden, "one_right": bool(set(hidden) & named), "wrong": single and hidden not in sets,
            "any_name": bool(sets) and verdict["verdict"] in ("named", "ambiguous"),
            "open": verdict["verdict"] in ("unknown", "partly_explained", "not_testable"), "flagged": flagged,
            "both": len(hidden) == 1 and {hidden[0], ALIASES.get(hidden[0])} <= named, "closed": verdict["misfit"]["holdout"]["closed_fraction"],
            "parameter_error": _error(verdict, truth)[0], "covered": _error(verdict, truth)[1]}  # fmt: skip


def _error(verdict, truth):
    """Return (relative error, covered) of the first parameter that is the same quantity in both codes; NaN where none is named."""
    for name, parameters in truth["effects"]:
        own = SAME_QUANTITY.get(name)
        for effect in verdict["effects"]:
            if own and effect["id"] == name and own[0] in parameters and own[1] in effect["parameters"]:
                found, true = effect["parameters"][own[1]], parameters[own[0]]
                return abs(found["value"] / true - 1.0), float(found["low"] <= true <= found["high"])
    return float("nan"), float("nan")


TURNS = 200  # of the labels


def by_chance(rows, arm, key):
    """Return the rate of "in_set" or "first" in an arm where what is hidden is dealt anew among all campaigns that hide something nameable, NaN for other keys."""
    if key not in ("in_set", "first"):
        return float("nan")
    dealt = [row["hidden"] for row in rows if row["arm"] in NAMEABLE and row["hidden"]]
    answers = [row["named"].split("|") if key == "in_set" else [row["first_name"]] for row in rows if row["arm"] == arm]
    rng = np.random.default_rng(3)
    return float(np.mean([label in answer for _ in range(TURNS) for label, answer in zip(rng.choice(dealt, len(answers)), answers, strict=True)]))


def rates(rows):
    """Return rows {arm, quantity, campaigns, rate, low, high, by_chance, target, fails_beyond}: point estimate, 95 % interval (Clopper-Pearson; quartiles
    where it is no share of campaigns), and the rate that shuffled labels give."""
    wanted = [("null", "false name", "any_name", "null"), ("strong", "in the set", "in_set", "strong"), ("strong", "first", "first", "strong"),
              ("medium", "in the set", "in_set", "medium"), ("medium", "wrong name", "wrong", "medium"), ("alias", "both in the set", "both", "alias"),
              ("two", "pair in the set", "in_set", "two"), ("two", "one right", "one_right", "two"), ("stranger", "unknown or partly", "open", "stranger"),
              ("stranger", "wrong single name", "wrong", "stranger"), ("fault", "flagged", "flagged", "fault")]  # fmt: skip
    out = []
    for arm, quantity, key, of in wanted:
        chosen = [row[key] for row in rows if row["arm"] == of]
        if chosen:
            hits, count = int(sum(chosen)), len(chosen)
            low = stats.beta.ppf(0.025, hits, count - hits + 1) if hits else 0.0
            high = stats.beta.ppf(0.975, hits + 1, count - hits) if hits < count else 1.0
            out.append(_rate(arm, quantity, count, hits / count, low, high, by_chance(rows, of, key)))
    errors = np.array([row["parameter_error"] for row in rows])
    covered = np.array([row["covered"] for row in rows])
    closed = np.array([row["closed"] for row in rows if row["arm"] == "strong" and row["in_set"] and row["closed"] is not None], float)
    for quantity, arm, values in (("median error", "parameters", errors), ("covered", "parameters", covered), ("closed on hold-out", "misfit", closed)):
        values = values[np.isfinite(values)]
        if values.size:
            middle = float(np.mean(values) if quantity == "covered" else np.median(values))
            out.append(_rate(arm, quantity, values.size, middle, float(np.quantile(values, 0.25)), float(np.quantile(values, 0.75))))
    return out


def _rate(arm, quantity, count, rate, low, high, chance=float("nan")):
    target, limit = TARGETS[arm, quantity]
    return {"arm": arm, "quantity": quantity, "campaigns": count, "rate": rate, "low": float(low), "high": float(high), "by_chance": chance, "target": target,
            "fails_beyond": np.nan if limit is None else limit}  # fmt: skip


def confusion(rows):
    """Return rows {hidden, first_name, campaigns}: what was hidden against what came first."""
    counts = {}
    for row in rows:
        key = row["hidden"] or "nothing", row["first_name"] if row["any_name"] or row["open"] and row["named"] else row["verdict"]
        counts[key] = counts.get(key, 0) + 1
    return [{"hidden": hidden, "first_name": name, "campaigns": count} for (hidden, name), count in sorted(counts.items())]


def read(folder):
    """Return the judged rows of a folder of campaigns: <name>/verdict.json and truth/<name>.json."""
    rows = []
    for file in sorted(Path(folder).glob("*/verdict.json")):
        truth = Path(folder) / "truth" / f"{file.parent.name}.json"
        if truth.is_file():
            rows.append({"campaign": file.parent.name} | judged(json.loads(file.read_text(encoding="utf-8")), json.loads(truth.read_text(encoding="utf-8"))))
    return rows


def left_out(plan_effects, arm):
    """Return the ids to take out of the catalogue for a campaign of the arm left_out."""
    return {EQUIVALENT.get(name, name) for name, _ in plan_effects} if arm == "left_out" else set()


def run_sealed(values, folder, bank, tables, without=frozenset()):
    """Run the campaign in a folder against a configuration with the candidates of a bank, those of some ids left out; the campaign file is then dropped."""
    from vibroimpact.discrepancy.whole import run_campaign

    folder = Path(folder)
    run_campaign(values, folder / "campaign.nc", folder, {}, bank=bank, tables=tables, without=without)
    (folder / "campaign.nc").unlink()
