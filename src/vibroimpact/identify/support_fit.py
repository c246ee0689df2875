"""The stiffness and damping of every support direction by bounded least squares.

A method gives a residual and its derivatives by ln k and c of each direction. The search starts at
equal stiffnesses, follows each direction in turn over the whole range, and ends in scipy's
trust-region method. So its cost grows with the number of unknowns, not with its power.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

# A coarse search along one stiffness: the distance of two places in ln k, the places between two
# starts, and how often each direction has its turn.
SPACING, SKIPPED, SWEEPS = 1.5, 3, 3
STEPS = 40
UNSEEN = 1.0e-6  # of the largest derivative: a smaller one is round-off
TOLERANCE = 1.0e-9
LOSSES = (0.0, 0.1, 0.4)  # loss factors omega c / k of the supports that a search starts from

# The result of a method: (residual (residual,), jacobian (residual, 2 direction)) at (k, c).
Evaluate = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]

LowestDamping = Callable[[np.ndarray], np.ndarray]

# The start of a search: ln k (direction,) and one loss factor omega c / k at the main peak.
Start = tuple[np.ndarray, float]


@dataclass(frozen=True)
class FoundSupports:
    """The stiffness and damping of each direction that a method found, and their errors.

    k, c: (direction,) N/m and N s/m; c is NaN if the method does not give it.
    covariance: (2 direction, 2 direction) of (ln k, c).
    by_frequency: (2 direction,) change of (ln k, c) per relative error of the model's frequencies;
        None if the covariance holds the model's error.
    """

    k: np.ndarray
    c: np.ndarray
    covariance: np.ndarray
    by_frequency: np.ndarray | None = None


@dataclass(frozen=True)
class SupportValues:
    """The stiffness and damping of each direction, and how well a method knows them.

    k, c: (direction,) N/m and N s/m.
    jacobian: (residual, 2 direction), derivatives by (ln k, c) of all directions.
    residual: (residual,).
    c_at_edge: (direction,) whether the search ended at the least c of a stable structure.
    """

    k: np.ndarray
    c: np.ndarray
    jacobian: np.ndarray
    residual: np.ndarray
    c_at_edge: np.ndarray


def inverse_information(jacobian: np.ndarray) -> np.ndarray:
    """Return (value, value) the inverse of J^T J, very large along directions that the residual
    does not show.

    jacobian: J, (residual, value).
    """
    length = np.linalg.norm(jacobian, axis=0)
    length = np.where(length > UNSEEN * length.max(), length, UNSEEN * length.max())
    scaled = jacobian / length
    values, vectors = np.linalg.eigh(scaled.T @ scaled)
    inverse = (vectors / np.maximum(values, UNSEEN**2)) @ vectors.T
    return inverse / np.outer(length, length)


@dataclass(frozen=True)
class SupportSearch:
    """The range of a search.

    stiffness_range: N/m.
    omega: rad/s of the main peak, which scales the damping.
    """

    stiffness_range: tuple[float, float]
    omega: float

    def coarse_starts(
        self,
        cost: Callable[[np.ndarray, np.ndarray], float],
        directions: int,
        losses: Sequence[float] = LOSSES,
    ) -> list[Start]:
        """Return a Start for each loss factor, near the smallest cost(k, c) with it."""
        starts = []
        for loss in losses:

            def at_loss(log_k: np.ndarray, loss: float = loss) -> float:
                k = np.exp(log_k)
                return cost(k, loss * k / self.omega)

            starts.append((self._swept(at_loss, directions), loss))
        return starts

    def _swept(self, cost: Callable[[np.ndarray], float], directions: int) -> np.ndarray:
        """Return (direction,) ln k near the smallest cost(ln k).

        Sweeps over one direction at a time begin at several stiffnesses common to all: a single
        start ends too often with one support taken for infinitely stiff.
        """
        low, high = np.log(self.stiffness_range)
        places = np.linspace(low, high, 2 + int((high - low) / SPACING))
        found = [
            self._sweep(cost, np.full(directions, place), places) for place in places[1::SKIPPED]
        ]
        return min(found, key=lambda end: end[0])[1]

    def _sweep(
        self, cost: Callable[[np.ndarray], float], log_k: np.ndarray, places: np.ndarray
    ) -> tuple[float, np.ndarray]:
        """Return (cost, ln k (direction,)) at the end of the sweeps from one start."""
        best = cost(log_k)
        for _ in range(SWEEPS):
            before = best
            for index in range(len(log_k)):
                for place in places:
                    trial = log_k.copy()
                    trial[index] = place
                    value = cost(trial)
                    if value < best:
                        best, log_k = value, trial
            if best == before:
                break
        return best, log_k

    def best_of(
        self, evaluate: Evaluate, starts: Sequence[Start], lowest_c: LowestDamping
    ) -> SupportValues:
        """Return the SupportValues of the smallest |residual|² from several starts.

        Arguments as in minimise.
        """
        found = [self.minimise(evaluate, start, lowest_c) for start in starts]
        return min(found, key=lambda values: float(values.residual @ values.residual))

    def minimise(self, evaluate: Evaluate, start: Start, lowest_c: LowestDamping) -> SupportValues:
        """Return the SupportValues of the smallest |residual|² near a start.

        evaluate: function of (k, c) that returns (residual (residual,), jacobian (residual,
            2 direction) by ln k and c).
        lowest_c: function of k (direction,) in N/m that gives the c (direction,) in N s/m below
            which the structure is unstable.

        Raises LinAlgError if the residual at the start is not finite.
        """
        from scipy.optimize import least_squares  # half a second to import

        log_k, loss = start
        count = len(log_k)
        low, high = np.log(self.stiffness_range)
        # The damping is searched in units of k / omega at the start, so that all are near 1.
        unit = np.exp(log_k) / self.omega
        scale = np.concatenate([np.ones(count), unit])
        bounds = (
            np.concatenate([np.full(count, low), lowest_c(np.exp(log_k)) / unit]),
            np.concatenate([np.full(count, high), np.full(count, np.inf)]),
        )
        state: dict[str, np.ndarray] = {}

        def error(values: np.ndarray) -> np.ndarray:
            residual, jacobian = evaluate(np.exp(values[:count]), values[count:] * unit)
            if not state and not np.isfinite(residual).all():
                raise np.linalg.LinAlgError("the structure has no response that could be compared")
            state["values"], state["slope"] = values.copy(), jacobian * scale
            return residual

        def slope(values: np.ndarray) -> np.ndarray:
            if not np.array_equal(state["values"], values):
                error(values)
            return state["slope"]

        margin = 1.0e-6 * (high - low)
        values = np.concatenate([np.clip(log_k, low + margin, high - margin), np.full(count, loss)])
        found = least_squares(
            error,
            np.clip(values, bounds[0] + 1.0e-9, bounds[1]),
            jac=slope,
            bounds=bounds,
            x_scale="jac",
            xtol=TOLERANCE,
            ftol=TOLERANCE,
            gtol=TOLERANCE,
            max_nfev=STEPS,
        )
        k, c = np.exp(found.x[:count]), found.x[count:] * unit
        residual, jacobian = evaluate(k, c)
        return SupportValues(k, c, jacobian, residual, found.active_mask[count:] < 0)
