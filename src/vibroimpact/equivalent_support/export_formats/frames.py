"""The head of an exported file, its units, and the frames that springs act in."""

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..contact_points import ContactSet
from ..springs import SpringSet

FIRST_NUMBER = 900001  # of nodes and elements, above the numbers of most models
WIDTH = 66  # of comment lines: an input line of Nastran holds 72 characters of a comment
AXIS_TOLERANCE = 1.0e-9  # of a unit vector's component


@dataclass(frozen=True)
class UnitSystem:
    """A consistent system of units that finite-element models are written in.

    name: in a comment. length: of 1 m. stiffness, damping: of 1 N/m and 1 N s/m.
    """

    name: str
    length: float
    stiffness: float
    damping: float


UNIT_SYSTEMS = {
    "m": UnitSystem("m, N, kg, s", 1.0, 1.0, 1.0),
    "mm": UnitSystem("mm, N, t, s", 1.0e3, 1.0e-3, 1.0e-3),
}


def head(content: SpringSet | ContactSet, unit: UnitSystem, mark: str, use: str) -> list[str]:
    """Return the comment lines that begin a file.

    mark: the start of a comment. use: a sentence on how to use the file.
    """
    sentences = [
        *(f"WARNING: {sentence}." for sentence in content.warnings),
        f"{content.title}, written by vibroimpact. Units: {unit.name}.",
        *content.notes,
        *(f"LEFT OUT: {sentence}." for sentence in content.left_out),
        use,
    ]
    lines = [line for sentence in sentences for line in textwrap.wrap(sentence, WIDTH)]
    return [f"{mark} {line}" for line in lines]


def global_axes(directions: np.ndarray) -> tuple[int, int] | None:
    """Return the global axes (0 to 2) that two directions (2, 3) are, up to the sign.

    None if they are not along the axes.
    """
    axes = np.abs(directions)
    first, second = (int(np.argmax(axis)) for axis in axes)
    along = axes[0, first] > 1.0 - AXIS_TOLERANCE and axes[1, second] > 1.0 - AXIS_TOLERANCE
    return (first, second) if along else None


def local_axes(directions: np.ndarray) -> tuple[tuple[int, int], bool]:
    """Return (axes (0 to 2) that two directions (2, 3) are, whether in a frame of their own)."""
    axes = global_axes(directions)
    return ((0, 1), True) if axes is None else (axes, False)


def numbers(values: Iterable[float], form: str) -> str:
    """Return numbers in one format, separated by commas; without a minus before 0."""
    return ", ".join(f"{value + 0.0:{form}}" for value in values)


def plain_name(text: str) -> str:
    """Return a name of letters, digits and underscores, as every format reads it."""
    return "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in text)
