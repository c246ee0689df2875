"""Laws of the equivalent support against the level of the motion, fitted on one study.

There are three forms. "load / gap": k and c of the study's tube against load over gap; exact for
that tube because its model is homogeneous. "scaled": k over the static stiffness of the tube at the
plates, against the RMS displacement that the FREE tube would have there over the gap. The third is
the library's law of the held motion (displacement_law).
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibroimpact.equivalent_support.displacement_law import DisplacementLaw, HeldTube, plate_shapes
from vibroimpact.identify.linear.responses import frf
from vibroimpact.io.records import plain_values
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.study.method_agreement import COMPARED

NEIGHBOURS = 7  # points of the fit that a place of the law is the median of
FREE = 1.0  # N/m: a support that is not there


@dataclass(frozen=True)
class EquivalentLaw:
    """k in N/m and c in N s/m per support against a level, interpolated linearly in logarithms.

    level, k, c (point,): medians, level ascending.

    Below the first level the tube is free; beyond the last, the last slope is continued (see
    `inside`).
    """

    level: np.ndarray
    k: np.ndarray
    c: np.ndarray

    def at(self, level: float) -> tuple[float, float]:
        """Return (k, c) at a level, (0, 0) if the tube is free."""
        if level < self.level[0]:
            return 0.0, 0.0
        x = np.log(level)
        k, c = (
            float(np.exp(_line(x, np.log(self.level), np.log(values))))
            for values in (self.k, self.c)
        )
        return k, c

    def inside(self, level: float) -> bool:
        """Return True if the law interpolates or the tube is free."""
        return bool(level <= self.level[-1])


def _line(x: float, places: np.ndarray, values: np.ndarray) -> float:
    if x <= places[-1]:
        return float(np.interp(x, places, values))
    slope = (values[-1] - values[-4]) / (places[-1] - places[-4])
    return float(values[-1] + slope * (x - places[-1]))


def fit_law(
    summary: Sequence[dict[str, Any]],
    level_of: Callable[[float, float], float],
    scale: tuple[float, float] = (1.0, 1.0),
    without_load: float | None = None,
) -> EquivalentLaw:
    """Return the law of a study: running medians over loads, gaps and methods.

    summary: rows of consistency_summary.csv.
    level_of: function (load N, gap m) that returns the level.
    scale: divisors of k and c.
    without_load: a load in N RMS to leave out.
    """
    points = sorted(
        (level_of(row["load_rms_N"], row["gap_m"]), row["k_median"], row["c_median"])
        for row in summary
        if row["method"] in COMPARED
        and np.isfinite(row["k_median"])
        and row["load_rms_N"] != without_load
    )
    level, k, c = np.array(points, dtype=float).T
    levels, ks, cs = [], [], []
    for first in range(0, len(points) - NEIGHBOURS + 1, 2):
        part = slice(first, first + NEIGHBOURS)
        levels.append(np.exp(np.median(np.log(level[part]))))
        ks.append(np.exp(np.median(np.log(k[part]))))
        cs.append(np.nanmedian(c[part]))  # the shape gives no c
    kept = np.concatenate([[True], np.diff(levels) > 0.0])
    return EquivalentLaw(
        np.array(levels)[kept],
        np.array(ks)[kept] / scale[0],
        np.maximum(np.array(cs)[kept], 1e-3) / scale[1],
    )


def free_level(model: ModalModel, band_Hz: Sequence[float]) -> float:
    """Return the RMS displacement of the free tube at its plates per RMS force in the band, m/N.

    It is that of the middle of the plates, along the drive.
    """
    frequency = np.arange(band_Hz[0], band_Hz[1], 0.02)
    response = frf(model, FREE, 0.0, frequency, plate_shapes(model))
    return float(np.sqrt(np.mean(np.abs(response) ** 2)))


def plate_stiffness(model: ModalModel) -> tuple[float, float]:
    """Return (N/m, N s/m): static stiffness of the tube per plate, and it over the first omega.

    All plates move alike. The second is the scale of c.
    """
    shapes = plate_shapes(model)
    moved = shapes.sum(axis=1)
    kept = model.omega > 0.0
    flexibility = np.sum((moved[kept] / model.omega[kept]) ** 2) / shapes.shape[1]
    first = model.omega[kept][np.argmax((moved[kept] / model.omega[kept]) ** 2)]
    return float(1.0 / flexibility), float(1.0 / (flexibility * first))


def fit_displacement_law(summary: Sequence[dict[str, Any]], tube: HeldTube) -> DisplacementLaw:
    """Return the law of a study: running medians over loads, gaps and the compared methods.

    summary: rows of consistency_summary.csv. tube: of the study.
    """
    points = []
    for row in summary:
        k, c = row["k_median"], row["c_median"]
        if row["method"] in COMPARED and np.isfinite(k):
            case = row["load_rms_N"], row["gap_m"]
            loss = c * tube.first_omega(k) / k
            points.append((tube.level(*case), tube.held(k, *case), loss))
    level, held, loss = np.array(sorted(points), dtype=float).T
    parts = [slice(first, first + NEIGHBOURS) for first in range(0, level.size - NEIGHBOURS + 1, 2)]
    levels = np.array([np.exp(np.median(np.log(level[part]))) for part in parts])
    kept = np.concatenate([[True], np.diff(levels) > 0.0])
    return DisplacementLaw(
        levels[kept],
        np.array([np.exp(np.median(np.log(held[part]))) for part in parts])[kept],
        np.array([np.nanmedian(loss[part]) for part in parts])[kept],  # the shape gives no c
    )


def law_text(law: DisplacementLaw, errors: Sequence[dict[str, Any]], origin: dict[str, Any]) -> str:
    """Return the JSON text of a law, its errors and its origin; numbers with six digits."""
    content = {
        "what": "RMS displacement of the linear tube on its equivalent support over the gap (held)"
        " and loss factor c omega / k (loss), against that of the tube without supports (level)",
        "origin": origin,
        **{name: _six_digits(getattr(law, name)) for name in ("level", "held", "loss")},
        "errors": [{key: float(f"{value:.4g}") for key, value in row.items()} for row in errors],
    }
    return json.dumps(plain_values(content), indent=1) + "\n"


def _six_digits(values: np.ndarray) -> list[float]:
    return [float(f"{value:.6g}") for value in values]
