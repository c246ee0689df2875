"""The study's tube in CalculiX as a thin pipe of three-dimensional elastic solid.

The elements are 20-node bricks, one through the wall. CalculiX's beam elements are not used: the
user element U1 has no mass, and B32R with a PIPE section, expanded into solids, was 1 % stiff on a
straight tube of 20 elements. The solid pipe has two effects that a beam leaves out: Poisson's
contraction is restrained at the roots (stiffer by about 0.1 %), and the section of the bend turns
oval (softer, see `karman_factor`).
"""

from dataclasses import dataclass

import numpy as np

from .opensees import u_tube_position
from .presence import calculix

# Corners and middles of a C3D20R brick in half steps (along, around, outward), in CalculiX's order.
BRICK = (
    (0, 0, 0),
    (0, 0, 2),
    (0, 2, 2),
    (0, 2, 0),
    (2, 0, 0),
    (2, 0, 2),
    (2, 2, 2),
    (2, 2, 0),
    (0, 0, 1),
    (0, 1, 2),
    (0, 2, 1),
    (0, 1, 0),
    (2, 0, 1),
    (2, 1, 2),
    (2, 2, 1),
    (2, 1, 0),
    (1, 0, 0),
    (1, 0, 2),
    (1, 2, 2),
    (1, 2, 0),
)
DIGITS = 11  # CalculiX reads 20 characters of a number
AROUND = 12  # bricks around the section


@dataclass(frozen=True)
class PipeMesh:
    """Brick elements of a pipe.

    nodes: {(half step along, around, outward): number from 1}.
    position: [(3,) m] of the nodes.
    bricks: [(20,) node numbers].
    """

    nodes: dict
    position: list
    bricks: list


def u_tube_frequencies(config, stiffness, count, bricks=(30, 60), around=AROUND):
    """Return (mode,) Hz, the lowest `count` of the solid U-tube clamped at its roots.

    stiffness: N/m per support, the same in x and y.
    bricks: number along each stretch of a leg between root, plate and bend, and along the bend.
    around: number around the section.

    The spring of a contact point acts on the mean motion of the outer ring of nodes. Springs on
    single nodes would also restrain the twist of the section. Raises JudgeAbsent.
    """
    tube, support = config.structure, config.supports[0]
    leg, radius = tube.leg_length_m, tube.bend_radius_m
    plate = np.linspace(
        support.at_m[2] - 0.5 * support.height_m,
        support.at_m[2] + 0.5 * support.height_m,
        support.points,
    )
    up = np.concatenate(
        [
            np.linspace(0.0, plate[0], bricks[0] + 1),
            plate[1:],
            np.linspace(plate[-1], leg, bricks[0] + 1)[1:],
        ]
    )
    total = 2.0 * leg + np.pi * radius
    arc = np.concatenate(
        [up, leg + np.linspace(0.0, np.pi * radius, bricks[1] + 1)[1:], total - up[-2::-1]]
    )
    frames = [
        _frame(u_tube_position(at, leg, radius), np.clip((at - leg) / radius, 0.0, np.pi))
        for at in _with_middles(arc)
    ]
    pipe = _pipe(frames, tube.section, around)
    rings = [2 * int(np.abs(arc - place).argmin()) for place in (*plate, *(total - plate))]
    springs = [
        (
            sorted(
                number
                for (along, _, outward), number in pipe.nodes.items()
                if (along, outward) == (ring, 2)
            ),
            stiffness / support.points,
        )
        for ring in rings
    ]
    return _frequencies(calculix(_deck(pipe, tube.material, springs, count)), count)


def straight_tube_frequencies(config, length, count, bricks=40, around=AROUND):
    """Return (mode,) Hz, the lowest `count` of a straight clamped-clamped solid tube.

    length: m. The section is that of the study. Raises JudgeAbsent.
    """
    frames = [
        _frame(np.array([0.0, 0.0, at]), 0.0)
        for at in _with_middles(np.linspace(0.0, length, bricks + 1))
    ]
    pipe = _pipe(frames, config.structure.section, around)
    return _frequencies(calculix(_deck(pipe, config.structure.material, [], count)), count)


def karman_factor(structure):
    """Return the factor by which a bend is softer than its beam because its section turns oval.

    It is 1 + 9 / (12 h² + 1) with h = t R / (r² sqrt(1 - nu²)); r is the mean radius of the
    section. Sources: Th. von Karman, Zeitschrift des VDI 55 (1911) 1889, the first term of his
    series, good for h > 0.5; Poisson's ratio, the wall bending as a plate: E. C. Rodabaugh and
    H. H. George, Transactions of the ASME 79 (1957) 939.
    """
    section = structure.section
    mean = 0.5 * (section.outer_diameter_m - section.wall_thickness_m)
    squared = (section.wall_thickness_m * structure.bend_radius_m / mean**2) ** 2 / (
        1.0 - structure.material.poisson_ratio**2
    )
    return 1.0 + 9.0 / (12.0 * squared + 1.0)


def _with_middles(arc):
    """Return (2 n - 1,) values with the midpoints inserted."""
    return np.interp(0.5 * np.arange(2 * len(arc) - 1), np.arange(len(arc)), arc)


def _frame(centre, angle):
    """Return (centre (3,), axes (2, 3) of the section).

    angle: rad, by which the tube has turned from z towards x.
    """
    return centre, np.array([[np.cos(angle), 0.0, -np.sin(angle)], [0.0, 1.0, 0.0]])


def _pipe(frames, section, around):
    """Return the PipeMesh along frames at half steps."""
    outer = 0.5 * section.outer_diameter_m
    nodes, position = {}, []

    def node(along, turn, outward):
        key = (along, turn % (2 * around), outward)
        if key not in nodes:
            centre, axes = frames[along]
            angle = np.pi * key[1] / around
            radius = outer - section.wall_thickness_m * (1.0 - 0.5 * outward)
            nodes[key] = len(position) + 1
            position.append(centre + radius * (np.array([np.cos(angle), np.sin(angle)]) @ axes))
        return nodes[key]

    bricks = [
        [node(along + place[0], turn + place[1], place[2]) for place in BRICK]
        for along in range(0, len(frames) - 1, 2)
        for turn in range(0, 2 * around, 2)
    ]
    return PipeMesh(nodes, position, bricks)


def _deck(pipe, material, springs, count):
    """Return the input deck: bricks, clamped ends, springs, and a frequency step.

    springs: [(node numbers, N/m on their mean motion)], along x and y.
    """
    last = max(along for along, _, _ in pipe.nodes)
    lines = ["*NODE,NSET=ALL"]
    lines += [
        f"{number + 1}," + ",".join(f"{value:.{DIGITS}g}" for value in place.round(DIGITS))
        for number, place in enumerate(pipe.position)
    ]
    lines += ["*ELEMENT,TYPE=C3D20R,ELSET=PIPE"]
    for number, brick in enumerate(pipe.bricks):
        lines += [
            f"{number + 1}," + ",".join(map(str, brick[:15])) + ",",
            ",".join(map(str, brick[15:])),
        ]
    lines += [
        "*MATERIAL,NAME=METAL",
        "*ELASTIC",
        f"{material.young_modulus_Pa:.10g},{material.poisson_ratio:.10g}",
        "*DENSITY",
        f"{material.density_kg_per_m3:.10g}",
        "*SOLID SECTION,ELSET=PIPE,MATERIAL=METAL",
        "*NSET,NSET=ROOTS",
    ]
    lines += [f"{number}," for (along, _, _), number in pipe.nodes.items() if along in (0, last)]
    lines += ["*BOUNDARY", "ROOTS,1,3"]
    for ring, (members, stiffness) in enumerate(springs):
        mean, element = len(pipe.position) + ring + 1, len(pipe.bricks) + 2 * ring
        lines += ["*NODE", f"{mean},0.,0.,0.", "*BOUNDARY", f"{mean},3,3"]
        for direction in (1, 2):
            lines += ["*EQUATION", str(len(members) + 1), f"{mean},{direction},{-len(members)}."]
            lines += [f"{member},{direction},1." for member in members]
            lines += [
                f"*ELEMENT,TYPE=SPRING1,ELSET=S{ring}D{direction}",
                f"{element + direction},{mean}",
                f"*SPRING,ELSET=S{ring}D{direction}",
                str(direction),
                f"{stiffness:.10e}",
            ]
    return "\n".join(
        [*lines, "*STEP", "*FREQUENCY", str(count), "*NODE FILE", "U", "*END STEP", ""]
    )


def _frequencies(printed, count):
    """Return (mode,) Hz from the eigenvalue table of a .dat file.

    Its columns are mode, eigenvalue, rad/s, Hz, imaginary part.
    """
    rows = [line.split() for line in printed.partition("P A R T I C I P A T I O N")[0].splitlines()]
    return np.array([float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()])[:count]
