"""The variables of a record: dimensions, type, unit and name of each."""

from typing import Any

import numpy as np
import xarray as xr

# name: (dimensions, dtype, units, long name)
VARIABLES: dict[str, tuple[tuple, str, str, str]] = {
    "displacement": (("sensor", "time"), "f4", "m", "displacement"),
    "acceleration": (("sensor", "time"), "f4", "m s-2", "acceleration"),
    "line_displacement": (("line_point", "time"), "f4", "m", "displacement along the shape line"),
    "support_force": (
        ("support", "direction", "time"),
        "f4",
        "N",
        "force of the structure on the support",
    ),
    "force": (("time",), "f4", "N", "drive force"),
    "stress_rms": (
        ("section",),
        "f8",
        "Pa",
        "RMS of the outer-fibre bending stress, every fifth step, unfiltered",
    ),
    "stress_peak": (
        ("section",),
        "f8",
        "Pa",
        "largest outer-fibre bending stress, every fifth step",
    ),
    "stress_flag": ((), "i1", "1", "1 when the peak stress exceeds record.stress_limit_Pa"),
    "contact_fraction": (("support",), "f8", "1", "fraction of time in contact"),
    "impact_count": (("support",), "i4", "1", "number of contacts begun"),
    "impact_rate": (("support",), "f8", "s-1", "contacts begun per unit time"),
    "peak_force": (("support",), "f8", "N", "largest resultant support force"),
    "rms_force": (("support",), "f8", "N", "RMS of the resultant support force"),
    "mean_impulse": (("support",), "f8", "N s", "mean impulse of a contact"),
    "impact_velocity_rms": (
        ("support",),
        "f8",
        "m s-1",
        "RMS radial velocity at the begin of a contact",
    ),
    "impact_velocity_max": (
        ("support",),
        "f8",
        "m s-1",
        "largest radial velocity at the begin of a contact",
    ),
    "wear_work_rate": (("support",), "f8", "W", "normal force times sliding speed, mean over time"),
    "land_work_rate": (
        ("support", "land"),
        "f8",
        "W",
        "wear work rate at each land of a support, in the order of its profile",
    ),
    "force_displacement": (
        ("contact_point", "direction"),
        "f8",
        "N m",
        "mean of restoring force times displacement",
    ),
    "displacement_square": (("contact_point", "direction"), "f8", "m2", "mean square displacement"),
    "displacement_mean": (("contact_point", "direction"), "f8", "m", "mean displacement"),
    "displacement_product": (
        ("contact_point",),
        "f8",
        "m2",
        "mean product of the displacements in the two directions",
    ),
    "velocity_square": (("contact_point", "direction"), "f8", "m2 s-2", "mean square velocity"),
    "velocity_product": (
        ("contact_point",),
        "f8",
        "m2 s-2",
        "mean product of the velocities in the two directions",
    ),
    "force_mean": (("contact_point", "direction"), "f8", "N", "mean restoring force"),
    "contact_power": (
        ("contact_point", "direction"),
        "f8",
        "W",
        "mean power that the structure gives to the support",
    ),
    "energy": (
        ("energy_term", "energy_time"),
        "f8",
        "J",
        "energies since the start of the simulation",
    ),
    "energy_residual": ((), "f8", "1", "energy identity of the scheme, relative to the input work"),
    "potential_energy_residual": (
        (),
        "f8",
        "1",
        "energy balance with the contact's potential energy, relative to the input work",
    ),
    "contact_dissipation": (
        (),
        "f8",
        "J",
        "energy that contacts and elements took beyond what their springs hold",
    ),
    "fluid_power": ((), "f8", "W", "mean power that the fluid-elastic force gives to the tube"),
    "element_displacement_square": (
        ("element",),
        "f8",
        "m2",
        "mean square displacement of a local element",
    ),
    "element_force_displacement": (
        ("element",),
        "f8",
        "N m",
        "mean of the element's restoring force times displacement",
    ),
    "element_power": (("element",), "f8", "W", "mean power that an element takes"),
    "slip_power": (("element",), "f8", "W", "mean of slider force times slip speed"),
    "contact_displacement": (
        ("contact_point", "direction", "step"),
        "f8",
        "m",
        "displacement at every step",
    ),
    "contact_force": (
        ("contact_point", "direction", "step"),
        "f8",
        "N",
        "force on the structure at every step",
    ),
    "element_displacement": (
        ("element", "step"),
        "f8",
        "m",
        "displacement of a local element at every step",
    ),
    "element_force": (
        ("element", "step"),
        "f8",
        "N",
        "force of an element on the structure at every step",
    ),
    "run_energy": (("run_term",), "f8", "J", "energies of the whole run"),
    "sliding_work": (("support",), "f8", "J", "normal force times slip over the whole run"),
    "slip_work": (("element",), "f8", "J", "slider force times slip over the whole run"),
    "fixed_point_residual": (
        (),
        "f8",
        "1",
        "bound of the relative error of the implicit contact forces, worst step",
    ),
}
# name: (dimensions, units, None for texts, long name)
COORDINATES: dict[str, tuple[tuple, str | None, str]] = {
    "time": (("time",), "s", "time since the start of the record"),
    "sensor": (("sensor",), None, "sensor: point and axis"),
    "line_arc_length": (("line_point",), "m", "arc length along the shape line"),
    "support": (("support",), None, "support"),
    "section": (("section",), None, "section of the structure whose stress is recorded"),
    "element": (("element",), None, "local element"),
    "step_time": (("step",), "s", "time since the initial state"),
    "run_term": (("run_term",), None, "term of the energy balance of the whole run"),
    "energy_term": (("energy_term",), None, "term of the energy balance"),
    "energy_time": (("energy_time",), "s", "time since the start of the simulation"),
}


def coordinate(name: str, values: Any) -> tuple:
    """Return (dimensions, values, attributes) of a declared coordinate.

    Raises KeyError for a coordinate that is not declared.
    """
    dims, units, long_name = COORDINATES[name]
    if units is None:  # an empty list of names is still one of texts
        return dims, np.array(values, dtype=str), {"long_name": long_name}
    return dims, values, {"units": units, "long_name": long_name}


def describe(values: dict, coordinates: dict, attributes: dict) -> xr.Dataset:
    """Return a dataset of declared variables, with their dimensions, units and names.

    Raises KeyError for a variable that is not declared.
    """
    data = {}
    for name, value in values.items():
        dims, dtype, units, long_name = VARIABLES[name]
        data[name] = (dims, np.asarray(value, dtype), {"units": units, "long_name": long_name})
    coords = {name: coordinate(name, value) for name, value in coordinates.items()}
    return xr.Dataset(data, coords, attributes)


def split_record(record: xr.Dataset) -> tuple[xr.Dataset, xr.Dataset]:
    """Return (statistics and energies, time series) of a record; both have its attributes."""
    series = [
        name for name, variable in record.data_vars.items() if {"time", "step"} & set(variable.dims)
    ]
    return record.drop_vars(series).drop_dims(["time", "step"], errors="ignore"), record[series]
