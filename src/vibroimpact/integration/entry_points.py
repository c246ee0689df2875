"""The compiled functions that Python calls, for batches of up to LANES runs, of half as many, and
for a run alone.

A run alone would leave all lanes but one empty. Its kernels are the same files, imported a second
time with one lane: their vectors lie along the modes. Those of HALF lanes take half of the memory.
All add in the same order, so that a run has the same bits alone as in a batch.
"""

import importlib.util
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np

from . import kernels
from .kernels import compiled, decimation, march
from .kernels.lanes import LANES

HALF = LANES // 2


@dataclass(frozen=True)
class EntryPoints:
    """See the functions of the same names in kernels.march and kernels.decimation."""

    march: Callable[..., Any]
    initial_forces: Callable[..., Any]
    decimate: Callable[..., Any]


def lanes_of(cases: int) -> int:
    """Return the number of lanes that a batch of 1 to LANES cases is integrated in."""
    return 1 if cases == 1 else LANES


def in_all_lanes(values: np.ndarray) -> np.ndarray:
    """Return values (.., lane), those of fewer lanes repeated up to LANES: numpy and BLAS then sum
    them in the same order as those of a batch.
    """
    return np.tile(values, max(LANES // values.shape[-1], 1))


@cache
def entry_points(lanes: int) -> EntryPoints:
    """Return the functions for arrays that end in an axis of lanes: LANES, HALF or 1."""
    if lanes == LANES:
        return EntryPoints(march.march, march.initial_forces, decimation.decimate)
    name = f"{kernels.__name__}_of_{lanes}"
    _import_again(kernels, name)
    vars(importlib.import_module(f"{name}.compiled")).update(SAID=compiled.SAID)
    own = [importlib.import_module(f"{name}.{module}") for module in ("march", "decimation")]
    return EntryPoints(own[0].march, own[0].initial_forces, own[1].decimate)


def _import_again(package: ModuleType, name: str) -> None:
    """Make a package importable under another name."""
    spec = importlib.util.spec_from_file_location(
        name, package.__file__, submodule_search_locations=[*package.__path__]
    )
    assert spec is not None and spec.loader is not None
    sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(sys.modules[name])
