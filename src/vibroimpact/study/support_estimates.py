"""The equivalent supports of one case by every method, as a notebook shows them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from vibroimpact.identify.estimate import Estimate

# Field of an Estimate: (unit, meaning).
ABOUT = {
    "k": ("N m-1", "equivalent stiffness per support"),
    "k_standard_error": ("N m-1", "standard error of the equivalent stiffness"),
    "c": ("N s m-1", "equivalent damping per support, on top of the modal damping"),
    "c_standard_error": ("N s m-1", "standard error of the equivalent damping"),
    "frequency": ("Hz", "undamped frequency of the pole behind the estimate"),
    "damping_ratio": ("1", "damping ratio of the pole behind the estimate"),
    "quality": (None, "ok, weak or unresolved"),
    "note": (None, "reason for the quality"),
    "flag": (None, "what makes the estimate doubtful beyond its standard error"),
    "k_bound": ("N m-1", "upper bound of the stiffness where it does not differ from 0"),
    "contact_fraction": ("1", "time in contact of the support that is touched most"),
    "caution": (None, "what else is to be known of the case, whatever the method"),
}


@dataclass(frozen=True, repr=False)
class SupportEstimates(Mapping[str, Estimate]):
    """The estimates of the equivalent supports of one case, by method: estimates["lscf"].k in N/m.

    If several groups of supports or directions are identified, `of` selects one of them first:
    estimates.of("plate_1", "y")["lscf"].k.

    load_rms_N: RMS of the force, N.
    gap_m: radial clearance, m.
    estimates: one Estimate per method, group of supports and direction.
    curves: Dataset of the fits: poles, spectra and shapes of every method.
    """

    load_rms_N: float
    gap_m: float
    estimates: tuple[Estimate, ...]
    curves: xr.Dataset

    @property
    def directions(self) -> list[tuple[str, str]]:
        """Return (group of supports, direction) of everything that was identified."""
        return list(dict.fromkeys((each.group, each.direction) for each in self.estimates))

    def of(self, group: str, direction: str) -> "SupportEstimates":
        """Return the estimates of one group of supports in one direction."""
        chosen = [
            each for each in self.estimates if (each.group, each.direction) == (group, direction)
        ]
        if not chosen:
            known = ", ".join(f"{each} in {along}" for each, along in self.directions)
            raise KeyError(f"{group} in {direction}: identified are {known}")
        return replace(self, estimates=tuple(chosen))

    def __getitem__(self, method: str) -> Estimate:
        if len(self.directions) > 1:
            group, direction = self.directions[0]
            raise KeyError(
                f"{method}: several supports are identified; choose one by"
                f' .of("{group}", "{direction}")["{method}"]'
            )
        for estimate in self.estimates:
            if estimate.method == method:
                return estimate
        raise KeyError(f"{method}: the methods are {', '.join(self)}")

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys(estimate.method for estimate in self.estimates))

    def __len__(self) -> int:
        return len(list(iter(self)))

    def __repr__(self) -> str:
        title = f"Equivalent support at {self.load_rms_N:g} N RMS, gap {1e3 * self.gap_m:.4g} mm"
        lines = [title]
        for group, direction in self.directions:
            place = f"group {group} in {direction}"
            lines.append(f"{place:<26} {'k N/m':>18} {'c N s/m':>16}  quality")
            lines += map(_line, self.of(group, direction).estimates)
        lines += dict.fromkeys(each.caution for each in self.estimates if each.caution)
        return "\n".join(lines)

    def to_dataset(self) -> xr.Dataset:
        """Return the estimates as variables (support_direction, method), with units.

        One method is selected by dataset.sel({"method": "lscf"}): the word is taken as an option in
        dataset.sel(method=...).
        """
        columns = {}
        for name, (unit, meaning) in ABOUT.items():
            values = np.array(
                [
                    [getattr(estimate, name) for estimate in self.of(*place).estimates]
                    for place in self.directions
                ]
            )
            about = {"long_name": meaning} | ({"units": unit} if unit else {})
            columns[name] = (("support_direction", "method"), values, about)
        coords = {
            "method": list(self),
            "group": ("support_direction", [group for group, _ in self.directions]),
            "direction": ("support_direction", [direction for _, direction in self.directions]),
        }
        return xr.Dataset(columns, coords, {"load_rms_N": self.load_rms_N, "gap_m": self.gap_m})


def _line(estimate: Estimate) -> str:
    """Return one line of the table: values with standard errors, a dash for a missing one."""
    k = _with_error(estimate.k, estimate.k_standard_error)
    c = _with_error(estimate.c, estimate.c_standard_error)
    quality = estimate.quality + (f", flagged: {estimate.flag}" if estimate.flag else "")
    if np.isfinite(estimate.k_bound):
        quality += f", k < {estimate.k_bound:.3g} N/m"
    return f"{estimate.method:<26} {k:>18} {c:>16}  {quality}"


def _with_error(value: float, error: float) -> str:
    if not np.isfinite(value):
        return "-"
    return f"{value:.3g} ± {error:.2g}" if np.isfinite(error) else f"{value:.3g}"
