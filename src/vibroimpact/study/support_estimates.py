"""The equivalent support of one case by every method, as a notebook shows it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

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
}


@dataclass(frozen=True, repr=False)
class SupportEstimates(Mapping[str, Estimate]):
    """The estimates of the equivalent support of one case, by method: estimates["lscf"].k in N/m.

    load_rms_N: RMS of the force, N.
    gap_m: radial clearance, m.
    estimates: one Estimate per method.
    curves: Dataset of what was fitted: poles, spectra and shapes of every method.
    """

    load_rms_N: float
    gap_m: float
    estimates: tuple[Estimate, ...]
    curves: xr.Dataset

    def __getitem__(self, method: str) -> Estimate:
        for estimate in self.estimates:
            if estimate.method == method:
                return estimate
        raise KeyError(f"{method}: the methods are {', '.join(self)}")

    def __iter__(self) -> Iterator[str]:
        return (estimate.method for estimate in self.estimates)

    def __len__(self) -> int:
        return len(self.estimates)

    def __repr__(self) -> str:
        title = f"Equivalent support at {self.load_rms_N:g} N RMS, gap {1e3 * self.gap_m:.4g} mm"
        head = f"{'method':<26} {'k N/m':>18} {'c N s/m':>16}  quality"
        return "\n".join([title, head, *map(_line, self.estimates)])

    def to_dataset(self) -> xr.Dataset:
        """Return the estimates as variables along the dimension `method`, with units.

        One method is selected by dataset.sel({"method": "lscf"}): the word is taken as an option in
        dataset.sel(method=...).
        """
        columns = {}
        for name, (unit, meaning) in ABOUT.items():
            values = np.array([getattr(estimate, name) for estimate in self.estimates])
            about = {"long_name": meaning} | ({"units": unit} if unit else {})
            columns[name] = ("method", values, about)
        case = {"load_rms_N": self.load_rms_N, "gap_m": self.gap_m}
        return xr.Dataset(columns, {"method": list(self)}, case)


def _line(estimate: Estimate) -> str:
    """Return one line of the table: values with standard errors, a dash for what is not there."""
    k = _with_error(estimate.k, estimate.k_standard_error)
    c = _with_error(estimate.c, estimate.c_standard_error)
    return f"{estimate.method:<26} {k:>18} {c:>16}  {estimate.quality}"


def _with_error(value: float, error: float) -> str:
    if not np.isfinite(value):
        return "-"
    return f"{value:.3g} ± {error:.2g}" if np.isfinite(error) else f"{value:.3g}"
