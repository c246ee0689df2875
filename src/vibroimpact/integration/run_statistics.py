"""The statistics of a run's supports, elements and stresses, from the sums of its steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from .kernels.decimation import RATIO

LARGEST = ("peak", "impact_velocity_peak", "residual")  # begin names of maxima, not sums


class Counted(Protocol):
    """Runs whose steps are counted, see batch.BatchResult and held_run.HeldRecords.

    tally {name: (.., run)}, see kernels.tables.Tally. steps: that it counts. contact_rows
    (contact_point, 2), element_rows (element,): rows in the tally.
    """

    @property
    def tally(self) -> dict[str, np.ndarray]: ...  # noqa: D102
    @property
    def steps(self) -> int: ...  # noqa: D102
    @property
    def contact_rows(self) -> np.ndarray: ...  # noqa: D102
    @property
    def element_rows(self) -> np.ndarray: ...  # noqa: D102


@dataclass(frozen=True, eq=False)
class Pooled:
    """Runs of one model taken together as a single one: a Counted of one run."""

    tally: dict[str, np.ndarray]
    steps: int
    contact_rows: np.ndarray
    element_rows: np.ndarray


def pooled(runs: Counted, chosen: Sequence[int] | np.ndarray) -> Pooled:
    """Return the runs with the indices `chosen` as one run."""
    return Pooled(
        {
            name: (np.max if name.startswith(LARGEST) else np.sum)(
                values[..., chosen], axis=-1, keepdims=True
            )
            for name, values in runs.tally.items()
        },
        runs.steps * len(chosen),
        runs.contact_rows,
        runs.element_rows,
    )


def statistics(runs: Counted, run: int, steps_per_second: float) -> dict[str, np.ndarray]:
    """Return contact, wear and stress statistics of one run over its steps, by name."""
    tally = {name: np.asarray(value[..., run]) for name, value in runs.tally.items()}
    steps, dt = runs.steps, 1.0 / steps_per_second
    impacts = tally["impacts"]
    per_impact = np.divide(1.0, impacts, out=np.full(impacts.shape, np.nan), where=impacts > 0)
    rows, elements = runs.contact_rows, runs.element_rows
    return {
        **_work_of_lands(tally, steps * dt),
        "stress_rms": np.sqrt(tally["square_stress"] / steps),
        "stress_peak": np.sqrt(tally["peak_square_stress"]),
        "contact_fraction": tally["contact_steps"] / steps,
        "impact_count": impacts.astype(np.int32),
        "impact_rate": impacts / (steps * dt),
        "peak_force": tally["peak_force"],
        "rms_force": np.sqrt(tally["square_force"] / steps),
        "mean_impulse": tally["force_sum"] * dt * per_impact,
        "impact_velocity_rms": np.sqrt(tally["impact_velocity_square"] * per_impact),
        "impact_velocity_max": tally["impact_velocity_peak"],
        "wear_work_rate": tally["sliding_work"] / (steps * dt),
        "force_displacement": -tally["force_displacement"][rows] / steps,
        "displacement_square": tally["square_displacement"][rows] * RATIO / steps,
        "contact_power": -tally["row_work"][rows] / (steps * dt),
        "force_mean": -tally["row_force"][rows] / steps,
        "displacement_mean": tally["displacement_sum"][rows] * RATIO / steps,
        "velocity_square": tally["square_velocity"][rows] * RATIO / steps,
        "displacement_product": tally["product_displacement"] * RATIO / steps,
        "velocity_product": tally["product_velocity"] * RATIO / steps,
        "element_displacement_square": tally["square_displacement"][elements] * RATIO / steps,
        "element_force_displacement": -tally["force_displacement"][elements] / steps,
        "element_power": -tally["element_work"] / (steps * dt),
        "slip_power": tally["slip_work"] / (steps * dt),
    }


def _work_of_lands(tally: dict[str, np.ndarray], duration: float) -> dict[str, np.ndarray]:
    """Return the work rate of each land by name, nothing if no support has two lands."""
    sliding = tally["sliding_work"]
    if not tally["land_work"].size:
        return {}
    lands = np.array(tally["land_work"]).reshape(len(sliding), -1)
    lands[:, 0] = np.where(lands.any(axis=1), lands[:, 0], sliding)  # a round hole is one land
    return {"land_work_rate": lands / duration}
