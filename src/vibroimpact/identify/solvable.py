"""Methods on unsuitable spectra: no value in place of an error."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np
import xarray as xr

from vibroimpact.identify.linear.modes import PoleError

Result = TypeVar("Result")


def or_none(method: Callable[..., Result | None], *arguments: object) -> Result | None:
    """Return the result of a method, None if its equations have no solution.

    Spectra without a resonance, of sensors that do not move or that move alike, make matrices
    singular.
    """
    try:
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            return method(*arguments)
    except (np.linalg.LinAlgError, PoleError):
        return None


def unusable_channels(spectra: xr.Dataset) -> str:
    """Return which sensors along the force do not move or have no finite spectra, or nothing.

    spectra: dataset of study.case_spectra.
    """
    parts = spectra["sensor_spectra_re"].values, spectra["sensor_spectra_im"].values
    size = np.abs(parts[0]).max(axis=(1, 2)) + np.abs(parts[1]).max(axis=(1, 2))
    names = spectra["driven_sensor"].values
    still = [str(name) for name, value in zip(names, size, strict=True) if value == 0.0]
    wrong = [str(name) for name, value in zip(names, size, strict=True) if not np.isfinite(value)]
    texts = [f"no motion at {', '.join(still)}"] if still else []
    return "; ".join(texts + ([f"no finite spectra at {', '.join(wrong)}"] if wrong else []))
