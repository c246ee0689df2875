"""The model as given and the completed one, as the figures of a diagnosis show them."""

import numpy as np
import xarray as xr

from vibroimpact.reports.figures.plot import Axis, Panel, Plot
from vibroimpact.reports.figures.style import BLUE, ORANGE

AS_GIVEN, COMPLETED = "model as given", "completed model"
COLOURS = {AS_GIVEN: ORANGE, COMPLETED: BLUE}


def empty_plot(name: str, title: str, why: str) -> Plot:
    """Return a Plot without a table that says why nothing is drawn."""
    panel = Panel(Axis("time_s"), Axis("residual"), [], note=why, blank=True)
    return Plot(name, title, f"Nothing is shown: {why}.", {"main": panel}, size=(7.6, 2.4))


def shown_states(evidence: xr.Dataset) -> list[tuple[int, str]]:
    """Return [(index of the state, its name)]: the model as given, and the completed one if
    something was added.
    """
    added = evidence.attrs.get("before") != evidence.attrs.get("after")
    return [(0, AS_GIVEN), (1, COMPLETED)] if added else [(0, AS_GIVEN)]


def level_in_words(evidence: xr.Dataset, stretch: int) -> str:
    """Return a stretch as "L12_G1.3_2, 12 N RMS (held out)"."""
    load, held_out = evidence["load"], str(evidence["split"].values[stretch]) == "holdout"
    name = str(evidence["record_name"].values[stretch])
    unit = load.attrs.get("units", "N")
    told = " (held out)" if held_out else ""
    return f"{name}, {float(load.values[stretch]):.3g} {unit} RMS{told}"


def percent(share: float) -> str:
    """Return a share as "0.8 %", "12 %" or "over 200 %"."""
    if not np.isfinite(share):
        return "-"
    return "over 200 %" if share > 2.0 else f"{100.0 * share:.{1 if share < 0.095 else 0}f} %"
