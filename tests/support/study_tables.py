"""The folder of a made-up study: tables that follow a power law of load over gap exactly."""

import numpy as np

from vibroimpact.io.records import write_table
from vibroimpact.reduction.model_file import write_model

LOADS, GAPS = (1.0, 2.0, 4.0, 8.0), (1.0e-4, 3.0e-4)
FACTORS = {"lscf": 1.0, "ods": 0.96, "broadband": 1.02, "peak_half": 1.1, "secant": 0.9}
UNRESOLVED = (1.0, 3.0e-4)  # load and gap


def k_law(level):
    """k in N/m at a load over gap in N/m."""
    return 0.05 * level**1.4


def summary_rows(**more):
    """The rows of consistency_summary.csv; more: columns in place of those of all supports in y."""
    rows = []
    for gap in GAPS:
        for load in LOADS:
            blind = (load, gap) == UNRESOLVED
            for method, factor in FACTORS.items():
                k = np.nan if blind and method != "secant" else factor * k_law(load / gap)
                c = np.nan if method in ("ods", "secant") else 1.0e-3 * k
                row = {"gap_m": gap, "load_rms_N": load, "load_over_gap": load / gap}
                row |= {"method": method, "k_median": k, "k_low": 0.9 * k, "k_high": 1.2 * k}
                row |= {"c_median": c, "c_low": 0.5 * c, "c_high": 2.0 * c, "ratio": factor}
                verdict = "unresolved" if blind else "agree"
                row |= {"verdict_k": verdict, "verdict_c": "", "reason": "", "flag": ""}
                rows.append(row | {"group": "all", "direction": "y"} | more)
    return rows


def made_up_study(folder, model, rows=None):
    """Write the tables and the model of a study into a folder, and return the folder."""
    write_table(rows or summary_rows(), folder / "consistency_summary.csv")
    write_model(model, folder / "model.nc")
    return folder


def disputed_study(folder, model):
    """A study in which the pole has a fifth of the k and c of the other methods' intervals."""
    names = [f"{name}_{part}" for name in "kc" for part in ("median", "low", "high")]
    rows = [
        row | {name: 0.2 * row[name] for name in names} if row["method"] == "lscf" else row
        for row in summary_rows()
    ]
    for row in rows:  # the c of a method lies between 0.8 and 1.2 of its median
        row |= {"c_low": 0.8 * row["c_median"], "c_high": 1.2 * row["c_median"]}
    return made_up_study(folder, model, rows)
