"""Which cells of records, channels and bands show motion that is compared."""

import numpy as np

from vibroimpact.observation.strain import STRAIN
from vibroimpact.units import TIME_DERIVATIVES

from .workbench import Workbench

ABOVE_NOISE_DB = 6.0
# A channel also senses motion across its direction, 1 % at best (transverse sensitivity, ISO
# 16063-31). A signal farther below the strongest channel may be that of another direction.
BELOW_STRONGEST_DB = 40.0


def counted(bench: Workbench) -> np.ndarray:
    """Return (record, channel, band) bool: the cells that count in the misfit.

    They are 6 dB above the noise, and at most 40 dB below the strongest channel of their record and
    band. Motions are compared as displacements, and strains with strains only.
    """
    layout, signals = bench.layout, bench.signals
    power = layout.power(bench.measured_features)
    width = np.diff(layout.edges)
    noise = 10.0 * np.log10(
        np.maximum(signals.noise[:, None] ** 2 * width / (0.5 * layout.rate), 1.0e-300)
    )
    middle = np.pi * (layout.edges[1:] + layout.edges[:-1])  # rad/s
    derivatives = np.array([TIME_DERIVATIVES.get(kind, 0) for kind in signals.kinds])
    moved = power - 20.0 * derivatives[:, None] * np.log10(middle)
    strong = np.ones(power.shape, bool)
    for family in (list(TIME_DERIVATIVES), [STRAIN]):
        own = np.isin(signals.kinds, family)[:, None]
        strongest = np.max(moved, axis=1, keepdims=True, where=own, initial=-np.inf)
        strong &= ~own | (moved > strongest - BELOW_STRONGEST_DB)
    return (power > noise + ABOVE_NOISE_DB) & strong
