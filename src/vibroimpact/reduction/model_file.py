"""The netCDF file of a reduced model: one variable per field, SI units as in ModalModel."""

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.excitation.fluid_elastic import FluidLaws
from vibroimpact.io.records import read_record, write_record
from vibroimpact.structure.contact.laws import ContactLaws, LocalLaws

from .modal_model import ModalModel
from .model_variables import model_attributes

# Fields of the model that are tables themselves: field -> class.
LAWS: dict[str, type] = {
    "contact_laws": ContactLaws,
    "local_laws": LocalLaws,
    "fluid_laws": FluidLaws,
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
            data[item.name] = (dims, names, model_attributes(item.name))
        else:
            data[item.name] = _array_variable(item.name, value)
    attributes = {"title": "vibroimpact reduced model", **(attributes or {})}
    write_record(xr.Dataset(data, attrs=attributes), path)


def _array_variable(name, values):
    """Return (dimensions, values, attributes) of a variable whose dimensions are its own."""
    array = np.asarray(values)
    return tuple(f"{name}_{axis}" for axis in range(array.ndim)), array, model_attributes(name)


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
