"""The units in which SI values are shown to a reader: the prefix follows from the value."""

from collections.abc import Iterable, Sequence

import numpy as np

Shown = tuple[str, float, float]  # shown unit, shown units per SI unit, SI value it is used below


def _prefixed(unit: str, prefixes: str = " kMGT") -> tuple[Shown, ...]:
    """Return the multiples of a unit by a thousand each, so that 1 to 999 is shown of any but the
    first and the last.
    """
    rows = [
        (f"{prefix.strip()}{unit}", 1e3**-n, 1e3 ** (n + 1)) for n, prefix in enumerate(prefixes)
    ]
    return (*rows[:-1], (*rows[-1][:2], np.inf))


# SI unit -> units that values are shown in, by size
SHOWN: dict[str, Sequence[Shown]] = {
    # clearances and motions are in mm down to a twentieth of one
    "m": (("µm", 1e6, 5e-5), ("mm", 1e3, 0.5), ("m", 1.0, np.inf)),
    "s": (("µs", 1e6, 1e-3), ("ms", 1e3, 0.5), ("s", 1.0, np.inf)),
    "kg": (("mg", 1e6, 1e-3), ("g", 1e3, 0.5), ("kg", 1.0, np.inf)),
    "kg/m": (("g/m", 1e3, 0.5), ("kg/m", 1.0, np.inf)),
    "rad": (("deg", 180.0 / np.pi, np.inf),),
    "N": (("mN", 1e3, 1.0), *_prefixed("N")),
    "N/m": _prefixed("N/m"),
    "N/m^1.5": _prefixed("N/m^1.5"),
    "N/m^2": _prefixed("N/m²"),
    "N/m^3": _prefixed("N/m³"),
    "N m/rad": _prefixed("N m/rad"),
    "N s/m": _prefixed("N s/m"),
    "N s/m^2": _prefixed("N s/m²"),
    "N s^2/m^2": _prefixed("N s²/m²"),
    "N s^2/m^3": _prefixed("N s²/m³"),
}
SPELT = {"N/m2": "N/m^2", "N/m3": "N/m^3", "N s2/m2": "N s^2/m^2"}


def display_unit(unit: str, values: Iterable[float | None]) -> tuple[str, float]:
    """Return (shown unit, shown units per SI unit) for values of a parameter.

    unit: the SI unit of the values.
    values: SI values; NaN or None if there is none. The largest decides.
    """
    given = np.abs(np.array([*values, 0.0], float))
    largest = given[np.isfinite(given)].max()
    known = SHOWN.get(SPELT.get(unit, unit), ((unit, 1.0, np.inf),))
    if largest == 0.0:  # no size: the SI unit itself, or the first if it is not among them
        return next(((name, factor) for name, factor, _ in known if factor == 1.0), known[0][:2])
    return next((name, factor) for name, factor, below in known if largest < below)
