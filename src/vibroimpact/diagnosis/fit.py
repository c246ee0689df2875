"""Gauss-Newton on the lines of the holding force."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .coordinates import Coordinate, point_of, vector
from .explanations import Point
from .held import Bench, bands, lines, log_power, moving

TEMPER = 0.1
STEPS = (1.0, 0.5, 0.2)


@dataclass(frozen=True, eq=False)
class Fit:
    point: Point
    rows: tuple
    x: np.ndarray
    lines: np.ndarray
    objective: float
    normal: np.ndarray
    columns: np.ndarray | None = None

    def sd(self):
        return np.sqrt(np.diag(np.linalg.inv(self.normal)))


def objective(bench, own, x, rows):
    """Tempered Whittle likelihood, levels of bands profiled, and priors."""
    edges = bands(own.shape[-1])
    lp = log_power(own, edges)
    n = np.array([j - i for i, j in edges])
    mv = moving(bench)
    sd = np.array([row.sd for row in rows])
    return (
        TEMPER * float(np.sum(lp * n * mv[..., None])) + 0.5 * float(np.sum((x / sd) ** 2))
        if np.isfinite(lp).all()
        else np.inf
    )


def score(bench, own):
    """Mean log power over bands."""
    edges = bands(own.shape[-1])
    lp = log_power(own, edges)
    n = np.array([j - i for i, j in edges])
    mv = moving(bench)[..., None] * n
    return float(np.sum(lp * mv) / np.sum(mv * np.ones(lp.shape)))


def weights_of(bench, own):
    edges = bands(own.shape[-1])
    lp = log_power(own, edges)
    w = np.concatenate(
        [
            np.repeat(np.exp(-0.5 * lp[..., k : k + 1]), j - i, axis=-1)
            for k, (i, j) in enumerate(edges)
        ],
        axis=-1,
    )
    return w * moving(bench)[..., None]


def columns(bench, point, rows, base, which):
    """(coordinate, stretch, sensor, line) derivative for rows of `which`."""
    x = vector(point, rows)
    pts, steps = [], []
    for k in which:
        moved = x.copy()
        step = rows[k].step if moved[k] + rows[k].step <= rows[k].high else -rows[k].step
        moved[k] += step
        pts.append(point_of(moved, rows, point))
        steps.append(step)
    own = lines(bench, pts)
    return (own - base) / np.array(steps)[:, None, None, None]


def gauss_newton(
    bench,
    start: Point,
    rows: Sequence[Coordinate],
    passes=6,
    known=None,
    settled=2e-3,
    verbose=False,
) -> Fit:
    """known: {coordinate index: column} that are kept (chord)."""
    x = np.clip(vector(start, rows), [r.low for r in rows], [r.high for r in rows])
    point = point_of(x, rows, start)
    base = lines(bench, [point])[0]
    now = objective(bench, base, x, rows)
    damping = 1e-3
    sd = np.array([row.sd for row in rows])
    term = [k for k, r in enumerate(rows) if r.kind in ("term", "place")]
    nuis = [k for k, r in enumerate(rows) if r.kind not in ("term", "place")]
    J = np.zeros((len(rows), *base.shape), np.complex64)
    H = np.diag(1 / sd**2)
    if known is not None:
        J[nuis] = known
    for turn in range(passes):
        which = term if known is not None else list(range(len(rows)))
        if not which and turn and known is None:
            which = nuis
        if which:
            J[which] = columns(bench, point, rows, base, which)
        J = np.nan_to_num(J)
        w = weights_of(bench, base)
        r = (base * w).ravel()
        A = (J * w).reshape(len(rows), -1)
        H = 2 * TEMPER * (A.conj() @ A.T).real.astype(float) + np.diag(1 / sd**2)
        g = 2 * TEMPER * (A.conj() @ r).real.astype(float) + x / sd**2
        better = False
        for _ in range(4):
            step = -np.linalg.solve(H + damping * np.diag(np.diag(H)), g)
            big = np.abs(step[term]).max(initial=0.0)
            if big > 1.0:
                step = step * (1.0 / big)
            tries = [
                np.clip(x + s * step, [r.low for r in rows], [r.high for r in rows]) for s in STEPS
            ]
            pts = [point_of(t, rows, start) for t in tries]
            own = lines(bench, pts)
            obj = [objective(bench, o, t, rows) for o, t in zip(own, tries)]
            k = int(np.nanargmin(obj))
            if obj[k] < now - 1e-6:
                gained = now - obj[k]
                x, point, base, now, better = tries[k], pts[k], own[k], obj[k], True
                damping = max(0.3 * damping, 1e-6) if k == 0 else damping
                break
            damping = max(10 * damping, 1e-2)
        if verbose:
            print("   pass", turn, round(now, 2), [round(float(v), 3) for v in x[term]], flush=True)
        if not better or gained < settled * TEMPER * base.size / 100:
            break
    return Fit(point, tuple(rows), x, base, now, H, J)
