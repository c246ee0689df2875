"""Levenberg-Marquardt least squares, with trial points that may fail and a Jacobian that may come
from differences.
"""

import time
from dataclasses import dataclass

import numpy as np

FIRST_DAMPING = 1.0e-2
RAISE, LOWER = 4.0, 0.2
TRIES = 8
SETTLED = 2.0e-4  # relative decrease of the cost at which it ends


@dataclass(frozen=True, eq=False)
class Minimum:
    """values (value,); error (residual,) there; slope (residual, value) at the last accepted point
    but one or itself; cost = |error|².
    """

    values: np.ndarray
    error: np.ndarray
    slope: np.ndarray
    passes: int

    @property
    def cost(self):
        """Return the sum of squares."""
        return float(self.error @ self.error)


def minimise(evaluate, start, passes, settled=SETTLED, seconds=np.inf, told=None, error_of=None):
    """Return the Minimum of |error|² from a start.

    evaluate(values) -> (error (residual,), slope (residual, value)); error_of(values) -> error or
    None where there is none, evaluate's own when left out: what a step is tried with. A step is
    damped along each value by its slope's length. Ends when the cost settles, no step lowers it,
    after so many passes or seconds. told(pass, cost) is called after each pass. Raises ValueError
    when the start has no finite error.
    """
    began, values, damping = time.monotonic(), np.asarray(start, float), FIRST_DAMPING
    error_of = error_of or (lambda trial: evaluate(trial)[0])
    error, slope = evaluate(values)
    if not np.isfinite(error).all():
        raise ValueError("the least squares have no finite error at their start")
    done = 0
    for done in range(1, passes + 1):
        length = np.maximum(np.sqrt(np.sum(slope**2, axis=0)), 1.0e-12)
        scaled = slope / length
        normal, gradient = scaled.T @ scaled, scaled.T @ error
        before = error @ error
        for _ in range(TRIES):
            step = -np.linalg.solve(normal + damping * np.eye(values.size), gradient) / length
            tried = error_of(values + step)
            if tried is not None and np.isfinite(tried).all() and tried @ tried < before:
                break
            damping *= RAISE
        else:
            break
        values, error, damping = values + step, tried, max(damping * LOWER, 1.0e-9)
        if told:
            told(done, float(error @ error))
        if (
            before - error @ error < settled * before
            or time.monotonic() - began > seconds
            or done == passes
        ):
            break
        error, slope = evaluate(values)
    return Minimum(values, error, slope, done)


def differences(error_of, values, error, steps):
    """Return the slope (residual, value) by forward differences with steps (value,); a column is 0
    where the trial fails.
    """
    slope = np.zeros((error.size, values.size))
    for index, step in enumerate(steps):
        trial = values.copy()
        trial[index] += step
        moved = error_of(trial)
        if moved is not None:
            slope[:, index] = (moved - error) / step
    return slope
