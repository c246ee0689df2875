"""The nuisances of a measured structure: frequencies, damping of its modes, gains of its channels.

They are fitted to the lines of the holding force, with the priors of constants.py.
"""

from __future__ import annotations

from .comparison import Comparison
from .coordinates import nuisance_coordinates
from .explanations import Point, Structure
from .gauss_newton import fit
from .measurement.signals import Signals

PASSES = 3  # at most: gains are then known to 1 %, see docs/virtual_supports.md


def calibrated(structure: Structure, signals: Signals, point: Point) -> Point:
    """Return a Point with fitted nuisances: those of all modes in the band and of all channels.

    point: its terms stay, its nuisances are where the fit begins.
    """
    comparison = Comparison(signals, structure)
    rows = nuisance_coordinates(comparison.modes, len(signals.names))
    return fit(comparison.fitted(), point, rows, PASSES).point
