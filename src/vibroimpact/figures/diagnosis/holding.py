"""Where the holding force acts: by sensor, band and level, for both states of the model."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.colors import LogNorm

from vibroimpact.figures.sheet import WIDTH_IN, Sheet
from vibroimpact.figures.style import label_of, tidy_log_axis

from .states import level_in_words, name_rows, shown_states

MOST_LEVELS, MOST_CHANNELS = 3, 12
RANGE = 50.0  # between the largest colour and the least

CAPTION = (
    "RMS of the force that holds each sensor of the model to what was measured, by band. Where"
    " model and structure agree it is what noise and small errors of the model make; where it"
    " stands out with the completed model, something is left. A column of panels is one record and"
    " has one scale of colours. The title has the mean over records that took no part.{left_out}"
)


def holding_figure(evidence: xr.Dataset) -> Sheet:
    """Return the Sheet of maps of the holding force, a column per level and a row per state."""
    levels, channels = chosen_levels(evidence), chosen_channels(evidence)
    states = shown_states(evidence)
    mosaic = [[f"{name}, {level}" for level in levels] for _, name in states]
    left = evidence.sizes["channel"] - len(channels)
    words = f" {left} channels with less of it are left out." if left else ""
    height = 0.75 + max(0.21 * len(channels), 1.0)
    sheet = Sheet(
        "diagnosis_holding",
        _title(evidence, states),
        CAPTION.format(left_out=words),
        mosaic,
        size=(WIDTH_IN, 1.5 + height * len(states)),
        sharex=True,
        sharey=True,
    )
    for column, level in enumerate(levels):
        values = evidence["holding_force"].values[:, level][:, channels].astype(float)
        shown = values[[state for state, _ in states]]
        largest = max(float(shown.max()), np.finfo(float).tiny)
        norm = LogNorm(largest / RANGE, largest)
        panels = [sheet.axes[row[column]] for row in mosaic]
        for axes, (state, name) in zip(panels, states, strict=True):
            mesh = _map(sheet, axes, evidence, (level, channels, state), norm)
            if column == 0:
                axes.set_ylabel(name)
        told = level_in_words(evidence, level)
        panels[0].set_title(told.replace(", ", "\n", 1), fontsize=8.5)
        panels[-1].set_xlabel(label_of("frequency_Hz"))
        bar = sheet.colour_bar(mesh, panels, "holding_force_N", location="bottom", aspect=14)
        tidy_log_axis(bar.ax.xaxis)
        bar.ax.tick_params(labelsize=8)
    return sheet


def chosen_levels(evidence: xr.Dataset) -> list[int]:
    """Return up to MOST_LEVELS stretches of different records: the lowest and the highest load, and
    one between that took no part, where there is one.
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
    """Return the RMS over channels of a stretch that took no part, and where it was largest."""
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


def _map(sheet, axes, evidence, chosen, norm):
    """Draw the holding force of (stretch, channels, state) and return the mesh."""
    level, channels, state = chosen
    values = evidence["holding_force"].values[state, level, channels].astype(float)
    low, high = evidence["band_low"].values, evidence["band_high"].values
    names = evidence["channel_name"].values[channels]
    bands = len(low)
    place = sheet.record(
        axes,
        str(evidence["record_name"].values[level]),
        channel=np.repeat(names, bands),
        frequency_Hz=np.tile(np.sqrt(low * high), len(names)),
        holding_force_N=values.ravel(),
    )
    mesh = axes.pcolormesh(
        np.r_[low, high[-1]],
        np.arange(len(names) + 1) - 0.5,
        np.maximum(values, norm.vmin),
        norm=norm,
        rasterized=True,
        gid=place,
    )
    axes.set_xscale("log")
    name_rows(axes, names)
    axes.grid(False)
    return mesh
