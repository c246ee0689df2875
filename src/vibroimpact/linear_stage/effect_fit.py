"""Linear effects fitted to the modes of the lowest record with the model itself: how a change of
the configuration changes its modes, and the best parameters by Gauss-Newton.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Generic

import numpy as np
from scipy import linalg, optimize

from vibroimpact.config.reading import Config, ConfigError, check_config
from vibroimpact.observation.attached_model import attach
from vibroimpact.reduction.modal_model import ModalModel

from . import nuisance as linear
from . import priors
from .candidates import Candidate, CandidateOrPair, Pair, Physical
from .linearised import linearised, matched, same_modes
from .workbench import Workbench

COARSE_MESH = {"elements_per_span": 8, "elements_per_bend": 32}
REACH = 6.0  # times the excited band: highest frequency of the reduced basis for readings
STEP = 2.0e-3  # of the searched range: finite difference for the slopes of the readings
TURNS = 8  # iterations of Gauss-Newton
FARTHEST = 0.15  # of the searched range: largest step of an iteration
SETTLED = 1.0e-3  # of the searched range: a smaller step ends the iterations
# fits with the change from the model with the effect itself: the first shifts the parameters by
# percents, the second by less than their scatter
ANCHORED = 2


@dataclass(frozen=True)
class LinearResult(Generic[CandidateOrPair]):
    """The fit of a candidate.

    unit (parameter,): normalised. gain: of log likelihood over the bare model.
    interval (parameter, 2): of 90 %, normalised.
    """

    candidate: CandidateOrPair
    unit: np.ndarray
    gain: float
    interval: np.ndarray


class LinearChanges:
    """How a change of the configuration changes the readings of the modes that the lowest record of
    a Workbench shows, computed with a reduced basis.

    modes (mode,): indices in the bare model. values: the configuration of the reduced basis in
    plain values.
    """

    def __init__(self, bench: Workbench) -> None:
        config = coarse(bench.config, REACH * bench.signals.band_Hz[1])
        self.campaign, self.modes, self.there, self.given = (
            bench.campaign,
            bench.measured_fit.modes,
            bench.bare,
            bench.values,
        )
        self.bare, self.values = attach(config, bench.campaign), config.model_dump(mode="json")
        self.measured = bench.measured_reading
        self.reference = linear.reading_of_model(
            self.bare, same_modes(self.bare, self.modes, bench.bare)
        )
        self.full = linear.reading_of_model(bench.bare, self.modes)

    def _here(self, mode):
        """Return the index that a mode of the full model has in the reduced basis: two of nearly
        one frequency may change their order.
        """
        return int(same_modes(self.bare, [mode], self.there)[0])

    def model(self, candidate: Candidate | Pair, physical: Physical) -> ModalModel:
        """Return the linear ModalModel, of the reduced basis, with a Candidate or Pair at its
        parameters in SI.
        """
        return linearised(
            attach(
                check_config(
                    candidate.renumbered(self._here).variant(self.values, physical),
                    "variant of the model",
                ),
                self.campaign,
            )
        )

    def reading(self, candidate: Candidate | Pair, physical: Physical) -> linear.Reading:
        """Return the Reading of the model with a Candidate or Pair at its parameters in SI: of the
        modes most similar to the measured ones.
        """
        return self.reading_of(self.model(candidate, physical))

    def reading_of(self, model: ModalModel) -> linear.Reading:
        """Return the Reading of the full model with the change that a linear ModalModel of the
        reduced basis shows.
        """
        return moved(self.full, self._of(model), self.reference)

    def whole_reading(self, candidate: Candidate | Pair, physical: Physical) -> linear.Reading:
        """Return the same as reading from the full model, without the reduced basis."""
        return self._of(
            linearised(
                attach(
                    check_config(candidate.variant(self.given, physical), "variant of the model"),
                    self.campaign,
                )
            )
        )

    def _of(self, model):
        return linear.reading_of_model(
            model, matched(model, self.measured.log_frequency, self.measured.participation)
        )


def moved(
    reading: linear.Reading, found: linear.Reading, reference: linear.Reading
) -> linear.Reading:
    """Return a Reading changed by the difference of another one (found) from a reference."""
    return replace(
        reading,
        log_frequency=reading.log_frequency + found.log_frequency - reference.log_frequency,
        log_damping=reading.log_damping + found.log_damping - reference.log_damping,
        participation=reading.participation + found.participation - reference.participation,
    )


def coarse(config: Config, highest_Hz: float) -> Config:
    """Return the configuration with a coarse mesh and free modes alone, up to a frequency in Hz:
    good for changes of modes, not for modes.
    """
    basis = config.basis.model_copy(
        update={
            "free_modes_to_Hz": highest_Hz,
            "constrained_modes_to_Hz": 1.0,
            "attachment_shapes": False,
        }
    )
    structure = config.structure
    if hasattr(structure, "mesh"):
        structure = structure.model_copy(
            update={"mesh": structure.mesh.model_copy(update=COARSE_MESH)}
        )
    return config.model_copy(update={"basis": basis, "structure": structure})


def fitted(
    bench: Workbench,
    changes: LinearChanges,
    candidate: CandidateOrPair,
    unit: np.ndarray,
    scales: dict[str, float],
) -> LinearResult[CandidateOrPair] | None:
    """Return the LinearResult of a Candidate or Pair, fitted by Gauss-Newton with the model itself
    from normalised parameters unit (parameter,); None where the model can not be built. Intervals
    are of each parameter with the others free.
    """
    measured = bench.measured_reading
    bare = linear.likelihood(measured, linear.reading_of_model(bench.bare, changes.modes))[0]

    def reading(unit, anchor):
        physical = candidate.physical(unit, scales)
        return linear.gained(
            moved(anchor[0], changes.reading(candidate, physical), anchor[1]),
            candidate.measuring(physical, bench.signals.names),
        )

    try:
        unit = np.array(unit, float)
        anchor = (changes.full, changes.full)
        # the change from the bare model, then from the model with the effect itself: the reduced
        # basis is 1 to 3 % off in shapes that change much
        for _ in range(ANCHORED):
            unit, best, slopes = descended(
                partial(reading, anchor=anchor), unit, measured, changes.full
            )
            physical = candidate.physical(unit, scales)
            anchor = (
                changes.whole_reading(candidate, physical),
                changes.reading(candidate, physical),
            )
        unit, best, slopes = descended(
            partial(reading, anchor=anchor), unit, measured, changes.full
        )
    except (ConfigError, linalg.LinAlgError):
        return None
    left = max(1.0, best[1] / best[2])  # a misfit beyond chance widens the intervals
    spread = priors.NINETY_SD * np.sqrt(left * np.diag(linalg.pinvh(slopes.T @ slopes)))
    interval = np.stack([np.maximum(unit - spread, 0.0), np.minimum(unit + spread, 1.0)], axis=1)
    return LinearResult(candidate, unit, float(best[0] - bare), interval)


def descended(
    reading: Callable[[np.ndarray], linear.Reading],
    unit: np.ndarray,
    measured: linear.Reading,
    bare: linear.Reading,
) -> tuple[np.ndarray, tuple[float, float, int], np.ndarray]:
    """Return (unit (parameter,), (log likelihood, chi-square, number of values), slopes (value,
    parameter)) at the end of Gauss-Newton from unit.

    reading(unit): the Reading of the model; measured: the measured one; bare: without effects.
    """
    best: tuple[float, float, int] | None = None
    shorter, new = 1.0, unit
    for _ in range(TURNS):
        simulated = reading(new)
        score, chi_square, _ = linear.likelihood(measured, simulated, bare)
        if best is not None and score < best[0]:
            shorter *= 0.4
        else:
            values, covariance, sensitivity = linear.difference(measured, simulated, bare=bare)
            sensitivity = sensitivity * linear.spread(values, covariance, sensitivity)[0]
            factor = linalg.cholesky(covariance + sensitivity @ sensitivity.T, lower=True)
            best, unit, shorter = (score, chi_square, len(values)), new, 1.0
            slopes = np.array(
                [
                    _slope(reading, unit, number, simulated, measured, factor)
                    for number in range(len(unit))
                ]
            ).T
            step = optimize.lsq_linear(
                slopes,
                -linalg.solve_triangular(factor, values, lower=True),
                (-unit - 1.0e-12, 1.0 - unit + 1.0e-12),
            ).x
        taken = step * shorter * min(1.0, FARTHEST / max(np.abs(step).max(), 1.0e-12))
        new = np.clip(unit + taken, 0.0, 1.0)
        if np.abs(taken).max() < SETTLED:
            break
    assert best is not None, "the first step sets it"
    return unit, best, slopes


def _slope(reading, unit, number, simulated, measured, factor):
    """Return (value,): the derivative of the whitened differences by one normalised parameter."""
    side = STEP if unit[number] < 0.5 else -STEP
    there = np.array(unit)
    there[number] += side
    seen = linear.seen_by(measured, simulated)  # the same on both sides
    one, other = (linear.difference(measured, row, seen)[0] for row in (simulated, reading(there)))
    return linalg.solve_triangular(factor, (other - one) / side, lower=True)
