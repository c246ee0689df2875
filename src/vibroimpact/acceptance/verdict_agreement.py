"""Two suites of the same campaigns, longer or with other seeds: which verdicts are the same, and
how far estimates moved.
"""

import numpy as np

from .rates import read, share

# quantity -> whether two judged rows agree in it
AGREE = {
    "same verdict": lambda one, other: one["verdict"] == other["verdict"],
    "same explanations": lambda one, other: _explanations(one) == _explanations(other),
    "an explanation in common, or none": (
        lambda one, other: (
            _explanations(one) == _explanations(other)
            or bool(_explanations(one) & _explanations(other))
        )
    ),
    "true in the set alike": lambda one, other: one["in_set"] == other["in_set"],
}


def differences(folder, other_folder, campaigns):
    """Return rows, one for each of campaigns [name] judged in both folders: what was hidden, both
    verdicts and sets, both closed shares of the held-out misfit, both estimates of the first named
    parameter, their difference in widths of the plain 90 % interval, and whether they agree in each
    of AGREE.
    """
    plain, others = (
        {row["campaign"]: row for row in read(where)} for where in (folder, other_folder)
    )
    rows = []
    for name in campaigns:
        one, other = plain[name], others[name]
        same = one["parameter"] == other["parameter"] != ""
        width = one["high"] - one["low"]
        rows.append(
            {
                "campaign": name,
                "arm": one["arm"],
                "hidden": one["hidden"],
                "verdict": one["verdict"],
                "other_verdict": other["verdict"],
                "named": one["named"],
                "other_named": other["named"],
                "closed": one["closed"],
                "other_closed": other["closed"],
                "parameter": one["parameter"] if same else "",
                "true": one["true"] if same else np.nan,
                "value": one["value"] if same else np.nan,
                "other_value": other["value"] if same else np.nan,
                "moved_in_widths": (
                    abs(other["value"] - one["value"]) / width if same and width > 0.0 else np.nan
                ),
                **{quantity: agree(one, other) for quantity, agree in AGREE.items()},
            }
        )
    return rows


def agreement(rows):
    """Return rows {quantity, campaigns, rate, low, high} of rows of `differences`: shares that
    agree, with 95 % intervals (Clopper-Pearson).
    """
    out = []
    for quantity in AGREE if rows else ():
        alike = [row[quantity] for row in rows]
        low, high = share(sum(alike), len(alike))
        out.append(
            {
                "quantity": quantity,
                "campaigns": len(alike),
                "rate": float(np.mean(alike)),
                "low": low,
                "high": high,
            }
        )
    return out


def _explanations(row):
    return set(row["named"].split("|")) - {""}
