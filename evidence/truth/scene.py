"""What amounts of effects are measured by: sizes of a beam, its supports and its records.

Loads follow from the motion of the linear beam at its supports, so that every geometry has levels
below contact and levels where it rattles.
"""

from dataclasses import dataclass

import numpy as np

from evidence.truth import kernel
from evidence.truth.reduction import reduce_rig
from evidence.truth.rig import Rig

LINES = 6000  # frequencies of the force band


@dataclass(frozen=True)
class Sizes:
    """Sizes of a beam without effects.

    first: rad/s, of the lowest mode. stiffness: N/m, of half of the mass on the lowest mode.
    support_stiffness: N/m, static, of the softest support's place. motion: m/N, RMS at the support
    that moves most under a force of unit RMS in the band, without contact.
    """

    first: float
    stiffness: float
    support_stiffness: float
    motion: float


def sizes(beam, band, drive_direction):
    """The Sizes of a beam under a force in a band [Hz] along a direction (3,)."""
    rig = Rig.bare(beam)
    rig.drive_direction = drive_direction
    reduced = reduce_rig(rig, [("drive", drive_direction)], highest=3000.0)
    first = float(np.sqrt(reduced.omega2[reduced.real].min()))
    rows = support_rows(reduced)
    static = (rows**2 / reduced.omega2).sum(axis=1).max()
    omega = 2.0 * np.pi * np.linspace(*band, LINES)
    motion = np.zeros((len(rows), LINES), complex)
    for row, drive, square, rate in zip(
        rows.T, reduced.drive, reduced.omega2, reduced.rate, strict=True
    ):
        if drive != 0.0:
            motion += row[:, None] * drive / (square - omega**2 + 1j * rate * omega)
    return Sizes(
        first,
        first**2 * 0.5 * beam.section["mass"] * beam.length,
        float(1.0 / static),
        float(np.sqrt(np.mean(np.abs(motion) ** 2, axis=1)).max()),
    )


def support_rows(reduced):
    """(2 plate, mode) displacements of the middle node of every support, y and in plane."""
    split, rows = reduced.split, []
    for p, share in enumerate(reduced.contacts.share):
        part = slice(kernel.SHAPES * p, kernel.SHAPES * (p + 1))
        middle = (np.count_nonzero(share) - 1) // 2
        for lift, shape, modes in (
            (reduced.contacts.lift_y, reduced.contacts.shape_y, slice(0, split)),
            (reduced.contacts.lift_x, reduced.contacts.shape_x, slice(split, None)),
        ):
            row = np.zeros(len(reduced.omega2))
            row[modes] = lift[p, :, middle] @ shape[part]
            rows.append(row)
    return np.array(rows)


@dataclass(frozen=True)
class Scene:
    """Where and how large an effect is to be: what amounts.AMOUNTS need.

    place: arc length, m. direction: (3,). plates: "all", or the name of one. gap: m. load: N RMS,
    the highest. seconds: of all records.
    """

    rng: np.random.Generator
    beam: object
    sizes: Sizes
    place: float
    direction: tuple
    drive_direction: tuple
    plates: str
    gap: float
    load: float
    seconds: float
    channel: str

    @property
    def mass(self):
        """Mass of the beam, kg."""
        return self.beam.section["mass"] * self.beam.length

    @property
    def contact(self):
        """Contact stiffness of a support, N/m."""
        return self.beam.holders[0].stiffness
