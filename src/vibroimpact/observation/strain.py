"""Strain gauges among the sensors, and the motion that corresponds to a strain.

Sensors are compared with each other to see which of them a mode moves. A strain has another unit
than a displacement, and grows with another power of the frequency. In free bending of a beam the
largest strain is proportional to the largest velocity: strain = speed times the outer fibre's
distance times the root of mass per length over bending stiffness (F.V. Hunt, J. Acoust. Soc. Am. 32
(1960) 1123-1128).
"""

from dataclasses import dataclass, fields

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.structure.beam_elements import section_beam

STRAIN = "strain"


@dataclass(frozen=True, eq=False)
class GaugedModel(ModalModel):
    """A ModalModel with strain gauges among its sensors: gauges (sensor,) bool says which."""

    gauges: np.ndarray | None = None


def gauged_model(model: ModalModel, gauged: np.ndarray) -> GaugedModel:
    """Return the GaugedModel of a ModalModel; gauged (gauge,): indices of the strain gauges."""
    gauges = np.zeros(model.sensor_shapes.shape[1], bool)
    gauges[gauged] = True
    values = {one.name: getattr(model, one.name) for one in fields(model)}
    return GaugedModel(**(values | {"gauges": gauges}))


def gauges_of(model: ModalModel) -> np.ndarray:
    """Return (sensor,) bool: which sensors of a ModalModel measure a strain."""
    found = getattr(model, "gauges", None)
    return np.zeros(model.sensor_shapes.shape[1], bool) if found is None else found


def as_displacements(model: ModalModel) -> np.ndarray:
    """Return (mode, sensor): the shapes of the sensors of a ModalModel as displacements.

    Strains are divided by omega, as they go with a velocity, and scaled to the largest of the other
    sensors.
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


def by_family(values: np.ndarray, gauges: np.ndarray | None) -> np.ndarray:
    """Return (channel, ...): for each channel the largest of values (channel, ...) among channels
    that measure a strain or a motion, as it does.

    gauges (channel,) bool: which measure a strain; None for no channel.
    """
    if gauges is None or not gauges.any() or gauges.all():
        return np.broadcast_to(values.max(axis=0), values.shape)
    out = np.empty_like(values)
    for own in (gauges, ~gauges):
        out[own] = values[own].max(axis=0)
    return out


def speed_per_strain(structure: ConfigPart) -> float:
    """Return the speed in m/s per unit strain of a tube in free bending, the larger one of the two
    axes of its section; structure: section of a configuration.
    """
    beam = section_beam(structure.section, structure.material, structure.theory)
    return max(
        np.sqrt(plane.bending_stiffness / plane.mass_per_length) / plane.outer_fibre
        for plane in beam.planes
    )
