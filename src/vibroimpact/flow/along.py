"""A tube in a flow: its reduced model, its motion along the fluid-elastic force, velocity and mass,
at Gauss points along it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.config.flow import Flow
from vibroimpact.config.schema import Config, Sensors
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.excitation.fluid_rows import flow_stretches
from vibroimpact.excitation.turbulence import directions
from vibroimpact.geometry.centreline import SAME_PLACE_M, Centreline, build_centreline
from vibroimpact.geometry.sections import outer_width
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.structure.beam_elements import section_beam
from vibroimpact.structure.fluid import beam_in_fluid, fluid_stretches

from .coupled import Zone
from .critical_velocity import Along

CELLS = 80  # along a tube, of three Gauss points each: ten modes to 1e-6
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(3)
POINTS, WEIGHTS = 0.5 * (POINTS + 1.0), 0.5 * WEIGHTS
ALONG, ACROSS = "along the force", "across the force"  # names of the two directions


@dataclass(frozen=True, eq=False)
class TubeInFlow:
    """A tube in a flow.

    model: its ModalModel without contact. diameter: m. along: velocity, density and mass along it.
    shapes {direction: (mode, place)}: motion per modal amplitude along the fluid-elastic force.
    """

    model: ModalModel
    diameter: float
    along: Along
    shapes: dict[str, np.ndarray]

    def zones(self) -> list[Zone]:
        """Return the Zones of one velocity and density, on the modes of the model."""
        flow = self.along
        pairs = np.stack([flow.factor, flow.density])
        zones = []
        for factor, density in np.unique(pairs[:, flow.factor > 0.0], axis=1).T:
            here = (flow.factor == factor) & (flow.density == density)
            overlap = sum(
                (shape[:, here] * flow.weight[here]) @ shape[:, here].T
                for shape in self.shapes.values()
            )
            zones.append(Zone(float(factor), 0.5 * density * overlap))
        return zones


def tube_in_flow(config: Config, flow: Flow) -> TubeInFlow:
    """Return the TubeInFlow of a configuration of a tube and its section `flow`."""
    line = build_centreline(config.structure)
    acting = flow_stretches(line, flow)
    places, weight = _gauss([end for begin, last, *_ in acting for end in (begin, last)], line)
    factor, density = np.zeros(len(places)), np.full(len(places), flow.density_kg_per_m3)
    for begin, end, own_factor, own_density in acting:
        here = (places >= begin) & (places <= end)
        factor[here], density[here] = own_factor, own_density
    model, motion = _motion(config, line, places)
    ways = directions(line, flow)
    along = {
        name: np.einsum("mpa,pa->mp", motion, np.array([way(place) for place in places]))
        for name, way in zip((ALONG, ACROSS), ways, strict=False)
    }
    structure: ConfigPart = config.structure
    beam = section_beam(structure.section, structure.material, structure.theory)
    stretches = fluid_stretches(structure, line)
    beams = [beam_in_fluid(beam, stretches, place) for place in places]
    mass = [np.mean([plane.mass_per_length for plane in own.planes]) for own in beams]
    flowing = Along(weight, line.length, factor, density, np.array(mass))
    return TubeInFlow(model, outer_width(structure.section), flowing, along)


def _gauss(cuts: Sequence[float], line: Centreline) -> tuple[np.ndarray, np.ndarray]:
    """Return (places, weights), each (place,) in m, of cells that are cut at given places."""
    ends = np.unique([*np.linspace(0.0, line.length, CELLS + 1), *cuts])
    ends = ends[np.concatenate([[True], np.diff(ends) > SAME_PLACE_M])]
    size = np.diff(ends)[:, None]
    return (ends[:-1, None] + size * POINTS).ravel(), (size * WEIGHTS).ravel()


def _motion(config: Config, line: Centreline, places: np.ndarray) -> tuple[ModalModel, np.ndarray]:
    """Return (ModalModel, (mode, place, 3) motion in global axes at places (place,) in m)."""
    points = {
        f"place_{number}": tuple(map(float, line.position(place)))
        for number, place in enumerate(places)
    }
    sensors = Sensors(points=tuple(points), directions=("x", "y", "z"))
    changed = {
        "points": {**config.points, **points},
        "record": config.record.model_copy(update={"sensors": sensors}),
    }
    model = build_model(config.model_copy(update=changed), motion_only=True)
    return model, model.sensor_shapes.reshape(model.modes, len(places), 3)
