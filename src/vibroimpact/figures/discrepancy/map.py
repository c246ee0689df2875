"""Where model and measurement disagree: maps of D and z over record, channel and band, before and
after the model is completed.
"""

from __future__ import annotations

import numpy as np

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import BLACK, PALE, label_of

QUANTITIES = (("D", "discrepancy_dB", "Discrepancy D"), ("z", "z", "Significance z"))
MODELS = "left with the model as given, right with the completed one"
LARGEST = {"D": 20.0, "z": 10.0}  # largest end of the colour scale
SMALLEST = {"D": 3.0, "z": 4.0}  # smallest end of the colour scale
ROW_IN = 0.155
COLOURS = "RdBu_r"  # red and blue are distinct with any colour vision; zero is white


def map_figure(before, after):
    """Return [Sheet] of the maps.

    before, after: Datasets with D, z, counted, band_Hz, record_name and channel_name; None where
    nothing was compared, and where nothing completes the model.

    Cells where the measurement is not 6 dB above its noise are grey.
    """
    rows = before.sizes["record"] * before.sizes["channel"] if before is not None else 4
    maps = {"before": before} if after is None else {"before": before, "after": after}
    height = min(max(1.6 + 2.0 * (0.5 + ROW_IN * rows), 5.0), 22.0)
    caption = (
        "Measured over simulated band power (D, dB; mean over seeds) and its significance (z, in"
        " the standard deviations that the verdict is decided by: seeds, what two codes differ by,"
        " damping that no record tells), by record and channel against frequency band: "
        f"{MODELS if after is not None else 'with the model as given'}. Red: the measurement is"
        " stronger; blue: the simulation is. Grey: the measurement is not 6 dB"
        " above its noise. Records that were held out of the fit are marked with *."
    )
    sheet = Sheet(
        "discrepancy_map",
        "Where measurement and model disagree",
        caption,
        [[f"{name} {stage}" for stage in maps] for name, _, _ in QUANTITIES],
        size=(11.0 if after is not None else 6.5, height),
        sharex=True,
        sharey=before is not None,
    )
    for name, column, title in QUANTITIES:
        limit = _limit(name, before)
        meshes = [
            _panel(
                sheet,
                sheet.axes[f"{name} {stage}"],
                data,
                name,
                column,
                limit,
                title if after is None else f"{title}, {stage}",
            )
            for stage, data in maps.items()
        ]
        mesh = next((mesh for mesh in meshes if mesh is not None), None)
        if mesh is not None:
            bar = sheet.colour_bar(
                mesh,
                [sheet.axes[f"{name} {stage}"] for stage in maps],
                column,
                extend="both",
                aspect=30,
            )
            bar.ax.grid(False)
    for stage in maps:
        sheet.axes[f"D {stage}"].set_xlabel("")
    return [sheet]


def _limit(name, before):
    """Return the end of the colour scale of D or z."""
    if before is None:
        return SMALLEST[name]
    seen = np.abs(before[name].values[counted_cells(before)])
    return float(
        np.clip(np.nanpercentile(seen, 99) if seen.size else 0.0, SMALLEST[name], LARGEST[name])
    )


def counted_cells(data):
    """Return (record, channel, band) whether a cell is above the noise and finite."""
    return data["counted"].values.astype(bool) & np.isfinite(data["D"].values)


def _panel(sheet, axes, data, name, column, limit, title):
    """Draw one map and return its mesh, or None where there is nothing to draw."""
    axes.set_title(title)
    if data is None:
        sheet.note(axes, "no map: the campaign was refused", "frequency_Hz", "place_in_list")
        axes.set_yticks([])
        return None
    records, channels = (
        [str(value) for value in data[key].values] for key in ("record_name", "channel_name")
    )
    held = [str(value) == "holdout" for value in data["split"].values]
    band = data["band_Hz"].values
    values = np.where(counted_cells(data), data[name].values, np.nan).reshape(
        len(records) * len(channels), len(band)
    )
    for index, row in enumerate(values):
        sheet.record(
            axes,
            f"{records[index // len(channels)]}, {channels[index % len(channels)]}",
            frequency_Hz=np.sqrt(band[:, 0] * band[:, 1]),
            **{column: row},
        )
    axes.set_facecolor(PALE)
    mesh = axes.pcolormesh(
        np.append(band[:, 0], band[-1, 1]),
        np.arange(len(values) + 1),
        values,
        cmap=COLOURS,
        vmin=-limit,
        vmax=limit,
        rasterized=True,
    )
    axes.set_xscale("log")
    axes.set_ylim(len(values), 0)
    axes.grid(False)
    axes.set_xlabel(label_of("frequency_Hz"))
    for index in range(1, len(records)):
        axes.axhline(index * len(channels), color=BLACK, linewidth=0.8)
    labels = [
        f"{record}{'*' if is_held else ''}  {channel}" if place == 0 else channel
        for record, is_held in zip(records, held, strict=True)
        for place, channel in enumerate(channels)
    ]
    axes.set_yticks(np.arange(len(values)) + 0.5, labels, fontsize=6.5)
    axes.tick_params(axis="y", length=0, labelleft=not title.endswith("after"))
    return mesh
