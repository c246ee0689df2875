"""The model as given and the completed one, as the figures of a diagnosis show them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import BLUE, ORANGE

AS_GIVEN, COMPLETED = "model as given", "completed model"
COLOURS = {AS_GIVEN: ORANGE, COMPLETED: BLUE}


def empty_sheet(name: str, title: str, why: str) -> Sheet:
    """Return a Sheet without a table that says why nothing is drawn."""
    sheet = Sheet(name, title, f"Nothing is shown: {why}.", size=(7.6, 2.4))
    sheet.axes["main"].text(0.5, 0.5, why, ha="center", va="center")
    sheet.axes["main"].set_axis_off()
    return sheet


def shown_states(evidence: xr.Dataset) -> list[tuple[int, str]]:
    """Return [(index of the state, its name)]: the model as given, and the completed one where
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


def bars(
    axes: Axes,
    places: np.ndarray,
    values: np.ndarray,
    texts: Sequence[str],
    gid: str,
    height: float = 0.62,
    **style: Any,
) -> None:
    """Draw horizontal bars of values at places, each with its text at its end."""
    for bar, text in zip(axes.barh(places, values, height, zorder=2, **style), texts, strict=True):
        bar.set_gid(gid)
        end = bar.get_width(), bar.get_y() + 0.5 * height
        axes.annotate(text, end, (3, 0), textcoords="offset points", va="center", fontsize=8)


def name_rows(axes: Axes, names: Sequence[str]) -> None:
    """Name the rows of bars at 0, 1, ... from the top."""
    axes.set_yticks(range(len(names)), [str(name) for name in names], fontsize=8)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.grid(False, axis="y")


def percent(share: float) -> str:
    """Return a share as "0.8 %", "12 %" or "over 200 %"."""
    if not np.isfinite(share):
        return "-"
    return "over 200 %" if share > 2.0 else f"{100.0 * share:.{1 if share < 0.095 else 0}f} %"


def before_and_after(values: list[float], words: tuple[str, str]) -> str:
    """Return "as given 47 %, completed 12 %" of one or two shares; words: of the two states."""
    return ", ".join(f"{word} {percent(value)}" for word, value in zip(words, values, strict=False))
