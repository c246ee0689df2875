"""A verdict against the truth of its campaign: one row of campaigns.csv.

Both are the plain content of their JSON files. Keys that an engine does not write are answered by
NaN or "", so that verdicts of every age are judged alike.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .families import same_family
from .right_names import EXACT_ALIASES, right_names

STRONG, MEDIUM, FAINT = 3.0, 1.0, 0.3  # floors of excess
PARTLY = 0.5  # closed share from which a partial explanation leaves the question open rightly
CLOSED = 0.8  # of the excess, that held-out records must show
NO_EFFECT = ("nothing", "fault")  # kinds that have no strength
SINGLE = ("strong", "medium", "exact_alias", "near_alias")  # kinds with one effect
FAULT_CHECKS = {
    "clipping",
    "drop-outs",
    "delay",
    "swapped channels",
    "units",
    "gaps in time",
    "directions",
}
SENSOR = {"sensor_gain", "sensor_delay", "sensor_saturation"}
NEAR_ALIASES = {
    "hertz": "contact_stiffness",
    "contact_stiffness": "hertz",
    "hunt_crossley": "contact_damping",
    "contact_damping": "hunt_crossley",
    "added_mass": "mode_frequency_error",
    "mode_frequency_error": "added_mass",
}
# effect: (parameter of the truth, of the catalogue), the same quantity in both codes; the profile
# of a hole is the same in no two
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
    "one_sided_stop": ("distance", "gap"),
    "force_misalignment": ("angle", "angle"),
    "sensor_gain": ("factor", "factor"),
}
NAN = float("nan")
ASSERTED = ("named", "ambiguous", "partly_explained")


def judged(verdict: dict[str, Any], truth: dict[str, Any]) -> dict[str, Any]:
    """Return the row of one campaign: its kind and strength, the digest of the source that judged
    it, what was hidden and what was said of it, which questions of the acceptance table it answers
    with yes, cost and first parameter.

    verdict, truth: contents of verdict.json and of the truth's file.
    """
    hidden = sorted(name for name, _ in truth["effects"])
    sets = [sorted(row) for row in verdict["ambiguity_set"]]
    ranking = verdict["ranking"]
    return {
        "kind": kind_of(truth),
        "drawn_as": truth["kind"],
        "source": str(verdict.get("provenance", {}).get("source_digest", "")),
        "strength": strength_of(truth),
        "hidden": "+".join(hidden),
        "verdict": verdict["verdict"],
        "named": "|".join("+".join(row) for row in sets),
        "first_name": "+".join(sorted(ranking[0]["ids"])) if ranking else "",
        **_answers(verdict, truth, hidden, sets),
        **_misfit(verdict),
        **_cost(verdict, truth),
        **_parameter(verdict, truth),
    }


def strength_of(truth: dict[str, Any]) -> float:
    """Return the excess of the misfit over its floor, in floors, NaN where the truth has none."""
    stated = truth.get("strength", {})
    return float(stated.get("floors", stated.get("excess_over_floor", NAN)))


def kind_of(truth: dict[str, Any]) -> str:
    """Return the kind of a campaign. Strong and medium go by the strength that resulted; whatever
    is weaker than medium counts as weak or faint, but for faults, which are no effects of the
    structure. A pair of which one effect is weaker than medium beside the other is masked.
    """
    kind, floors = str(truth["kind"]), strength_of(truth)
    if kind in NO_EFFECT or np.isnan(floors):
        return kind
    if floors < MEDIUM:
        return "weak" if floors >= FAINT and kind in SINGLE else "faint"
    if kind == "two" and min(truth["strength"].get("beside", [MEDIUM])) < MEDIUM:
        return "masked"
    if kind in ("strong", "medium"):
        return "strong" if floors >= STRONG else "medium"
    return kind


def _answers(verdict, truth, hidden, sets):
    """Return {question: bool} of a verdict."""
    said, kind = verdict["verdict"], truth["kind"]
    named = {name for row in sets for name in row}
    faults = {row["check"] for row in verdict["checks"] if row["level"] != "pass"} & FAULT_CHECKS
    flagged = bool(faults) or bool(named & SENSOR)
    family = same_family(verdict, hidden)
    closed = _held(verdict).get("closed_fraction")
    single = said == "named"
    whole = right_names(truth)
    in_set = any(row in sets for row in whole)
    right = flagged if kind == "fault" else family if kind == "other_law" else in_set
    ranked = [sorted(row["ids"]) for row in verdict["ranking"][:3]]
    return {
        "in_set": in_set,
        "first": ranked[:1] != [] and ranked[0] in whole,
        "first_three": any(row in whole for row in ranked),
        "one_right": bool(set(hidden) & named),
        "wrong": single and not right,
        "pair_wrong": single and not in_set and any(len(row) == 2 for row in sets),
        "any_name": bool(sets) and said in ASSERTED,
        "false_name": bool(sets) and said in ASSERTED and not in_set,
        "single_name": single,
        "named_right": single and right,
        "open": said in ("unknown", "not_testable")
        or (said == "partly_explained" and closed is not None and closed >= PARTLY),
        "flagged": flagged,
        "flag_not_due": flagged and kind != "fault" and not SENSOR & set(hidden),
        "family": family,
        "both": _both(kind, hidden, sets),
    }


def _both(kind, hidden, sets):
    """Return whether aliases are told rightly: exact ones both, near ones both or the right one
    alone.
    """
    if len(hidden) != 1:
        return False
    alone = {row[0] for row in sets if len(row) == 1}
    if kind == "exact_alias":
        return {hidden[0], EXACT_ALIASES.get(hidden[0])} <= alone
    return hidden[0] in alone and (NEAR_ALIASES.get(hidden[0]) in alone or len(sets) == 1)


def _held(verdict):
    """Return the misfit of the records that took no part, {} where there are none."""
    return verdict["misfit"].get("holdout") or {}


def _misfit(verdict):
    """Return {closed, closes, after_over_floor} of the records that took no part."""
    held = _held(verdict)
    closed, after, floor = (
        NAN if held.get(key) is None else float(held[key])
        for key in ("closed_fraction", "after_dB", "floor_dB")
    )
    ratio = after / floor if floor > 0.0 else NAN
    return {
        "closed": closed,
        "closes": float(closed >= CLOSED) if np.isfinite(closed) else NAN,
        "after_over_floor": ratio,
    }


def _cost(verdict, truth):
    """Return {cpu_seconds, effects, record_seconds, channels} of a campaign and its verdict."""
    cost = verdict.get("cost") or {}
    return {
        "cpu_seconds": float(cost.get("cpu_seconds", verdict.get("seconds", NAN))),
        "effects": len(truth["effects"]) if truth["kind"] != "fault" else 0,
        "record_seconds": float(truth.get("duration", NAN)) * len(truth.get("levels", ())),
        "channels": len(truth.get("channels", ())),
    }


def _parameter(verdict, truth):
    """Return {parameter, true, value, low, high, parameter_error, covered} of the first parameter
    that is the same quantity in both codes; "" and NaN where none is named.
    """
    for name, parameters in truth["effects"]:
        true_key, key = SAME_QUANTITY.get(name, ("", ""))
        for effect in verdict["effects"]:
            found = effect["parameters"].get(key) if effect["id"] == name else None
            if found and true_key in parameters and found["value"] is not None:
                true = parameters[true_key]
                low, high = found["low"], found["high"]
                bounded = low is not None and high is not None
                return {
                    "parameter": f"{name}.{key}",
                    "true": true,
                    "value": found["value"],
                    "low": low if bounded else NAN,
                    "high": high if bounded else NAN,
                    "parameter_error": abs(found["value"] / true - 1.0),
                    "covered": float(low <= true <= high) if bounded else NAN,
                }
    keys = ("true", "value", "low", "high", "parameter_error", "covered")
    return {"parameter": "", **dict.fromkeys(keys, NAN)}
