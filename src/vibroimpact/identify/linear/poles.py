"""The first pole of the linear tube on a support (k, c).

A pole p of the tube solves (p² + p (diag(damping) + c W) + diag(omega²) + k W) x = 0; `modes`
defines W.
"""

from typing import Any

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

from .modes import PoleError, contact_matrix, driven_block, first_mode, support_stiffness

POLE_TOLERANCE = 1.0e-12
# A Newton step below this that no longer shrinks is round-off: very stiff supports do not reach
# POLE_TOLERANCE.
POLE_ROUND_OFF = 1.0e-7
CONTINUATION_STEP = 0.02  # largest relative change of the pole predicted for one step in c
MAX_NEWTON_PASSES = 12


def pole_of(frequency: Any, damping_ratio: Any) -> Any:
    """Return the complex pole in rad/s of an undamped frequency in Hz and a damping ratio."""
    return 2.0 * np.pi * frequency * (-damping_ratio + 1j * np.sqrt(1.0 - damping_ratio**2))


def frequency_of(pole: Any) -> tuple[Any, Any]:
    """Return (undamped frequency in Hz, damping ratio) of a complex pole in rad/s."""
    return np.abs(pole) / (2.0 * np.pi), -np.real(pole) / np.abs(pole)


def first_pole(model: ModalModel, k: float, c: float) -> complex:
    """Return the pole in rad/s of the first mode of the driven block, imaginary part positive.

    The pole is followed from c = 0, at which it belongs to the lowest mode. So it stays that of the
    same mode if damping makes poles cross or overdamps others.

    k, c: stiffness in N/m and damping in N s/m of the support.

    Raises PoleError when it cannot be followed to c (the message says how far it was), or k leaves
    the tube unstable.
    """
    modes = driven_block(model)
    contact, damping = contact_matrix(model)[modes], model.damping[modes]
    stiffness = support_stiffness(model.omega[modes], contact, k)
    omega, vector = first_mode(model, modes, k)
    start = -0.5 * vector @ (damping * vector) + 1j * omega
    pole, vector = _refine_pole(stiffness, damping, contact, 0.0, start, vector.astype(complex))
    reached, step = 0.0, c
    while reached != c:
        slope = pole * _pole_slope(damping, contact, reached, pole, vector)
        limit = CONTINUATION_STEP * abs(pole) / max(abs(slope), 1.0e-300)
        step = np.sign(c) * min(abs(step), limit, abs(c - reached))
        target = c if abs(step) == abs(c - reached) else reached + step
        try:
            pole, vector = _refine_pole(
                stiffness, damping, contact, target, pole + slope * step, vector
            )
        except ValueError:
            step *= 0.5
            if abs(step) < 1.0e-6 * abs(c):
                raise PoleError(
                    f"the first pole at k = {k:.6g} N/m was followed to c = {reached:.6g} N s/m,"
                    f" not to {c:.6g}"
                ) from None
            continue
        reached, step = target, 2.0 * step
    return pole


def _refine_pole(
    stiffness: np.ndarray,
    damping: np.ndarray,
    contact: np.ndarray,
    c: float,
    pole: complex,
    vector: np.ndarray,
) -> tuple[complex, np.ndarray]:
    """Return (pole, vector (mode,)) by Newton's method from a guess.

    They solve (pole² + pole (diag(damping) + c W) + stiffness) vector = 0. Raises PoleError when
    Newton does not converge, or ends more than 5 % from the guess: that is another mode.
    """
    guess, norm = pole, vector.conj() / np.vdot(vector, vector)
    matrix = np.diag(damping) + c * contact @ contact.T
    size = len(damping)
    # Rows and columns are scaled by the frequencies: residual vectors are 1e4 times stiffer than
    # the first mode.
    scale = 1.0 / np.sqrt(np.diag(stiffness))
    bordered = np.zeros((size + 1, size + 1), dtype=complex)
    bordered[size, :size] = norm * scale
    step = np.inf
    for _ in range(MAX_NEWTON_PASSES):
        slope = 2.0 * pole * vector + matrix @ vector
        bordered[:size, :size] = scale[:, None] * (pole * matrix + stiffness) * scale
        bordered[np.arange(size), np.arange(size)] += pole**2 * scale**2
        bordered[:size, size] = scale * slope
        # The new vector (scaled), and the change of the pole.
        solution = np.linalg.solve(bordered, np.append(np.zeros(size), 1.0))
        vector, pole = scale * solution[:size], pole + solution[size]
        before, step = step, abs(solution[size]) / abs(pole)
        if step < POLE_TOLERANCE or 0.5 * before < step < POLE_ROUND_OFF:
            break
    else:
        raise PoleError("Newton did not settle on a pole")
    if abs(pole - guess) > 0.05 * abs(guess):
        raise PoleError("Newton went to another pole")
    return pole, vector


def _pole_slope(
    damping: np.ndarray, contact: np.ndarray, c: float, pole: complex, vector: np.ndarray
) -> complex:
    """Return d pole / d s in rad/s per N/m for a support s = k + pole c.

    The left eigenvector of the symmetric quadratic problem is the right one.
    """
    moved = contact.T @ vector
    strength = moved @ moved
    return -strength / (vector @ ((2.0 * pole + damping) * vector) + c * strength)
