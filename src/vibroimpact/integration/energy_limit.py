"""How far the energy balance of a run may be open before its numbers stop to be of use.

The residuals of a record are shares of the work that was put in. In a stationary response damping
takes that work, so that a numerical loss of this share is a damping that the structure does not
have: it lowers the mean square response by about the same share, the RMS by half of it.
"""

from __future__ import annotations

import math

import xarray as xr

# The RMS is then off by 2.5 %, the damping by 5 %: a fifth of the 25 % within which methods agree.
# 10240 steps per second stay below it on the stand-in tube (4.4 %), 5120 do not (11.7 %).
ENERGY_LIMIT = 0.05
ENERGY_RESIDUALS = ("energy_residual", "potential_energy_residual")


def energy_flag(record: xr.Dataset) -> str:
    """Return why the energy balance of a run forbids to use its numbers, or an empty text.

    record: with some of ENERGY_RESIDUALS. potential_energy_residual is NaN if contacts dissipate:
    it says nothing then; energy_residual always has a value.
    """
    found = {name: float(record[name]) for name in ENERGY_RESIDUALS if name in record}
    if math.isnan(found.get("energy_residual", 0.0)):
        return "the energy balance is not a number"
    worst = max((value for value in found.values() if not math.isnan(value)), default=0.0)
    if worst <= ENERGY_LIMIT:
        return ""
    return (
        f"the energy balance is open by {worst:.2g} of the input work (limit {ENERGY_LIMIT:g}):"
        " raise integration.steps_per_second"
    )
