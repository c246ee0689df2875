"""Points of a normalised parameter space near each other: stars, images, boxes; an angle wraps
round.
"""

import itertools

import numpy as np

NEAR = 0.2  # of the searched range: points farther from the best no longer help to calibrate
NEW = 0.003  # of the searched range: nearer points are the same


def offset(one, other, periodic):
    """Return (parameter,) one minus other of two points, the short way round where an angle
    wraps.
    """
    difference = one - other
    return np.where(
        np.isin(np.arange(len(one)), periodic), (difference + 0.5) % 1.0 - 0.5, difference
    )


def apart(one, other, periodic):
    """Return (parameter,) the distances of two points (an angle wraps round)."""
    return np.abs(offset(one, other, periodic))


def near(path, unit, periodic):
    """Return (point,) bool: the points of a path near unit (parameter,)."""
    return np.array([apart(unit, other, periodic).max() for other in path.parameters]) <= NEAR


def box_round(unit, periodic):
    """Return (parameter, 2): where points near unit (parameter,) lie, any angle."""
    box = np.clip(unit[:, None] + NEAR * np.array([-1.0, 1.0]), 0.0, 1.0)
    box[list(periodic)] = 0.0, 1.0
    return box


def nearest(path, unit, periodic):
    """Return the number of the point of a path that is nearest to unit (parameter,)."""
    return int(np.argmin([np.sum(apart(unit, other, periodic) ** 2) for other in path.parameters]))


def unknown(points, path, periodic):
    """Return those of points (point, parameter) that a path does not hold."""
    return np.array(
        [
            unit
            for unit in points
            if not any(np.all(apart(unit, other, periodic) < NEW) for other in path.parameters)
        ]
    )


def within_simulated(unit, path, best, periodic):
    """Return unit (parameter,) no farther out than the points of a path near `best` (parameter,)
    are, an angle as it is: outside them nothing was simulated.
    """
    known = path.parameters[near(path, best, periodic)]
    return np.where(
        np.isin(np.arange(len(unit)), periodic),
        unit,
        np.clip(unit, known.min(axis=0), known.max(axis=0)),
    )


def images(unit, signed):
    """Return [(parameter,)]: unit with other signs of the parameters that have one. Powers are
    alike there, and only what is odd tells them apart: a star does not reach them.
    """
    points = []
    for sides in itertools.product((False, True), repeat=len(signed)):
        turned = np.array(unit)
        turned[list(signed)] = np.where(sides, 1.0 - turned[list(signed)], turned[list(signed)])
        points.append(turned)
    return points[1:]


def around(unit, step, periodic):
    """Return (point, parameter): unit and its neighbours along each parameter, within 0 to 1 (an
    angle wraps round).
    """
    points = [unit]
    for number in range(len(unit)):
        for side in (-step, step):
            moved = np.array(unit)
            moved[number] = (
                (moved[number] + side) % 1.0
                if number in periodic
                else np.clip(moved[number] + side, 0.0, 1.0)
            )
            if not np.allclose(moved, unit):
                points.append(moved)
    return np.array(points)
