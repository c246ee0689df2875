"""Strains beside motions: which sensors measure one, and how large a motion goes with it.

Sensors are compared with each other to see which of them a mode moves. A strain has another unit
than a displacement, and grows with another power of the frequency. In a beam that bends freely a
strain goes with a velocity: strain = speed times the outer fibre's distance times the root of mass
per length over bending stiffness, wherever both are largest (F.V. Hunt, J. Acoust. Soc. Am. 32
(1960) 1123-1128).
"""

from dataclasses import dataclass, fields

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.structure.beam_elements import section_beam

STRAIN = "strain"


@dataclass(frozen=True, eq=False)
class GaugedModel(ModalModel):
    """A ModalModel some of whose sensors are strain gauges: gauges (sensor,) bool says which."""

    gauges: np.ndarray | None = None


def gauged_model(model, gauged):
    """Return the GaugedModel of a ModalModel some of whose sensors (gauge,), by their indices,
    measure a strain.
    """
    gauges = np.zeros(model.sensor_shapes.shape[1], bool)
    gauges[gauged] = True
    values = {one.name: getattr(model, one.name) for one in fields(model)}
    return GaugedModel(**(values | {"gauges": gauges}))


def gauges_of(model):
    """Return (sensor,) bool: which sensors of a ModalModel measure a strain."""
    found = getattr(model, "gauges", None)
    return np.zeros(model.sensor_shapes.shape[1], bool) if found is None else found


def as_displacements(model):
    """Return (mode, sensor): the shapes of a ModalModel's sensors as displacements, those of strain
    gauges by the speed that goes with them, brought to the size of the other sensors.
    """
    gauges = gauges_of(model)
    if not gauges.any():
        return model.sensor_shapes
    shapes = model.sensor_shapes.copy()
    strains = shapes[:, gauges] / np.maximum(model.omega, 1.0)[:, None]
    others = np.abs(shapes[:, ~gauges]).max(initial=0.0)
    largest = np.abs(strains).max()
    shapes[:, gauges] = strains * (others / largest if others > 0.0 and largest > 0.0 else 1.0)
    return shapes


def by_family(values, gauges):
    """Return (channel, ...): the largest of values (channel, ...) among the channels that measure
    the same as each does, a strain or a motion; gauges (channel,) bool, None for no strain.
    """
    if gauges is None or not gauges.any() or gauges.all():
        return np.broadcast_to(values.max(axis=0), values.shape)
    out = np.empty_like(values)
    for own in (gauges, ~gauges):
        out[own] = values[own].max(axis=0)
    return out


def speed_per_strain(structure):
    """Return m/s per unit strain in a tube that bends freely, of the axis of its section along
    which a strain takes most speed; structure: section of a configuration.
    """
    beam = section_beam(structure.section, structure.material, structure.theory)
    return max(
        np.sqrt(plane.bending_stiffness / plane.mass_per_length) / plane.outer_fibre
        for plane in beam.planes
    )
