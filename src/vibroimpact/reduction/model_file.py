"""The netCDF file of a reduced model: one variable per field, its unit and name as stated here."""

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.excitation.fluid_elastic import FluidLaws
from vibroimpact.io.records import read_record, write_record
from vibroimpact.structure.contact.laws import ContactLaws, LocalLaws

from .modal_model import ModalModel

# Fields of the model that are tables themselves: field -> class.
LAWS: dict[str, type] = {
    "contact_laws": ContactLaws,
    "local_laws": LocalLaws,
    "fluid_laws": FluidLaws,
}

# UDUNITS has no fractional powers, so a unit with one stands in a comment.
PER_ROOT_KG = "in kg^-1/2: displacement in m per modal amplitude in kg^1/2 m"

# name: (units, None if UDUNITS can not write it; long name; comment)
MODEL_VARIABLES: dict[str, tuple[str | None, str, str]] = {
    "omega": ("rad s-1", "angular frequency of the mode", ""),
    "damping": ("s-1", "damping of the mode: 2 x damping ratio x angular frequency", ""),
    "full_mode_frequencies": ("Hz", "natural frequency of the full model without contact", ""),
    "initial_displacement": (None, "modal amplitude at the start", "in kg^1/2 m"),
    "initial_velocity": (None, "rate of the modal amplitude at the start", "in kg^1/2 m/s"),
    "initial_residual": (
        "1",
        "part of the initial displacement and velocity that the modes do not represent",
        "",
    ),
    "preload": ("N", "force at rest of each flat land of the point", ""),
    "constant_force": (None, "constant force on the mode", "in kg^-1/2 N"),
    "contact_shapes": (None, "mode shape at the contact point", PER_ROOT_KG),
    "contact_directions": ("1", "unit vector of the direction in which the contact acts", ""),
    "contact_weight": ("1", "share of the support's stiffness", ""),
    "support_of_point": ("1", "number of the support, from 0", ""),
    "contact_stiffness": ("N m-1", "contact stiffness of the point", ""),
    "gap_factor": ("1", "factor of the case's gap", ""),
    "centre_offset": ("m", "offset of the obstacle's centre along the contact direction", ""),
    "contact_position": ("m", "position of the contact point", ""),
    "element_shapes": (None, "mode shape along the local element", PER_ROOT_KG),
    "drive_shapes": (None, "mode shape along the drive force", PER_ROOT_KG),
    "sensor_shapes": (None, "mode shape along the sensor", PER_ROOT_KG),
    "sensor_positions": ("m", "position of the sensor", ""),
    "sensor_directions": ("1", "unit vector along the sensor", ""),
    "line_shapes": (None, "mode shape at the point of the shape line", PER_ROOT_KG),
    "line_positions": ("m", "position of the point of the shape line", ""),
    "line_arc_length": ("m", "arc length of the point of the shape line", ""),
    "stress_shapes": (
        None,
        "outer-fibre stress of a bending moment in the mode",
        "in kg^-1/2 Pa/m: stress in Pa per modal amplitude in kg^1/2 m",
    ),
    "contact_laws_gap": ("m", "radial gap of the point, NaN for the case's gap", ""),
    "contact_laws_damping": ("N s m-1", "Kelvin-Voigt damping of the contact", ""),
    "contact_laws_hunt_crossley": ("s m-1", "Hunt-Crossley damping of the contact", ""),
    "contact_laws_hertz": (None, "coefficient of the Hertzian contact", "in N/m^1.5"),
    "contact_laws_friction": ("1", "Coulomb friction coefficient", ""),
    "contact_laws_stick_stiffness": ("N m-1", "stiffness of the stick spring of friction", ""),
    "contact_laws_lobes": ("1", "number of lobes of the hole, 0 for a circle", ""),
    "contact_laws_lobe_depth": ("m", "largest minus smallest radial gap of a lobed hole", ""),
    "contact_laws_lobe_angle": ("rad", "direction of the first land of a lobed hole", ""),
    "contact_laws_land_point": ("1", "contact point of the flat land, from 0", ""),
    "contact_laws_land_normal": ("1", "unit vector from the hole's centre to the flat land", ""),
    "contact_laws_land_extra_gap": ("m", "distance of the flat land beyond the gap", ""),
    "local_laws_stiffness": ("N m-1", "linear stiffness of the local element", ""),
    "local_laws_quadratic": ("N m-2", "quadratic stiffness of the local element", ""),
    "local_laws_cubic": ("N m-3", "cubic stiffness of the local element", ""),
    "local_laws_damping": ("N s m-1", "damping of the local element", ""),
    "local_laws_damping_limit": ("N", "largest force of the damper, 0 for no limit", ""),
    "local_laws_drag": ("N s2 m-2", "quadratic drag of the local element", ""),
    "local_laws_stick_stiffness": ("N m-1", "stiffness of the slider while it sticks", ""),
    "local_laws_slip_limit": ("N", "force at which the slider slips, 0 for no slider", ""),
    "local_laws_saturation_stiffness": ("N m-1", "stiffness of the saturating spring", ""),
    "local_laws_saturation_limit": ("N", "largest force of the saturating spring", ""),
    "local_laws_drag_partner": (
        "1",
        "local element whose rate counts in the speed of the drag, -1 for none",
        "",
    ),
    "fluid_shapes": (
        None,
        "motion of a row of the fluid-elastic force in the mode",
        "in m^-1/2: rows that sum to half the density times the overlap of the shapes",
    ),
    "fluid_laws_velocity": ("m s-1", "velocity of the flow at the row", ""),
    "fluid_laws_stiffness": ("m2 s-2", "fluid-elastic stiffness of the row", ""),
    "fluid_laws_damping": ("m2 s-1", "fluid-elastic damping of the row", ""),
    "fluid_laws_lag_stiffness": ("m2 s-2", "force of the row per lag", ""),
    "fluid_laws_lag_rate": ("s-1", "rate of the lag", ""),
    "support_names": (None, "name of the support", ""),
    "sensor_names": (None, "name of the sensor: point and axis", ""),
    "section_names": (None, "name of the section whose stress is recorded", ""),
    "element_names": (None, "name of the local element", ""),
}


def write_model(
    model: ModalModel, path: str | Path, attributes: dict[str, Any] | None = None
) -> None:
    """Write a reduced model; attributes: global attributes of the file."""
    data = {}
    for item in fields(ModalModel):
        value = getattr(model, item.name)
        if item.name in LAWS:
            for column in fields(value):
                name = f"{item.name}_{column.name}"
                data[name] = _array_variable(name, getattr(value, column.name))
        elif item.name.endswith("_names"):
            names = np.array(value, dtype=object if value else str)
            dims = (item.name.removesuffix("_names"),)
            data[item.name] = (dims, names, _attributes(item.name))
        else:
            data[item.name] = _array_variable(item.name, value)
    attributes = {"title": "vibroimpact reduced model", **(attributes or {})}
    write_record(xr.Dataset(data, attrs=attributes), path)


def _attributes(name: str) -> dict[str, str]:
    """Return {units, long_name, comment} of a variable of a model file, those that it has."""
    texts = zip(("units", "long_name", "comment"), MODEL_VARIABLES.get(name, ()), strict=False)
    return {key: text for key, text in texts if text}


def _array_variable(name, values):
    """Return (dimensions, values, attributes) of a variable whose dimensions are its own."""
    array = np.asarray(values)
    return tuple(f"{name}_{axis}" for axis in range(array.ndim)), array, _attributes(name)


def read_model(path: str | Path) -> ModalModel:
    """Return the reduced model of a file of write_model.

    Raises RecordError, and ValueError when a field is missing.
    """
    dataset = read_record(path)
    values = {}
    for item in fields(ModalModel):
        names = [item.name]
        if item.name in LAWS:
            names = [f"{item.name}_{column.name}" for column in fields(LAWS[item.name])]
        for name in names:
            if name not in dataset:
                raise ValueError(
                    f"{path}: has no '{name}': it was written by another version, delete it and run"
                    " again"
                )
        if item.name in LAWS:
            values[item.name] = LAWS[item.name](*(dataset[name].values for name in names))
            continue
        value = dataset[item.name].values
        is_names = item.name.endswith("_names")
        values[item.name] = tuple(str(name) for name in value) if is_names else value
    return ModalModel(**values)
