"""The variables of a record: dimensions, type, unit and name of each."""

from typing import Any

import numpy as np
import xarray as xr

from .cases import Case

# {(dimensions, dtype): {name: (units, long name)}}
DECLARED: dict[tuple[str, str], dict[str, tuple[str, str]]] = {
    ("sensor time", "f4"): {
        "displacement": ("m", "displacement"),
        "acceleration": ("m s-2", "acceleration"),
    },
    ("line_point time", "f4"): {"line_displacement": ("m", "displacement along the shape line")},
    ("support direction time", "f4"): {
        "support_force": ("N", "force of the structure on the support")
    },
    ("time", "f4"): {"force": ("N", "drive force")},
    ("section", "f8"): {
        "stress_rms": ("Pa", "RMS of the outer-fibre bending stress, every fifth step, unfiltered"),
        "stress_peak": ("Pa", "largest outer-fibre bending stress, every fifth step"),
    },
    ("", "i1"): {"stress_flag": ("1", "1 when the peak stress exceeds record.stress_limit_Pa")},
    ("support", "f8"): {
        "contact_fraction": ("1", "fraction of time in contact"),
        "impact_rate": ("s-1", "contacts begun per unit time"),
        "peak_force": ("N", "largest resultant support force"),
        "rms_force": ("N", "RMS of the resultant support force"),
        "mean_impulse": ("N s", "mean impulse of a contact"),
        "impact_velocity_rms": ("m s-1", "RMS radial velocity at the begin of a contact"),
        "impact_velocity_max": ("m s-1", "largest radial velocity at the begin of a contact"),
        "wear_work_rate": ("W", "normal force times sliding speed, mean over time"),
        "sliding_work": ("J", "normal force times slip over the whole run"),
    },
    ("support", "i4"): {"impact_count": ("1", "number of contacts begun")},
    ("support land", "f8"): {
        "land_work_rate": (
            "W",
            "wear work rate at each land of a support, in the order of its profile",
        )
    },
    ("contact_point direction", "f8"): {
        "force_displacement": ("N m", "mean of restoring force times displacement"),
        "displacement_square": ("m2", "mean square displacement"),
        "displacement_mean": ("m", "mean displacement"),
        "velocity_square": ("m2 s-2", "mean square velocity"),
        "force_mean": ("N", "mean restoring force"),
        "contact_power": ("W", "mean power that the structure gives to the support"),
    },
    ("contact_point", "f8"): {
        "displacement_product": ("m2", "mean product of the displacements in the two directions"),
        "velocity_product": ("m2 s-2", "mean product of the velocities in the two directions"),
    },
    ("energy_term energy_time", "f8"): {
        "energy": ("J", "energies since the start of the simulation")
    },
    ("", "f8"): {
        "energy_residual": ("1", "energy identity of the scheme, relative to the input work"),
        "potential_energy_residual": (
            "1",
            "energy balance with the contact's potential energy, relative to the input work",
        ),
        "contact_dissipation": (
            "J",
            "energy that contacts and elements took beyond what their springs hold",
        ),
        "fluid_power": ("W", "mean power that the fluid-elastic force gives to the tube"),
        "fixed_point_residual": (
            "1",
            "bound of the relative error of the implicit contact forces, worst step",
        ),
    },
    ("element", "f8"): {
        "element_displacement_square": ("m2", "mean square displacement of a local element"),
        "element_force_displacement": (
            "N m",
            "mean of the element's restoring force times displacement",
        ),
        "element_power": ("W", "mean power that an element takes"),
        "slip_power": ("W", "mean of slider force times slip speed"),
        "slip_work": ("J", "slider force times slip over the whole run"),
    },
    ("contact_point direction step", "f8"): {
        "contact_displacement": ("m", "displacement at every step"),
        "contact_force": ("N", "force on the structure at every step"),
    },
    ("element step", "f8"): {
        "element_displacement": ("m", "displacement of a local element at every step"),
        "element_force": ("N", "force of an element on the structure at every step"),
    },
    ("run_term", "f8"): {"run_energy": ("J", "energies of the whole run")},
}
# name: (dimensions, dtype, attributes)
VARIABLES: dict[str, tuple[tuple[str, ...], str, dict[str, str]]] = {
    name: (tuple(dims.split()), dtype, {"units": units, "long_name": long_name})
    for (dims, dtype), group in DECLARED.items()
    for name, (units, long_name) in group.items()
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


def describe(values: dict, coordinates: dict, attributes: dict) -> xr.Dataset:
    """Return a dataset of declared variables, with their dimensions, units and names.

    Raises KeyError for a variable or coordinate that is not declared.
    """
    data = {}
    for name, value in values.items():
        dims, dtype, about = VARIABLES[name]
        data[name] = (dims, np.asarray(value, dtype), about)
    coords = {}
    for name, value in coordinates.items():
        where, units, long_name = COORDINATES[name]
        own = ({} if units is None else {"units": units}) | {"long_name": long_name}
        # an empty list of names is still one of texts
        coords[name] = (where, np.array(value, dtype=str) if units is None else value, own)
    return xr.Dataset(data, coords, attributes)


def place_attributes(config: Any, case: Case) -> dict[str, Any]:
    """Return the attributes of a file that say which case of which study it is of."""
    names = ("load_rms_N", "gap_m", "seed")
    return {"study": config.study, "case": case.id} | {name: getattr(case, name) for name in names}


def split_record(record: xr.Dataset) -> tuple[xr.Dataset, xr.Dataset]:
    """Return (statistics and energies, time series) of a record; both have its attributes."""
    series = [
        name for name, variable in record.data_vars.items() if {"time", "step"} & set(variable.dims)
    ]
    return record.drop_vars(series).drop_dims(["time", "step"], errors="ignore"), record[series]
