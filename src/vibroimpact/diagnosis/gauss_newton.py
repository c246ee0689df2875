"""Gauss-Newton on the lines of the holding force.

With r the whitened lines, J their derivative and z the coordinates over their prior sigma, it
lowers misfit + z² / 2: the step solves (2 J^H J + 1 / sd²) dx = -(2 J^H r + x / sd²). Held to the
measurement, r is a smooth function even if the free motion is chaotic. A step of a coordinate of
an effect has a prior of its own, LARGEST_STEP: a coordinate that the lines do not show would take
any step, and leave none for the others. Where a wrong model is not held, derivatives mean nothing
and are large: the step that the lowest load alone asks for is tried as well.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .bench import Bench, holding_lines, misfit, whitening
from .constants import INDEPENDENT
from .coordinates import Coordinate, bounds, to_point, to_vector
from .explanations import Point

# Of a step, run side by side, and beside the step by the lowest load alone.
SHARES = (1.0, 0.4)
FAR = 2.5  # LARGEST_STEP may be too short for a long way: a fit to the end tries a longer step too
LARGEST_STEP = 1.0  # of the coordinate of an effect
TRIES = 3
SETTLED = 2.0e-3  # gain per effective line, below which it ends
FEWEST = 3  # passes before a fit may be given up


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted Point.

    rows, x (coordinate,): the fitted Coordinates and their values. lines (stretch, channel, line):
    of the holding force there. objective: misfit and prior. information (coordinate, coordinate):
    the inverse of their covariance.
    """

    point: Point
    rows: tuple[Coordinate, ...]
    x: np.ndarray
    lines: np.ndarray
    objective: float
    information: np.ndarray

    @property
    def deviation(self) -> np.ndarray:
        """Return (coordinate,): one standard deviation of the coordinates."""
        return np.sqrt(np.diag(np.linalg.pinv(self.information)))


@dataclass(frozen=True, eq=False)
class _Asked:
    """Points that a fit wants run, its objective so far, and the one that it reaches if it goes on
    at the pace of its last pass.
    """

    points: list[Point]
    objective: float = np.inf
    within_reach: float = -np.inf


def linearised(
    bench: Bench, point: Point, rows: Sequence[Coordinate]
) -> tuple[np.ndarray, np.ndarray]:
    """Return (lines (stretch, channel, line) at a Point, (coordinate, stretch, channel, line)): the
    derivatives are differences, 0 if a run fails.
    """
    moved, step = _moved(point, rows)
    lines, *found = holding_lines(bench, [point, *moved])
    return lines, _derivatives(np.reshape(found, (len(rows), *lines.shape)), lines, step)


def _moved(point, rows):
    """Return (Points with one coordinate moved, (coordinate,) by how much)."""
    x = to_vector(point, rows)
    step = np.array(
        [
            row.step if at + row.step <= row.high else -row.step
            for at, row in zip(x, rows, strict=True)
        ]
    )
    return [to_point(x + own, rows, point) for own in np.diag(step)], step


def _derivatives(found, lines, step):
    """Return (coordinate, stretch, channel, line) of the lines found at moved Points."""
    return np.nan_to_num((found - lines) / step[:, None, None, None])


def fits(
    bench: Bench,
    starts: Sequence[tuple[Point, Sequence[Coordinate]]],
    passes: int,
    known: np.ndarray | None = None,
    shares: Sequence[float] = (*SHARES, FAR),
) -> list[Fit]:
    """Return the Fit of coordinates from each (Point, coordinates). All take their steps together,
    so that their runs fill the lanes of the kernel. A fit that would not reach the best one at the
    pace of its last pass is given up.

    passes: at most. known (nuisance, stretch, channel, line): columns of the nuisances among
    the coordinates, which are kept; if None, they are found anew in each pass. shares: of a step
    that are tried.
    """
    running = dict(enumerate(_fit(bench, *start, passes, known, shares) for start in starts))
    asked = {number: next(own) for number, own in running.items()}
    done: dict[int, Fit] = {}
    while asked:
        wanted = [point for own in asked.values() for point in own.points]
        lines = iter(holding_lines(bench, wanted))
        for number, own in list(asked.items()):
            found = np.stack([next(lines) for _ in own.points])
            _advance(running, asked, done, number, found)
        objectives = [own.objective for own in asked.values()]
        best = min(objectives + [own.objective for own in done.values()])
        for number in [each for each, own in asked.items() if own.within_reach > best]:
            _advance(running, asked, done, number, None)
    return [done[number] for number in running]


def _advance(running, asked, done, number, lines):
    """Hand lines to a fit, None to end it; it asks for more Points, or is done."""
    try:
        asked[number] = running[number].send(lines)
    except StopIteration as end:
        done[number] = end.value
        del asked[number]


def fit(
    bench: Bench,
    start: Point,
    rows: Sequence[Coordinate],
    passes: int,
    known: np.ndarray | None = None,
) -> Fit:
    """Return the Fit of coordinates from one Point, see `fits`."""
    return fits(bench, [(start, rows)], passes, known)[0]


def _fit(
    bench: Bench,
    start: Point,
    rows: Sequence[Coordinate],
    passes: int,
    known: np.ndarray | None,
    shares: Sequence[float],
) -> Generator[_Asked, Any, Fit]:
    """Yield Points to be run, take their lines, or None to end, and return the Fit."""
    low, high = bounds(rows)
    sd = np.array([row.sd for row in rows])
    own = np.array([row.of_effect for row in rows], bool)
    x = np.clip(to_vector(start, rows), low, high)
    point = to_point(x, rows, start)
    [lines] = yield _Asked([point])
    slope = np.zeros((len(rows), *lines.shape), np.complex64)
    if known is not None:
        slope[~own] = known
    renewed = own if known is not None else np.ones(len(rows), bool)
    value = misfit(bench, lines) + 0.5 * float(np.sum((x / sd) ** 2))
    information, damping = np.diag(1.0 / sd**2), 1.0e-3
    settled = SETTLED * INDEPENDENT * lines.size
    before, reach = value, -np.inf
    for number in range(passes if np.isfinite(value) else 0):
        if number >= FEWEST:
            reach = value - (passes - number) * (before - value)
        chosen = [row for row, new in zip(rows, renewed, strict=True) if new]
        moved, size = _moved(point, chosen)
        if moved:
            found = yield _Asked(moved, value, reach)
            if found is None:
                break
            slope[renewed] = _derivatives(found, lines, size)
        weight = whitening(bench, lines)
        white, residual = slope * weight, lines * weight
        information, pull = _normal(white, residual, x, sd)
        lowest = _normal(white[:, :1], residual[:1], x, sd)
        before = value
        for _ in range(TRIES):
            step = _step(information, pull, damping, own)
            tried = [np.clip(x + share * step, low, high) for share in shares]
            tried.append(np.clip(x + _step(lowest[0], lowest[1], damping, own), low, high))
            points = [to_point(each, rows, start) for each in tried]
            found = yield _Asked(points, value)
            values = [
                misfit(bench, each) + 0.5 * float(np.sum((at / sd) ** 2))
                for each, at in zip(found, tried, strict=True)
            ]
            best = int(np.argmin(values))
            if values[best] < value:
                x, point, lines, value = tried[best], points[best], found[best], values[best]
                damping *= 0.3 if best == 0 else 1.0
                break
            damping = max(10.0 * damping, 1.0e-2)
        if before - value < settled:
            break
    return Fit(point, tuple(rows), x, lines, value, information)


def _normal(white, residual, x, sd):
    """Return (information (coordinate, coordinate), pull (coordinate,)) of whitened derivatives
    (coordinate, stretch, channel, line), a residual and the priors.
    """
    rows = white.reshape(len(white), -1)
    information, pull = products(rows, rows), products(rows, residual.ravel())
    return information + np.diag(1.0 / sd**2), pull + x / sd**2


def products(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return (row, row) of whitened rows (row, line) and right ones, or (row,) of rows and a
    residual (line,): their products in the information and its pull, see the module.
    """
    return 2.0 * INDEPENDENT * (left.conj() @ right.T).real.astype(float)


def _step(information, pull, damping, own):
    """Return the step (coordinate,); own: coordinates of effects, at most LARGEST_STEP in each."""
    held = damping * np.diag(information) + own / LARGEST_STEP**2
    step = -np.linalg.lstsq(information + np.diag(held), pull, rcond=None)[0]
    return step / max(1.0, np.abs(step[own]).max(initial=0.0) / LARGEST_STEP)
