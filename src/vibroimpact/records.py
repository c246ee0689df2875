"""All netCDF and table reading and writing: one place, one declaration of every variable of a record."""

import csv
import os
from dataclasses import fields
from datetime import UTC, datetime
from pathlib import Path

import netCDF4
import numpy as np
import xarray as xr

from .laws import ContactLaws, LocalLaws
from .model import ModalModel

# name: (dimensions, dtype, units, long name)
VARIABLES = {
    "displacement": (("sensor", "time"), "f4", "m", "displacement"),
    "acceleration": (("sensor", "time"), "f4", "m s-2", "acceleration"),
    "line_displacement": (("line_point", "time"), "f4", "m", "displacement along the shape line"),
    "support_force": (("support", "direction", "time"), "f4", "N", "force of the structure on the support"),
    "force": (("time",), "f4", "N", "drive force"),
    "stress_rms": (("section",), "f8", "Pa", "RMS of the outer-fibre bending stress, every fifth step, unfiltered"),
    "stress_peak": (("section",), "f8", "Pa", "largest outer-fibre bending stress, every fifth step"),
    "stress_flag": ((), "i1", "1", "1 when the peak stress exceeds record.stress_limit_Pa"),
    "contact_fraction": (("support",), "f8", "1", "fraction of time in contact"),
    "impact_count": (("support",), "i4", "1", "number of contacts begun"),
    "impact_rate": (("support",), "f8", "s-1", "contacts begun per unit time"),
    "peak_force": (("support",), "f8", "N", "largest resultant support force"),
    "rms_force": (("support",), "f8", "N", "RMS of the resultant support force"),
    "mean_impulse": (("support",), "f8", "N s", "mean impulse of a contact"),
    "impact_velocity_rms": (("support",), "f8", "m s-1", "RMS radial velocity at the begin of a contact"),
    "impact_velocity_max": (("support",), "f8", "m s-1", "largest radial velocity at the begin of a contact"),
    "wear_work_rate": (("support",), "f8", "W", "normal force times sliding speed, mean over time"),
    "force_displacement": (("contact_point", "direction"), "f8", "N m", "mean of restoring force times displacement"),
    "displacement_square": (("contact_point", "direction"), "f8", "m2", "mean square displacement"),
    "energy": (("energy_term", "energy_time"), "f8", "J", "energies since the start of the simulation"),
    "energy_residual": ((), "f8", "1", "energy identity of the scheme, relative to the input work"),
    "potential_energy_residual": ((), "f8", "1", "energy balance with the contact's potential energy, relative to the input work"),
    "contact_dissipation": ((), "f8", "J", "energy that contacts and elements took beyond what their springs hold"),
    "element_displacement_square": (("element",), "f8", "m2", "mean square displacement of a local element"),
    "element_force_displacement": (("element",), "f8", "N m", "mean of the element's restoring force times displacement"),
    "element_power": (("element",), "f8", "W", "mean power that an element takes"),
    "slip_power": (("element",), "f8", "W", "mean of slider force times slip speed"),
    "contact_displacement": (("contact_point", "direction", "step"), "f8", "m", "displacement at every step"),
    "contact_force": (("contact_point", "direction", "step"), "f8", "N", "force on the structure at every step"),
    "element_displacement": (("element", "step"), "f8", "m", "displacement of a local element at every step"),
    "element_force": (("element", "step"), "f8", "N", "force of an element on the structure at every step"),
    "run_energy": (("run_term",), "f8", "J", "energies of the whole run"),
    "sliding_work": (("support",), "f8", "J", "normal force times slip over the whole run"),
    "slip_work": (("element",), "f8", "J", "slider force times slip over the whole run"),
    "fixed_point_residual": ((), "f8", "1", "bound of the relative error of the implicit contact forces, worst step"),
}
COORDINATES = {
    "time": (("time",), "s"),
    "sensor": (("sensor",), None),
    "line_arc_length": (("line_point",), "m"),
    "support": (("support",), None),
    "section": (("section",), None),
    "element": (("element",), None),
    "step_time": (("step",), "s"),
    "run_term": (("run_term",), None),
    "energy_term": (("energy_term",), None),
    "energy_time": (("energy_time",), "s"),
}


class RecordError(Exception):
    """A file that can not be read or written; the message names it."""


LAWS = {"contact_laws": ContactLaws, "local_laws": LocalLaws}  # fields of the model that are tables themselves


def describe(values: dict, coordinates: dict, attributes: dict) -> xr.Dataset:
    """A dataset of declared variables with their dimensions, units and names. Raises KeyError for an undeclared one."""
    data = {}
    for name, value in values.items():
        dims, dtype, units, long_name = VARIABLES[name]
        data[name] = (dims, np.asarray(value, dtype), {"units": units, "long_name": long_name})
    coords = {name: (COORDINATES[name][0], value, {"units": COORDINATES[name][1]} if COORDINATES[name][1] else {})
              for name, value in coordinates.items()}  # fmt: skip
    return xr.Dataset(data, coords, attributes)


def split_record(record: xr.Dataset) -> tuple[xr.Dataset, xr.Dataset]:
    """(statistics and energies, time series) of a record; both keep the attributes."""
    series = [name for name, variable in record.data_vars.items() if {"time", "step"} & set(variable.dims)]
    return record.drop_vars(series).drop_dims(["time", "step"], errors="ignore"), record[series]


def write_record(dataset: xr.Dataset, path) -> None:
    """Write a dataset of numbers and texts as netCDF-4: to a temporary name in the same folder, then renamed, so no half-written file is left.

    float32 time series are stored as they are: their noise does not compress, and deflating it costs more than the simulation.
    Written without Dataset.to_netcdf, which takes twice as long for files of many small variables. Raises TypeError for other contents.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    attributes = {"title": "vibroimpact record", **dataset.attrs, "Conventions": "CF-1.11",
                  "history": f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ} written by vibroimpact"}  # fmt: skip
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with netCDF4.Dataset(temporary, "w", format="NETCDF4") as file:
            file.set_fill_off()
            for name, size in dataset.sizes.items():
                file.createDimension(name, size)
            unnamed = _put_variables(file, dataset)
            file.setncatts(attributes | ({"coordinates": " ".join(unnamed)} if unnamed else {}))
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def _put_variables(file, dataset) -> list[str]:
    """Write the variables; return the coordinates off the dimensions that no variable could name in its attributes."""
    beside = {name: set(dataset[name].dims) for name in dataset.coords if name not in dataset.sizes}
    named = set()
    for name, variable in dataset.variables.items():
        values, attributes = variable.values, dict(variable.attrs)
        text = values.dtype.kind in "UO" and all(isinstance(value, str) for value in values.flat)
        if not text and values.dtype.kind not in "fiu":
            raise TypeError(f"'{name}' holds {values.dtype}: numbers and texts alone are written")
        mine = [] if name in dataset.coords else [other for other, dims in beside.items() if dims <= set(variable.dims)]
        if mine:
            attributes["coordinates"] = " ".join(mine)
            named.update(mine)
        stored = file.createVariable(name, str if text else values.dtype, variable.dims)
        stored.setncatts(attributes)
        stored.set_auto_maskandscale(False)
        if values.size:
            stored[...] = values.astype(object) if text else values
    return [name for name in beside if name not in named]


def read_record(path, names=None) -> xr.Dataset:
    """The dataset of a file of write_record, loaded, file closed; names: the variables wanted, all where left out.

    Raises RecordError when there is no such file or it is not netCDF, KeyError when a variable is missing.
    """
    try:
        with netCDF4.Dataset(path) as file:
            file.set_auto_maskandscale(False)
            beside = set(getattr(file, "coordinates", "").split())
            data = {}
            for name in file.variables if names is None else names:
                data[name], others = _variable(file.variables[name])
                beside.update(others)
            if names is not None:
                coordinates = {*beside, *(dim for variable in data.values() for dim in variable.dims)} & set(file.variables)
                data.update({name: _variable(file.variables[name])[0] for name in coordinates - set(data)})
            attributes = {name: file.getncattr(name) for name in file.ncattrs() if name != "coordinates"}
    except OSError as error:
        raise RecordError(f"{path}: can not be read as netCDF ({error}): delete it and run again") from error
    sizes = {dim for variable in data.values() for dim in variable.dims}
    coords = {name: data.pop(name) for name in list(data) if name in beside | sizes}
    return xr.Dataset(data, coords, attributes)


def _variable(stored):
    """(variable, names of its coordinates off the dimensions) of a netCDF variable."""
    attributes = {name: stored.getncattr(name) for name in stored.ncattrs()}
    beside = attributes.pop("coordinates", "").split()
    return xr.Variable(stored.dimensions, stored[...], attributes, fastpath=True), beside


def read_dataset(path) -> xr.Dataset:
    """The dataset of a netCDF file of any origin, decoded by the CF conventions, loaded, file closed. Raises RecordError."""
    try:
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            return dataset.load()
    except OSError as error:
        raise RecordError(f"{path}: can not be read as netCDF ({error}): delete it and run again") from error


def read_variable(path) -> tuple[dict[str, np.ndarray], dict]:
    """Every numeric variable of a netCDF file by name, and its global attributes (for files of any origin)."""
    try:
        with netCDF4.Dataset(path) as file:
            known = {name: np.ma.filled(variable[:], np.nan) for name, variable in file.variables.items()
                     if variable.dtype != str and variable.dtype.kind in "fiu"}  # fmt: skip
            return known, {name: file.getncattr(name) for name in file.ncattrs()}
    except OSError as error:
        raise RecordError(f"{path}: can not be read as netCDF ({error})") from error


def write_model(model: ModalModel, path, attributes: dict | None = None) -> None:
    """Write a reduced model as netCDF: one variable per field, SI units as in ModalModel."""
    data = {}
    for item in fields(ModalModel):
        value = getattr(model, item.name)
        if item.name in LAWS:
            for column in fields(value):
                array = np.asarray(getattr(value, column.name))
                data[f"{item.name}_{column.name}"] = (tuple(f"{item.name}_{column.name}_{axis}" for axis in range(array.ndim)), array)
        elif item.name.endswith("_names"):
            data[item.name] = ((f"{item.name[:-6]}",), np.array(value, dtype=object if value else str))
        else:
            data[item.name] = (tuple(f"{item.name}_{axis}" for axis in range(np.ndim(value))), np.asarray(value))
    write_record(xr.Dataset(data, attrs={"title": "vibroimpact reduced model", **(attributes or {})}), path)


def read_model(path) -> ModalModel:
    """The reduced model of a file written by write_model. Raises RecordError, and ValueError when a field is missing."""
    dataset = read_record(path)
    values = {}
    for item in fields(ModalModel):
        names = [f"{item.name}_{column.name}" for column in fields(LAWS[item.name])] if item.name in LAWS else [item.name]
        for name in names:
            if name not in dataset:
                raise ValueError(f"{path}: has no '{name}': it was written by another version, delete it and run again")
        if item.name in LAWS:
            values[item.name] = LAWS[item.name](*(dataset[name].values for name in names))
            continue
        value = dataset[item.name].values
        values[item.name] = tuple(str(name) for name in value) if item.name.endswith("_names") else value
    return ModalModel(**values)


def write_table(rows: list[dict], path, columns: tuple[str, ...] = ()) -> None:
    """Write rows (all with the same keys) as CSV: floats in full precision, NaN as 'nan'. Atomic like write_record.

    columns: the header of a table that may have no rows.
    """
    columns = tuple(rows[0]) if rows else tuple(columns)
    write_cells(columns, ([_plain(row[column]) for column in columns] for row in rows), path)


def write_cells(columns, rows, path) -> None:
    """Write rows of plain Python values (columns,) under a header as CSV. Atomic like write_record."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with open(temporary, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            writer.writerows(rows)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def write_text(text: str, path) -> None:
    """Write a text file, atomic like write_record."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, path)


def read_table(path) -> list[dict]:
    """Rows of a CSV table; what reads as a number is one. Raises RecordError when there is no such file."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            return [{key: _number(value) for key, value in row.items()} for row in csv.DictReader(file)]
    except OSError as error:
        raise RecordError(f"{path}: can not be read ({error.strerror})") from error


def _plain(value):
    return float(value) if isinstance(value, np.floating) else value  # csv writes a float in full, a float32 in its own few digits


def _number(text):
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
