"""Frequencies of the study's tube against OpenSees (beams) and CalculiX (a solid pipe).

OpenSees has the same nodes.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy import sparse

from evidence.validation.check import Check
from evidence.validation.reference.frequencies import plane_frequencies
from vibroimpact.config.reading import changed_config
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.reduction.ritz_basis import eigenmodes, uncoupled_groups
from vibroimpact.structure.beam_elements import element_matrices
from vibroimpact.structure.tube import build_structure, element_geometry

from .calculix import karman_factor, straight_tube_frequencies, u_tube_frequencies
from .opensees import opensees_frequencies

THEORIES = ("euler_bernoulli", "timoshenko")
STIFFNESS = tuple(10.0**power for power in range(10))  # N/m per support
SOLID_STIFFNESS = (1.0, 4.0e6, 1.0e9)
MODES, SOLID_MODES = 9, 7
REFINED = 4  # elements of OpenSees per element of ours
TO_HZ = 2000.0
# Same elements on the same nodes: the difference is the round-off of two eigenvalue solvers, with
# elements of 7.5 mm in 2.3 m of tube.
SAME_MESH = 1.0e-8
# Finer mesh: the bend's chords are shorter than its arc by (angle of an element)² / 24 = 6.4e-5,
# and a frequency changes by twice as much.
MESH_SAFETY = 3.0
# Solid against beam: a clamped solid end also restrains Poisson's contraction, which makes a
# straight tube 0.11 to 0.15 % stiffer. Without Poisson's ratio only the mesh of bricks is left
# (1e-4).
SOLID, SOLID_WITHOUT_POISSON = 2.0e-3, 3.0e-4
# Shear coefficient of a thin tube by Poisson's ratio, 2 (1 + nu) / (4 + 3 nu) (Cowper).
COWPER = {0.0: 0.5, 0.3: 0.53}
STRAIGHT_M = 1.0


def opensees_checks(config, stiffness=STIFFNESS) -> list[Check]:
    """Return the Checks of both beam theories on bilateral supports, one row per stiffness.

    The error is the largest over the first modes. Raises JudgeAbsent.
    """
    checks = []
    for theory in THEORIES:
        tube: Any = changed_config(config, {"structure.theory": theory})
        for k in stiffness:
            checks.append(
                _largest(
                    f"tube, {theory}, k = {k:g} N/m",
                    "OpenSees, same nodes",
                    opensees_frequencies(tube, k, MODES),
                    beam_frequencies(tube, k)[:MODES],
                    SAME_MESH,
                )
            )
        angle = np.pi / tube.structure.mesh.elements_per_bend
        checks.append(
            _largest(
                f"tube, {theory}, k = 4e6 N/m, finer mesh",
                f"OpenSees, {REFINED} elements for each of ours",
                opensees_frequencies(changed_config(tube, _refined(tube)), 4.0e6, MODES),
                beam_frequencies(tube, 4.0e6)[:MODES],
                MESH_SAFETY * 2.0 * angle**2 / 24.0,
            )
        )
    return checks


def _refined(config):
    mesh = config.structure.mesh
    return {
        "structure.mesh.elements_per_span": REFINED * mesh.elements_per_span,
        "structure.mesh.elements_per_bend": REFINED * mesh.elements_per_bend,
    }


def calculix_checks(config, stiffness=SOLID_STIFFNESS) -> list[Check]:
    """Return the Checks against the solid pipe.

    A straight tube is compared with a beam, the U-tube with a beam whose bend is softer by Karman's
    factor. Raises JudgeAbsent.
    """
    tube, checks = changed_config(config, {"structure.theory": "timoshenko"}), []
    for poisson, tolerance in ((0.3, SOLID), (0.0, SOLID_WITHOUT_POISSON)):
        metal = changed_config(
            tube,
            {
                "structure.material.poisson_ratio": poisson,
                "structure.section.shear_coefficient": COWPER[poisson],
            },
        )
        solid, ours = (
            straight_tube_frequencies(metal, STRAIGHT_M, 6)[::2],
            _straight_beam(metal.structure),
        )  # solid: two planes alike
        checks += [
            Check(
                "judge CalculiX",
                f"straight clamped tube, nu = {poisson:g}, mode {mode + 1}",
                "Hz",
                solid[mode],
                "CalculiX, solid pipe",
                ours[mode],
                tolerance,
            )
            for mode in range(3)
        ]
    for k in stiffness:
        solid = u_tube_frequencies(tube, k, SOLID_MODES)
        oval = beam_frequencies(tube, k, karman_factor(tube.structure))
        checks += [
            Check(
                "judge CalculiX",
                f"tube with Karman's bend, k = {k:g} N/m, mode {mode + 1}",
                "Hz",
                solid[mode],
                "CalculiX, solid pipe",
                oval[mode],
                SOLID,
            )
            for mode in range(SOLID_MODES)
        ]
    return checks


def _straight_beam(structure):
    """Return (mode,) Hz of our straight clamped beam of STRAIGHT_M.

    structure: gives section and material.
    """
    clamped = {"kind": "clamped"}
    path = {
        "kind": "path",
        "theory": "timoshenko",
        "section": structure.section.model_dump(),
        "material": structure.material.model_dump(),
        "start_m": (0.0, 0.0, 0.0),
        "start_direction": (0.0, 0.0, 1.0),
        "segments": [{"kind": "straight", "length_m": STRAIGHT_M}],
        "start": clamped,
        "end": clamped,
        "mesh": {"elements_per_span": 40, "elements_per_bend": 1},
    }
    return plane_frequencies(
        build_structure(StageSettings({"structure": path, "supports": ()})), TO_HZ
    )[0]


def oval_bend_rows(config, stiffness=SOLID_STIFFNESS):
    """Return rows (dict) of the frequencies of the study's beam with and without Karman's bend.

    They show what the beam leaves out; no other code is needed.
    """
    rows = []
    for k in stiffness:
        beam = beam_frequencies(config, k)
        oval = beam_frequencies(config, k, karman_factor(config.structure))
        rows += [
            {
                "stiffness_N_per_m": k,
                "mode": mode + 1,
                "beam_Hz": beam[mode],
                "oval_bend_Hz": oval[mode],
                "relative_change": oval[mode] / beam[mode] - 1.0,
            }
            for mode in range(SOLID_MODES)
        ]
    return rows


def beam_frequencies(config, stiffness, bend_softer=1.0):
    """Return (mode,) Hz up to 2 kHz of the project's finite-element tube.

    stiffness: N/m per support. bend_softer: divides E I of the bend.
    """
    tube = build_structure(config)
    own = (
        tube.stiffness
        if bend_softer == 1.0
        else tube.stiffness + _softer_bend(tube, config.structure, bend_softer)
    )
    share = np.sqrt(np.repeat(tube.contact.weight, 2))
    found = []
    for group in uncoupled_groups(tube.mass, own, tube.contact_rows()):
        held = share[group.contact_rows][:, None] * group.contact
        found.append(
            eigenmodes(group.stiffness + stiffness * held.T @ held, group.mass, TO_HZ)[0]
            / (2.0 * np.pi)
        )
    return np.sort(np.concatenate(found))


def _softer_bend(tube, structure, factor):
    """Return the change (dof, dof) of the stiffness when E I of the bend is divided by `factor`."""
    plane = tube.beam.planes[0]  # a round tube bends alike in both planes
    softer = replace(plane, bending_stiffness=plane.bending_stiffness / factor)
    soft = replace(tube.beam, planes=(softer, softer))
    begin, end = structure.leg_length_m, tube.centreline.length - structure.leg_length_m
    middle = 0.5 * (tube.node_arc_length[1:] + tube.node_arc_length[:-1])
    change = sparse.lil_array((tube.transformation.shape[0],) * 2)
    for element in np.flatnonzero((middle > begin) & (middle < end)):
        length, axes = element_geometry(tube.nodes[element], tube.nodes[element + 1])
        dofs = np.ix_(range(6 * element, 6 * element + 12), range(6 * element, 6 * element + 12))
        change[dofs] += (
            element_matrices(soft, length, axes)[0] - element_matrices(tube.beam, length, axes)[0]
        )
    return (tube.transformation.T @ change.tocsr() @ tube.transformation).tocsr()


def _largest(name, source, reference, ours, tolerance):
    """Return one Check of the mode whose frequency differs most."""
    mode = int(np.argmax(np.abs(ours / reference - 1.0)))
    return Check(
        "judge OpenSees",
        f"{name}: worst of {len(reference)} modes, {mode + 1}",
        "Hz",
        reference[mode],
        source,
        ours[mode],
        tolerance,
    )
