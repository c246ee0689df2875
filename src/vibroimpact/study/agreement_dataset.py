"""The consistency tables of a study as one dataset."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from vibroimpact.identify.estimate import METHODS, QUALITIES

from .method_agreement import VERDICTS

ESTIMATES = {
    "k_N_per_m": ("k", "N m-1", "equivalent stiffness of a support"),
    "k_standard_error": ("k_standard_error", "N m-1", "standard error of the stiffness"),
    "c_N_s_per_m": ("c", "N s m-1", "equivalent damping of a support"),
    "c_standard_error": ("c_standard_error", "N s m-1", "standard error of the damping"),
    "frequency_Hz": ("frequency", "Hz", "frequency of the main mode, undamped"),
    "damping_ratio": ("damping_ratio", "1", "damping ratio of the main mode"),
}
SUMMARY = {
    "k_median": ("N m-1", "median over seeds of the equivalent stiffness of a support"),
    "k_low": ("N m-1", "smallest equivalent stiffness of a support over seeds"),
    "k_high": ("N m-1", "largest equivalent stiffness of a support over seeds"),
    "c_median": ("N s m-1", "median over seeds of the equivalent damping of a support"),
    "c_low": ("N s m-1", "smallest equivalent damping of a support over seeds"),
    "c_high": ("N s m-1", "largest equivalent damping of a support over seeds"),
    "k_bound": ("N m-1", "upper bound of the stiffness where it does not differ from 0"),
    "contact_fraction": ("1", "time in contact of the support that is touched most"),
    "ratio": ("1", "median stiffness over the median of the compared methods"),
}


def consistency_dataset(rows: list[dict], summary: list[dict]) -> xr.Dataset:
    """Return both tables as one Dataset, qualities and verdicts as flags.

    Estimates have dimensions (support_direction, gap, load, seed, method), the summary
    (support_direction, gap, load, method), the verdicts (support_direction, gap, load).
    """
    axes = {
        "support_direction": list(dict.fromkeys((row["group"], row["direction"]) for row in rows)),
        "gap": sorted({row["gap_m"] for row in rows}, reverse=True),
        "load": sorted({row["load_rms_N"] for row in rows}),
        "seed": sorted({row["seed"] for row in rows}),
        "method": list(METHODS),
    }
    data = _estimates(rows, axes) | _summary(summary, axes)
    coords = {
        "gap": ("gap", axes["gap"], {"units": "m", "long_name": "radial gap"}),
        "load": ("load", axes["load"], {"units": "N", "long_name": "RMS load"}),
        "seed": ("seed", axes["seed"], {"units": "1", "long_name": "number of the realisation"}),
        "method": ("method", axes["method"], {"long_name": "identification method"}),
        "group": (
            "support_direction",
            [group for group, _ in axes["support_direction"]],
            {"long_name": "group of supports that share stiffness and damping"},
        ),
        "direction": (
            "support_direction",
            [name for _, name in axes["support_direction"]],
            {"long_name": "direction in which the supports act"},
        ),
    }
    return xr.Dataset(data, coords, {"title": "vibroimpact consistency of the identifications"})


def _place(row: dict, axes: dict) -> tuple[int, int, int]:
    return (
        axes["support_direction"].index((row["group"], row["direction"])),
        axes["gap"].index(row["gap_m"]),
        axes["load"].index(row["load_rms_N"]),
    )


def _estimates(rows: list[dict], axes: dict) -> dict[str, tuple]:
    """Return the variables over seeds."""
    shape = tuple(len(values) for values in axes.values())
    data = {
        name: (tuple(axes), np.full(shape, np.nan), {"units": unit, "long_name": long_name})
        for name, unit, long_name in ESTIMATES.values()
    }
    quality = np.full(shape, len(QUALITIES) - 1, np.int8)
    flagged = np.zeros(shape, np.int8)
    for row in rows:
        index = (*_place(row, axes), axes["seed"].index(row["seed"]), METHODS.index(row["method"]))
        for column, (name, _, _) in ESTIMATES.items():
            data[name][1][index] = row[column]
        quality[index] = QUALITIES.index(row["quality"])
        flagged[index] = bool(row.get("flag"))
    doubt = "1 where consistency.csv has a flag: doubtful beyond the standard error"
    return data | {
        "quality": (tuple(axes), quality, _flags(QUALITIES, "quality of the estimate")),
        "flagged": (tuple(axes), flagged, {"units": "1", "long_name": doubt}),
    }


def _summary(summary: list[dict], axes: dict) -> dict[str, tuple]:
    """Return the variables without seeds."""
    dims = ("support_direction", "gap", "load", "method")
    shape = tuple(len(axes[dim]) for dim in dims)
    data: dict[str, tuple] = {}
    for column, (unit, long_name) in SUMMARY.items():
        values = np.full(shape, np.nan)
        for row in summary:
            values[(*_place(row, axes), METHODS.index(row["method"]))] = row[column]
        data[column] = (dims, values, {"units": unit, "long_name": long_name})
    for column, what in (
        ("verdict_k", "agreement of lscf, ods and broadband on the stiffness"),
        ("verdict_c", "agreement of lscf and broadband on the damping"),
    ):
        verdicts = np.full(shape[:-1], len(VERDICTS) - 1, np.int8)
        for row in summary:
            if row[column]:
                verdicts[_place(row, axes)] = VERDICTS.index(row[column])
        data[column] = (dims[:-1], verdicts, _flags(VERDICTS, what))
    return data


def _flags(meanings: Sequence[str], long_name: str) -> dict:
    return {
        "units": "1",
        "long_name": long_name,
        "flag_values": np.arange(len(meanings), dtype=np.int8),
        "flag_meanings": " ".join(meanings),
    }
