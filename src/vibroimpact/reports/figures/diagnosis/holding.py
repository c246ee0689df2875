"""The holding force by place: by sensor, band and level, for both states of the model."""

import numpy as np
import xarray as xr

from vibroimpact.reports.figures.plot import Axis, ColourBar, Map, Panel, Plot
from vibroimpact.reports.figures.sheet import WIDTH_IN

from .states import level_in_words, shown_states

MOST_LEVELS, MOST_CHANNELS = 3, 12
RANGE = 50.0  # between the largest colour and the least

CAPTION = (
    "RMS of the force that holds each sensor of the model to its measurement, by band. If"
    " model and structure agree, it is that of noise and small errors of the model; if it"
    " stands out with the completed model, something is left. A column of panels is one record and"
    " has one scale of colours. The title has the mean over records that took no part.{left_out}"
)


def holding_figure(evidence: xr.Dataset) -> Plot:
    """Return the Plot of maps of the holding force, a column per level and a row per state."""
    levels, channels = chosen_levels(evidence), chosen_channels(evidence)
    states = shown_states(evidence)
    rows = [[f"{name}, {level}" for level in levels] for _, name in states]
    panels: dict[str, Panel] = {}
    bars = []
    for column, level in enumerate(levels):
        own = [row[column] for row in rows]
        maps = _maps(evidence, level, channels, states)
        panels |= dict(zip(own, maps, strict=True))
        (item,) = maps[0].items
        bars.append(ColourBar("holding_force_N", item.low, item.high, log=True, panels=own))
    left = evidence.sizes["channel"] - len(channels)
    words = f" {left} channels with less of it are left out." if left else ""
    height = 0.75 + max(0.21 * len(channels), 1.0)
    return Plot(
        "diagnosis_holding",
        _title(evidence, states),
        CAPTION.format(left_out=words),
        panels,
        rows,
        (WIDTH_IN, 1.5 + height * len(states)),
        share="xy",
        colour_bars=bars,
    )


def chosen_levels(evidence: xr.Dataset) -> list[int]:
    """Return up to MOST_LEVELS stretches of different records: the lowest and the highest load, and
    a held-out one between, if there is one.
    """
    load, part = evidence["load"].values, evidence["part"].values
    order = sorted(range(len(load)), key=lambda row: (load[row], part[row] != "apart"))
    first: dict[str, int] = {}
    for row in order:
        first.setdefault(str(evidence["record_name"].values[row]), row)
    rows = list(first.values())
    if len(rows) <= MOST_LEVELS:
        return rows
    between = sorted(rows[1:-1], key=lambda row: part[row] != "apart")
    return [rows[0], between[0], rows[-1]]


def chosen_channels(evidence: xr.Dataset) -> list[int]:
    """Return up to MOST_CHANNELS channels, those with the largest share of the holding force of any
    stretch, in their own order.
    """
    power = np.sum(evidence["holding_force"].values.astype(float) ** 2, axis=-1)
    whole = np.maximum(power.sum(axis=-1, keepdims=True), np.finfo(float).tiny)
    share = (power / whole).max(axis=(0, 1))
    return sorted(np.argsort(-share, kind="stable")[:MOST_CHANNELS].tolist())


def _title(evidence, states):
    """Return the RMS over channels of a held-out stretch, and the place of its maximum."""
    power = evidence["holding_force"].values.astype(float) ** 2
    apart = np.flatnonzero(evidence["part"].values == "apart")
    rows = apart if len(apart) else np.arange(power.shape[1])
    level = np.sqrt(power[:, rows].sum(axis=-1).mean(axis=(1, 2)))
    told = " → ".join(f"{level[state]:.2g}" for state, _ in states)
    channel, band = np.unravel_index(
        np.argmax(power[states[-1][0], rows].mean(axis=0)), power.shape[2:]
    )
    low, high = (float(evidence[f"band_{end}"].values[band]) for end in ("low", "high"))
    name = str(evidence["channel_name"].values[channel])
    left = "most" if len(states) == 1 else "most left"
    return f"Holding force: {told} N per sensor, {left} at {name}, {low:.0f}–{high:.0f} Hz"


def _maps(evidence, level, channels, states):
    """Return the Panel of a stretch for each state, with one scale of colours."""
    values = evidence["holding_force"].values[:, level][:, channels].astype(float)
    low, high = evidence["band_low"].values, evidence["band_high"].values
    names = [str(name) for name in evidence["channel_name"].values[channels]]
    record = str(evidence["record_name"].values[level])
    largest = max(float(values[[state for state, _ in states]].max()), np.finfo(float).tiny)
    ends, edges = (largest / RANGE, largest), np.r_[low, high[-1]]
    middle, column = np.sqrt(low * high), "holding_force_N"
    maps, title = [], level_in_words(evidence, level).replace(", ", "\n", 1)
    for state, name in states:
        item = Map(record, middle, names, values[state], column, *ends, log=True, edges=edges)
        axes = Axis("frequency_Hz", True), Axis("channel", names=names, label=name)
        maps.append(Panel(*axes, [item], "" if maps else title))
    return maps
