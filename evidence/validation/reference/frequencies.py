"""R10: frequencies of beams, continuous beams, U-bend, ring and the stand-in tube.

They are compared with closed forms and published numbers.
"""

import numpy as np
from scipy import linalg, optimize

from evidence.validation.check import Check
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.reduction.ritz_basis import eigenmodes, uncoupled_groups
from vibroimpact.structure.beam_elements import element_matrices, section_beam
from vibroimpact.structure.tube import build_structure, element_geometry

SECTION = {"outer_diameter_m": 0.02222, "wall_thickness_m": 0.00127, "shear_coefficient": 0.53}
MATERIAL = {"young_modulus_Pa": 2.02e11, "poisson_ratio": 0.3, "density_kg_per_m3": 8330.0}
ROOTS = {  # beta L of a beam by its ends
    "clamped-pinned": (3.926602312, 7.068582746, 10.210176123, 13.351768778),
    "clamped-clamped": (4.730040745, 7.853204624, 10.995607838),
    "clamped-free": (1.875104069, 4.694091133, 7.854757438),
    "pinned-pinned": (np.pi, 2.0 * np.pi, 3.0 * np.pi),
}
U_BEND_HZ = {
    "euler_bernoulli": ((66.32, 174.43), (31.89, 87.48, 193.73)),
    "timoshenko": ((66.00, 173.06), (31.85, 87.22, 192.52)),
}
RING_HZ = {"out of plane": (51.85, 148.8, 287.0), "in plane": (53.38, 151.0, 289.5)}
# Stand-in tube: (theory, bend elements, k N/m per support) -> Hz, O out of plane, I in plane
TUBE_HZ = {
    ("euler_bernoulli", 80, 1.0): "15.98O 29.02I 45.10O 104.94I 105.12O 172.23O 173.04I",
    ("timoshenko", 80, 1.0): "15.97O 28.96I 45.03O 104.45I 104.68O 171.12O 171.75I",
    ("timoshenko", 40, 1.0e4): "16.78O 30.11I 46.24O 106.38I 106.61O 173.17O 173.95I",
    ("timoshenko", 40, 1.0e5): "20.96O 37.06I 53.84O 120.45I 120.96O 190.06O 191.78I",
    ("timoshenko", 40, 1.0e6): "26.71O 50.31I 68.81O 161.98I 165.43O 275.63O 279.23I",
    ("timoshenko", 40, 4.0e6): "27.99O 53.94I 72.83O 175.26I 179.92O 316.52O 320.16I",
    ("timoshenko", 40, 1.0e9): "33.33O 64.58I 85.21O 198.91I 206.12O 368.72O 372.01I",
}
TUBE_TOLERANCE = 1e-3
CLOSED_FORM_TOLERANCE = 2e-5
PUBLISHED_TOLERANCE = 1e-3
THIN_RING_TOLERANCE = 5e-3
RIGID_SUPPORT = 1.0e12  # N/m: stiff compared with the tube, still far from round-off


def frequency_checks(study) -> list[Check]:
    """Return the Checks of every frequency with a reference.

    study: the configuration of the stand-in tube.
    """
    return [
        *beam_checks(),
        *continuous_beam_checks(),
        *u_bend_checks(),
        *ring_checks(),
        *tube_checks(study),
    ]


def straight_tube(ends, elements, length=1.0, theory="euler_bernoulli", supports=()):
    """Return the Structure of a straight tube.

    ends: such as "clamped-free". supports: arc lengths in m of single contact points.
    """
    start, end = ends.split("-")
    return tube_path(
        [{"kind": "straight", "length_m": length}],
        (start, end),
        (elements, 1),
        theory,
        [
            {
                "name": f"at{number}",
                "at_m": (0.0, 0.0, place),
                "height_m": 0.001,
                "points": 1,
                "stiffness_N_per_m": 1.0,
                "gap_factor": 1.0,
                "centre_offset_m": (0.0, 0.0),
            }
            for number, place in enumerate(supports)
        ],
    )


def tube_path(segments, ends, elements, theory, supports=()):
    """Return the Structure of a tube along `segments`, from the origin in the direction of z.

    elements: (per span, per bend).
    """
    structure = {
        "kind": "path",
        "theory": theory,
        "section": SECTION,
        "material": MATERIAL,
        "start_m": (0.0, 0.0, 0.0),
        "start_direction": (0.0, 0.0, 1.0),
        "segments": segments,
        "start": {"kind": ends[0]},
        "end": {"kind": ends[1]},
        "mesh": {"elements_per_span": elements[0], "elements_per_bend": elements[1]},
    }
    return build_structure(StageSettings({"structure": structure, "supports": supports}))


def plane_frequencies(structure, to_Hz, stiffness=0.0):
    """Return [(mode,) Hz] of each uncoupled group, the one that moves along x first.

    stiffness: N/m, bilateral, of every contact point.
    """
    frequencies = []
    for group in uncoupled_groups(structure.mass, structure.stiffness, structure.contact_rows()):
        held = group.stiffness + stiffness * group.contact.T @ group.contact
        frequencies.append(eigenmodes(held, group.mass, to_Hz)[0] / (2.0 * np.pi))
    return frequencies


def bending_frequency(root, length):
    """Return Hz of an Euler-Bernoulli tube whose mode has beta L = root."""
    beam = section_beam(StageSettings(SECTION), StageSettings(MATERIAL), "euler_bernoulli")
    return (
        (np.asarray(root) / length) ** 2
        * np.sqrt(beam.planes[0].bending_stiffness / beam.mass_per_length)
        / (2.0 * np.pi)
    )


def beam_checks():
    """Return the Checks of straight beams by their ends, 40 elements."""
    checks = []
    for ends, roots in ROOTS.items():
        ours = plane_frequencies(straight_tube(ends, 40), 3000.0)[0]
        checks += [
            Check(
                "R10",
                f"{ends} beam, mode {mode + 1}",
                "Hz",
                bending_frequency(root, 1.0),
                "beta L, closed form",
                ours[mode],
                CLOSED_FORM_TOLERANCE,
            )
            for mode, root in enumerate(roots)
        ]
    return checks


def continuous_beam_roots(spans):
    """Return (mode,) beta L of the first group of modes of a beam on equally spaced pins.

    L is one span. Three-moment equation of a vibrating beam: M(i-1) s + 2 M(i) c + M(i+1) s = 0
    with c = coth b - cot b and s = csc b - csch b, solved by M(i) = sin(i j pi / spans):
    c + s cos(j pi / spans) = 0; and b = pi, where every support moment is zero.
    """

    def balance(b, order):
        return (
            1.0 / np.tanh(b)
            - 1.0 / np.tan(b)
            + (1.0 / np.sin(b) - 1.0 / np.sinh(b)) * np.cos(order * np.pi / spans)
        )

    return np.array(
        [
            np.pi,
            *sorted(
                optimize.brentq(
                    balance, np.pi + 1e-9, 2.0 * np.pi - 1e-9, args=(order,), xtol=1e-13
                )
                for order in range(1, spans)
            ),
        ]
    )


def continuous_beam_checks():
    """Return the Checks of tubes over two, three and four equal spans.

    The ends are pinned, the intermediate supports are stiff points.
    """
    checks = []
    for spans in (2, 3, 4):
        length = float(spans)
        tube = straight_tube(
            "pinned-pinned", 40, length, supports=[length * at / spans for at in range(1, spans)]
        )
        ours = plane_frequencies(tube, 400.0, RIGID_SUPPORT)[0]
        for mode, root in enumerate(continuous_beam_roots(spans)):
            checks.append(
                Check(
                    "R10",
                    f"beam over {spans} spans, mode {mode + 1}",
                    "Hz",
                    bending_frequency(root, 1.0),
                    "three-moment equation",
                    ours[mode],
                    CLOSED_FORM_TOLERANCE,
                )
            )
    return checks


def u_bend_checks():
    """Return the Checks of the published U-bend, clamped at both ends (code_aster validation)."""
    leg = {"kind": "straight", "length_m": 0.25043}
    bend = {"kind": "bend", "radius_m": 0.3955, "angle_deg": 180.0, "toward": (1.0, 0.0, 0.0)}
    checks = []
    for theory, published in U_BEND_HZ.items():
        ours = plane_frequencies(
            tube_path([leg, bend, leg], ("clamped", "clamped"), (20, 80), theory), 250.0
        )
        for plane, expected, found in zip(
            ("in plane", "out of plane"), published, ours, strict=False
        ):
            checks += [
                Check(
                    "R10",
                    f"U-bend, {theory}, {plane} {mode + 1}",
                    "Hz",
                    value,
                    "published U-bend",
                    found[mode],
                    PUBLISHED_TOLERANCE,
                )
                for mode, value in enumerate(expected)
            ]
    return checks


def ring_checks(count=60):
    """Return the Checks of the free ring (NAFEMS), of `count` straight elements.

    Its radius is 1 m, its solid section has a radius of 0.05 m.
    """
    bar = StageSettings({"kind": "round", "diameter_m": 0.1, "shear_coefficient": None})
    steel = StageSettings(
        {"young_modulus_Pa": 2.0e11, "poisson_ratio": 0.3, "density_kg_per_m3": 8000.0}
    )
    beam = section_beam(bar, steel, "euler_bernoulli")
    angle = 2.0 * np.pi * np.arange(count) / count
    nodes = np.stack([np.cos(angle), np.zeros(count), np.sin(angle)], axis=1)
    stiffness, mass = np.zeros((6 * count, 6 * count)), np.zeros((6 * count, 6 * count))
    for element in range(count):
        following = (element + 1) % count
        dofs = np.concatenate([6 * element + np.arange(6), 6 * following + np.arange(6)])
        one, other = element_matrices(beam, *element_geometry(nodes[element], nodes[following]))
        stiffness[np.ix_(dofs, dofs)] += one
        mass[np.ix_(dofs, dofs)] += other
    squares, shapes = linalg.eigh(stiffness, mass, subset_by_index=[0, 17])
    across = (
        (shapes[1::6] ** 2).sum(axis=0) > (shapes[0::6] ** 2 + shapes[2::6] ** 2).sum(axis=0)
    )[6:]
    frequency = np.sqrt(squares[6:]) / (2.0 * np.pi)  # after the six rigid motions
    return [
        Check(
            "R10",
            f"free ring, {plane} {mode + 1}",
            "Hz",
            value,
            "NAFEMS, thin theory",
            frequency[chosen][2 * mode],
            THIN_RING_TOLERANCE,
        )
        for plane, chosen in (("out of plane", across), ("in plane", ~across))
        for mode, value in enumerate(RING_HZ[plane])
    ]


def tube_checks(study):
    """Return the Checks of the stand-in tube on bilateral supports, from free to clamped."""
    checks = []
    for (theory, bend_elements, k), table in TUBE_HZ.items():
        mesh = study.structure.mesh.model_copy(update={"elements_per_bend": bend_elements})
        structure = study.structure.model_copy(update={"theory": theory, "mesh": mesh})
        tube = build_structure(study.model_copy(update={"structure": structure}))
        share = np.sqrt(np.repeat(tube.contact.weight, 2))
        by_plane = [list(found) for found in _on_springs(tube, k, share)]
        for mode, entry in enumerate(table.split()):
            ours = by_plane[0 if entry[-1] == "I" else 1].pop(0)
            checks.append(
                Check(
                    "testbed",
                    f"tube, {theory}, k = {k:g} N/m, mode {mode + 1}{entry[-1]}",
                    "Hz",
                    float(entry[:-1]),
                    "two independent codes",
                    ours,
                    TUBE_TOLERANCE,
                )
            )
    return checks


def _on_springs(tube, k, share):
    for group in uncoupled_groups(tube.mass, tube.stiffness, tube.contact_rows()):
        contact = share[group.contact_rows][:, None] * group.contact
        yield eigenmodes(group.stiffness + k * contact.T @ contact, group.mass, 400.0)[0] / (
            2.0 * np.pi
        )
