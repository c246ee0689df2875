"""The units in which SI values are shown to a reader."""

from collections.abc import Iterable

import numpy as np

# SI unit -> (shown unit, shown units per SI unit, largest SI value that is shown in it)
SHOWN = {
    "m": (("mm", 1e3, 0.5),),
    "s": (("ms", 1e3, 0.5),),
    "kg": (("g", 1e3, 0.5),),
    "rad": (("deg", 180.0 / np.pi, np.inf),),
    "N/m": (("N/m", 1.0, 2e3), ("kN/m", 1e-3, 2e6), ("MN/m", 1e-6, np.inf)),
    "N/m^1.5": (("MN/m^1.5", 1e-6, np.inf),),
    "N/m^2": (("kN/m²", 1e-3, 2e6), ("MN/m²", 1e-6, np.inf)),
    "N/m^3": (("GN/m³", 1e-9, np.inf),),
    "N s/m^2": (("N s/m²", 1.0, np.inf),),
    "N s^2/m^3": (("N s²/m³", 1.0, np.inf),),
}


def display_unit(unit: str, values: Iterable[float | None]) -> tuple[str, float]:
    """Return (shown unit, shown units per SI unit) for values of a parameter.

    unit: the SI unit of the values.
    values: SI values; NaN or None where there is none.
    """
    largest = np.nanmax(np.abs(np.array([*values, 0.0], float)))
    return next(
        ((shown, factor) for shown, factor, limit in SHOWN.get(unit, ()) if largest <= limit),
        (unit, 1.0),
    )
