"""The rows of a model on which a fluid-elastic force acts: Gauss points along the tube, condensed.

On modes q, in a stretch of one velocity V and density rho, the force is -O (a0 V² q + ...) with the
overlap O = rho/2 int phi phi^T ds. Gauss points would be rows sqrt(weight) phi. The eigenvectors of
O, scaled by the resistance of each mode, give the fewest rows for the same error.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.centreline import Centreline
from vibroimpact.geometry.sections import outer_width
from vibroimpact.structure.beam_elements import GAUSS_POINTS, GAUSS_WEIGHTS
from vibroimpact.structure.tube import TubeStructure

from .fluid_elastic import FluidForce, fluid_force
from .turbulence import cut_at_nodes, directions, shapes_at

# The omitted part changes no squared frequency, with any support closed, by more than this share,
# and no damping ratio by more than half of it.
TOLERANCE = 1.0e-3


def fluid_fields(
    structure: TubeStructure, shapes: np.ndarray, omega: np.ndarray, config: ConfigPart
) -> dict[str, Any]:
    """Return the fields fluid_shapes (mode, fluid_row) and fluid_laws of a ModalModel; none if
    no flow acts.

    shapes: (dof, mode) in kg^-1/2.
    omega: (mode,) rad/s, ascending.
    config: parts flow and structure.section.
    """
    flow = config.flow
    if flow is None or flow.acting_m_per_s is None:
        return {}
    force = fluid_force(flow.coupling, outer_width(config.structure.section))
    rows: list[np.ndarray] = []
    velocities: list[float] = []
    for factor, overlap in _overlaps(structure, shapes, flow):
        velocity = factor * flow.acting_m_per_s
        found = independent_rows(overlap, resistance(force, velocity, omega))
        rows.append(found)
        velocities += [velocity] * found.shape[1]
    return {"fluid_shapes": np.hstack(rows), "fluid_laws": force.laws(np.array(velocities))}


def flow_stretches(line: Centreline, flow: ConfigPart) -> list[tuple[float, float, float, float]]:
    """Return [(begin, end in m, velocity factor, density)] of the arc lengths in the flow."""
    if not flow.stretches:
        return [(0.0, line.length, 1.0, flow.density_kg_per_m3)]
    found = []
    for number, own in enumerate(flow.stretches):
        begin, end = line.stretch(own.from_m, own.to_m, f"flow.stretches[{number}]")
        density = own.density_kg_per_m3
        density = flow.density_kg_per_m3 if density is None else density
        found.append((begin, end, own.velocity_factor, density))
    return found


def resistance(force: FluidForce, velocity: float, omega: np.ndarray) -> np.ndarray:
    """Return (mode,) omega² over the largest force per motion at a velocity in m/s: 1/m².

    omega: (mode,) rad/s; modes without stiffness count as the lowest one with it.
    """
    laws = force.laws(np.array([velocity]))
    omega = np.maximum(omega, omega[omega > 0.0].min(initial=np.inf))
    omega = np.where(np.isfinite(omega), omega, 1.0)
    held = abs(laws.stiffness[0]) + np.abs(laws.lag_stiffness).max(initial=0.0)
    return omega**2 / (held + abs(laws.damping[0]) * omega)


def independent_rows(overlap: np.ndarray, resistance: np.ndarray) -> np.ndarray:
    """Return rows (mode, row) whose products sum to an overlap (mode, mode).

    With r the resistance (mode,), the omitted rest is at most TOLERANCE sqrt(r_i r_j) in the sense
    of x^T rest x. Contact only stiffens, so that TOLERANCE holds with supports open and closed.
    Modes that the flow does not move have no part in any row.
    """
    moved = np.flatnonzero(np.diag(overlap) > 0.0)
    scale = np.sqrt(resistance[moved])
    values, vectors = np.linalg.eigh(overlap[np.ix_(moved, moved)] / np.outer(scale, scale))
    kept = values > TOLERANCE
    rows = np.zeros((len(overlap), np.count_nonzero(kept)))
    rows[moved] = scale[:, None] * vectors[:, kept] * np.sqrt(values[kept])
    return rows


def _overlaps(
    structure: TubeStructure, shapes: np.ndarray, flow: ConfigPart
) -> Iterator[tuple[float, np.ndarray]]:
    """Yield (velocity factor, overlap (mode, mode) in 1/m) of each direction and velocity."""
    line = structure.centreline
    acting = flow_stretches(line, flow)
    for across in directions(line, flow):
        for factor in sorted({own[2] for own in acting}):
            overlap = np.zeros((shapes.shape[1],) * 2)
            own = sorted(
                (begin, end, density) for begin, end, other, density in acting if other == factor
            )
            for begin, end, density in cut_at_nodes(own, structure.node_arc_length):
                # four points are exact for the squares of cubic shapes
                for point, weight in zip(GAUSS_POINTS, GAUSS_WEIGHTS, strict=True):
                    place = begin + (end - begin) * point
                    motion = across(place) @ shapes_at(structure, place, shapes)
                    share = 0.5 * density * weight * (end - begin)
                    overlap += share * np.outer(motion, motion)
            yield factor, overlap
