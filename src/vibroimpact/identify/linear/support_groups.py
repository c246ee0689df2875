"""Groups of supports that share one equivalent stiffness and damping in each direction.

A group acts in every transverse direction of its supports: each has a k and a c of its own. A
support whose stops are parallel planes acts along their normal alone. Directions are named after
the global axis that they lie along, so that supports on a bend and on a leg can share a direction.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

ALIGNED = 0.999  # least cosine of the angle to a global axis that gives a direction its name
PARALLEL = 1.0e-9  # largest sine of the angle between the normals of parallel stops
ALL, EACH = "all", "each"


@dataclass(frozen=True, eq=False)
class SupportDirection:
    """A group of supports in one direction: it has one k and one c.

    group, direction: their names.
    supports: names of the supports of the group that act in this direction.
    contact: (mode, contact_row) kg^-1/2, contact shapes along the direction times the root of the
        point's share of its support's stiffness.
    rows: (contact_row,) contact points.
    along: (contact_row, 2), the direction in the two contact directions of the point.
    """

    group: str
    direction: str
    supports: tuple[str, ...]
    contact: np.ndarray
    rows: np.ndarray
    along: np.ndarray

    @property
    def name(self) -> str:
        """Return the name of the group and the direction."""
        return f"{self.group}.{self.direction}"


def grouped_supports(
    support_names: Sequence[str], groups: str | Sequence[Sequence[str]]
) -> dict[str, tuple[str, ...]]:
    """Return {group: names of its supports} of identification.groups.

    groups: "all", "each", or lists of names of supports; a support that they leave out is a group
        of its own. A group is named after its supports, as in plate_1+plate_2.
    """
    if groups == ALL:
        return {ALL: tuple(support_names)}
    listed = [] if groups == EACH else [tuple(members) for members in groups]
    named = {name for members in listed for name in members}
    listed += [(name,) for name in support_names if name not in named]
    return {"+".join(members): members for members in listed}


def support_directions(
    model: ModalModel, groups: str | Sequence[Sequence[str]]
) -> list[SupportDirection]:
    """Return the SupportDirections of all groups, in the order of groups and contact points."""
    acting = [acting_directions(model, point) for point in range(len(model.support_of_point))]
    found = []
    for group, members in grouped_supports(model.support_names, groups).items():
        rows: dict[str, list[tuple[int, np.ndarray]]] = {}
        for point, directions in enumerate(acting):
            if model.support_names[model.support_of_point[point]] in members:
                for direction, along in directions.items():
                    rows.setdefault(direction, []).append((point, along))
        for direction, entries in sorted(rows.items()):
            points, along = map(np.array, zip(*entries, strict=True))
            names = (model.support_names[model.support_of_point[point]] for point in points)
            shapes = np.einsum("mpd,pd->mp", model.contact_shapes[:, points], along)
            contact = shapes * np.sqrt(model.contact_weight[points])
            supports = tuple(dict.fromkeys(names))
            found.append(SupportDirection(group, direction, supports, contact, points, along))
    return found


def acting_directions(model: ModalModel, point: int) -> dict[str, np.ndarray]:
    """Return {name: unit vector (2,)} of the directions that a contact point acts along.

    There is one for parallel stops, their normal, and two for any other obstacle. Vectors are in
    the two contact directions of the point. A direction has the name of the global axis that it
    lies along, `normal` for oblique parallel stops, else `first` or `second`.
    """
    laws, axes = model.contact_laws, model.contact_directions[point]
    normals = laws.land_normal[laws.land_point == point]
    if len(normals):
        first = normals[0]
        across = normals @ np.array([-first[1], first[0]])
        if np.all(np.abs(across) < PARALLEL):
            return {_name(first @ axes, "normal"): first}
    return {
        _name(along @ axes, other): along
        for along, other in zip(np.eye(2), ("first", "second"), strict=True)
    }


def driven_word(model: ModalModel) -> str:
    """Return the word for the contacts' direction that the force moves most."""
    index = driven_direction(model)
    words = list(acting_directions(model, int(np.argmax(model.contact_weight))))
    return words[min(index, len(words) - 1)]


def driven_direction(model: ModalModel) -> int:
    """Return 0 or 1: the direction of the contacts that the drive moves most, statically."""
    static = model.drive_shapes[:, 0] / np.maximum(model.omega, 1.0) ** 2
    moved = np.abs(np.einsum("mcd,m->cd", model.contact_shapes, static))
    return int(np.argmax(moved.sum(axis=0)))


def _name(vector: np.ndarray, other: str) -> str:
    """Return the global axis that a unit vector (3,) lies along, else another word."""
    axis = int(np.argmax(np.abs(vector)))
    return "xyz"[axis] if abs(vector[axis]) > ALIGNED else other


@lru_cache(maxsize=2)
def reached_supports(
    model: ModalModel, groups: str | tuple[tuple[str, ...], ...]
) -> tuple[tuple[SupportDirection, ...], np.ndarray]:
    """Return (the SupportDirections that the force moves, indices of the modes that it moves).

    They are the unknowns of the identification. A force moves modes; these move supports, which
    move further modes. Raises ValueError if the force moves no support.

    groups: identification.groups.
    """
    directions = support_directions(model, groups)
    moved = np.any(model.drive_shapes != 0.0, axis=1)
    reached = [False] * len(directions)
    while True:
        before = moved.copy()
        for index, direction in enumerate(directions):
            touching = np.any(direction.contact != 0.0, axis=1)
            if np.any(moved & touching):
                reached[index] = True
                moved |= touching
        if np.array_equal(moved, before):
            break
    if not any(reached):
        raise ValueError(
            "the force moves no contact point: no support stiffness can be seen from it"
        )
    return tuple(itertools.compress(directions, reached)), np.flatnonzero(moved)


def acts_on_all(direction: SupportDirection, model: ModalModel, modes: np.ndarray) -> bool:
    """Return True when a direction holds every contact that some modes (mode,) move.

    A family with one k and c for all contacts is then that of this direction. Bars that the motion
    slides along have contacts that do not act.
    """
    moved = np.any(model.contact_shapes[modes] != 0.0, axis=0)
    return int(moved.sum()) == len(direction.rows)


def unreached_supports(
    model: ModalModel, groups: str | tuple[tuple[str, ...], ...]
) -> list[tuple[str, str]]:
    """Return (group, direction) that the force does not move."""
    reached = {direction.name for direction in reached_supports(model, groups)[0]}
    return [
        (direction.group, direction.direction)
        for direction in support_directions(model, groups)
        if direction.name not in reached
    ]
