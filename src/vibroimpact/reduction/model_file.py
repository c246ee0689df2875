"""The file of a reduced model: one variable per field, SI units as in ModalModel."""

from dataclasses import fields

import numpy as np
import xarray as xr

from vibroimpact.contact.laws import ContactLaws, LocalLaws
from vibroimpact.records import read_record, write_record

from .modal_model import ModalModel

# Fields of the model that are tables themselves.
LAWS = {"contact_laws": ContactLaws, "local_laws": LocalLaws}


def write_model(model: ModalModel, path, attributes: dict | None = None) -> None:
    """Write a reduced model as netCDF: one variable per field, SI units as in ModalModel."""
    data = {}
    for item in fields(ModalModel):
        value = getattr(model, item.name)
        if item.name in LAWS:
            for column in fields(value):
                array = np.asarray(getattr(value, column.name))
                data[f"{item.name}_{column.name}"] = (
                    tuple(f"{item.name}_{column.name}_{axis}" for axis in range(array.ndim)),
                    array,
                )
        elif item.name.endswith("_names"):
            data[item.name] = (
                (f"{item.name[:-6]}",),
                np.array(value, dtype=object if value else str),
            )
        else:
            data[item.name] = (
                tuple(f"{item.name}_{axis}" for axis in range(np.ndim(value))),
                np.asarray(value),
            )
    write_record(
        xr.Dataset(data, attrs={"title": "vibroimpact reduced model", **(attributes or {})}), path
    )


def read_model(path) -> ModalModel:
    """The reduced model of a file written by write_model. Raises RecordError, and ValueError when a
    field is missing.
    """
    dataset = read_record(path)
    values = {}
    for item in fields(ModalModel):
        names = (
            [f"{item.name}_{column.name}" for column in fields(LAWS[item.name])]
            if item.name in LAWS
            else [item.name]
        )
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
        values[item.name] = (
            tuple(str(name) for name in value) if item.name.endswith("_names") else value
        )
    return ModalModel(**values)
