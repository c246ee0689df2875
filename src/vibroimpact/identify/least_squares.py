"""Levenberg-Marquardt least squares. Trial points may fail, and the Jacobian may come from
differences.

Source: K. Levenberg, Quart. Appl. Math. 2 (1944) 164-168; D.W. Marquardt, SIAM J. Appl. Math. 11
(1963) 431-441. Departure: the damping acts along each value by the length of its column.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

FIRST_DAMPING = 1.0e-2
RAISE, LOWER = 4.0, 0.2
TRIES = 8
SETTLED = 2.0e-4  # relative decrease of the cost at which it ends

# Functions of the values: their error, and their error with the Jacobian.
ErrorOf = Callable[[np.ndarray], np.ndarray | None]
Evaluate = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True, eq=False)
class Minimum:
    """The end of a minimisation.

    values (value,); error (residual,) there; slope (residual, value): the Jacobian at the point of
    the last step; cost = |error|².
    """

    values: np.ndarray
    error: np.ndarray
    slope: np.ndarray

    @property
    def cost(self) -> float:
        """Return the sum of squares."""
        return float(self.error @ self.error)


def minimise(
    evaluate: Evaluate,
    start: np.ndarray,
    passes: int,
    settled: float = SETTLED,
    error_of: ErrorOf | None = None,
) -> Minimum:
    """Return the Minimum of |error|² from a start (value,).

    evaluate(values): (error (residual,), Jacobian (residual, value)).
    error_of(values): the error of a trial step, None if it fails; that of evaluate by default.
    passes: at most.
    settled: relative decrease of the cost in a pass at which it ends.

    It also ends if no step lowers the cost. Raises ValueError if the start has no finite
    error.
    """
    values, damping = np.asarray(start, float), FIRST_DAMPING
    error_at: ErrorOf = error_of or (lambda trial: evaluate(trial)[0])
    error, slope = evaluate(values)
    if not np.isfinite(error).all():
        raise ValueError("the least squares have no finite error at their start")
    for done in range(1, passes + 1):
        length = np.maximum(np.sqrt(np.sum(slope**2, axis=0)), 1.0e-12)
        scaled = slope / length
        normal, gradient = scaled.T @ scaled, scaled.T @ error
        before = error @ error
        for _ in range(TRIES):
            step = -np.linalg.solve(normal + damping * np.eye(values.size), gradient) / length
            tried = error_at(values + step)
            if tried is not None and np.isfinite(tried).all() and tried @ tried < before:
                break
            damping *= RAISE
        else:
            break
        values, error, damping = values + step, tried, max(damping * LOWER, 1.0e-9)
        if before - error @ error < settled * before or done == passes:
            break
        error, slope = evaluate(values)
    return Minimum(values, error, slope)


def differences(
    error_of: ErrorOf, values: np.ndarray, error: np.ndarray, steps: np.ndarray
) -> np.ndarray:
    """Return the Jacobian (residual, value) by forward differences with steps (value,).

    error: that at values. A column is 0 if the trial fails.
    """
    slope = np.zeros((error.size, values.size))
    for index, step in enumerate(steps):
        trial = values.copy()
        trial[index] += step
        moved = error_of(trial)
        if moved is not None:
            slope[:, index] = (moved - error) / step
    return slope


def minimise_by_differences(
    error_of: ErrorOf, start: np.ndarray, steps: np.ndarray, passes: int
) -> Minimum:
    """Return the Minimum of |error|² from a start (value,), its Jacobian by differences with steps
    (value,). passes: at most. Raises ValueError if the start has no finite error.
    """

    def evaluate(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        error = error_of(values)
        if error is None:
            raise ValueError("the least squares have no error at their start")
        return error, differences(error_of, values, error, steps)

    return minimise(evaluate, start, passes, error_of=error_of)
