"""The headline of a study, and the flags of its tables."""

from collections.abc import Iterable, Sequence

import numpy as np

from .reasons import NOT_MOVED, agreement_sentence

CASE_KEYS = ("gap_m", "load_rms_N", "seed", "group", "direction")


def headline(rows: Sequence[dict]) -> str:
    """Return one sentence on a study: the equivalent stiffness of each group of supports at the
    largest gap, from the lowest to the highest load, and how often the methods agree on it.

    rows: of equivalent.csv. Directions that the force does not move are left out.
    """
    moved = [row for row in rows if row["reason_k"] != NOT_MOVED]
    places = list(dict.fromkeys((row["group"], row["direction"]) for row in moved))
    gap = max(row["gap_m"] for row in moved)
    parts = []
    for group, direction in places:
        own = [row for row in moved if (row["group"], row["direction"]) == (group, direction)]
        name = "" if len(places) == 1 else f"{group} in {direction}: "
        parts.append(name + _stiffness_range([row for row in own if row["gap_m"] == gap]))
    kinds = [
        "bounded" if np.isfinite(row.get("k_bound", np.nan)) else row["agreement_k"]
        for row in moved
    ]
    cases = "cases" if len(places) > 1 else "pairs of load and gap"
    found = agreement_sentence("k", kinds, cases)
    return f"{'; '.join(parts)} (gap {1e3 * gap:.2g} mm). {found[0].upper()}{found[1:]}"


def _stiffness_range(rows: Iterable[dict]) -> str:
    """Return the stiffness from the lowest to the highest load at which it is resolved."""
    curve = sorted(
        (row["load_rms_N"], row["k_N_per_m"]) for row in rows if np.isfinite(row["k_N_per_m"])
    )
    if not curve:
        return "no load at which k is resolved"
    ends = [(load, f"{k:.2g}".replace("e+0", "e").replace("e+", "e")) for load, k in curve]
    texts = [f"{k} N/m at {load:g} N" for load, k in (ends[0], ends[-1])]
    return ("k from " if len(curve) > 1 else "k = ") + " to ".join(dict.fromkeys(texts))


def flag_sentences(rows: Sequence[dict], table: str = "equivalent.csv") -> list[str]:
    """Return one sentence on the cases that have a flag in a table, none if there are none.

    rows: of equivalent.csv, or of statistics.csv, which has many per case.
    """
    flags: dict[tuple, str] = {}
    for row in rows:
        if row.get("reason_k") == NOT_MOVED:
            continue
        case = tuple(row.get(key) for key in CASE_KEYS)
        flags[case] = flags.get(case, "") or str(row.get("flag", ""))
    found = [flag for flag in flags.values() if flag]
    if not found:
        return []
    return [
        f"Flagged: {len(found)} of {len(flags)} cases have a flag in {table}, the first:"
        f" {found[0]}."
    ]
