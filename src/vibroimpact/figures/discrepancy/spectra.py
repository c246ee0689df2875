"""Measured and simulated spectra, before and after the model is completed, with seed scatter."""

from __future__ import annotations

import numpy as np

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import BLACK, BLUE, ORANGE, label_of

from .map import counted_cells
from .quicklook import PSD_COLUMNS

MOST_RECORDS, CHANNELS_SHOWN = 3, 2
MOVED = 0.5  # of the bands of a channel above noise
BELOW = 1e-3  # lowest drawn value, over the smallest measured PSD in the bands
STAGES = (("before", "model as given", ORANGE), ("after", "completed model", BLUE))


def spectra_figure(before, after, regions=()):
    """Return [Sheet] with a row per channel and a column per record, for those that matter most.

    before, after: as of map_figure, with psd_frequency, psd_measured and
    psd_simulated_mean, _low, _high (record, channel, frequency), and optionally channel_unit
    (channel), m s-2 where it is missing.
    regions: those of verdict.json, shaded in their panels.
    """
    caption = (
        "PSD, measured (black) and simulated: with the model as given (orange)"
        f"{' and with the completed one (blue)' if after is not None else ''}; bands hold the"
        " spectra of the seeds. Records: the lowest load, the highest fitted one, and the held-out"
        " one that disagrees most; channels: the one that disagrees most, and the next that the"
        " lowest load moves beyond noise. Dotted: edges of the compared bands."
    )
    if before is None or "psd_measured" not in before:
        sheet = Sheet("discrepancy_psd", "Measured and simulated spectra", caption)
        sheet.note(
            sheet.axes["main"],
            "no spectra: the campaign was refused",
            "frequency_Hz",
            "psd_m2_per_s4_per_Hz",
        )
        return [sheet]
    records, channels = chosen_records(before), chosen_channels(before)
    mosaic = [[f"{record} {channel}" for record in records] for channel in channels]
    sheet = Sheet(
        "discrepancy_psd",
        f"Measured and simulated spectra{', before and after' if after is not None else ''}",
        caption,
        mosaic,
        size=(1.2 + 3.7 * len(records), 0.9 + 2.9 * len(channels)),
        sharex=True,
    )
    for row in mosaic:
        for key in row:
            record, channel = map(int, key.split())
            _panel(sheet, sheet.axes[key], (before, after), record, channel, regions)
    for row in mosaic:
        for key in row[1:]:
            sheet.axes[key].set_ylabel("")
    for key in [key for row in mosaic[:-1] for key in row]:
        sheet.axes[key].set_xlabel("")
    handles, labels = sheet.axes[mosaic[0][0]].get_legend_handles_labels()
    sheet.figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return [sheet]


def chosen_records(data):
    """Return up to three record indices.

    They are the lowest load, the highest fitted load, and the held-out record of the largest
    discrepancy.
    """
    load = data["load_rms"].values
    held = np.array([str(value) == "holdout" for value in data["split"].values])
    size = np.array(
        [_rms(data["D"].values[record][counted_cells(data)[record]]) for record in range(load.size)]
    )
    chosen = [int(np.argmin(load))]
    if (~held).any():
        chosen.append(int(np.argmax(np.where(held, -np.inf, load))))
    if held.any():
        chosen.append(int(np.argmax(np.where(held, size, -np.inf))))
    return list(dict.fromkeys(chosen))[:MOST_RECORDS]


def chosen_channels(data):
    """Return up to two channel indices, those of the largest discrepancy over all records.

    The second is among the channels that respond at the lowest load.
    """
    counted = counted_cells(data)
    size = np.array(
        [
            _rms(data["D"].values[:, channel][counted[:, channel]])
            for channel in range(data.sizes["channel"])
        ]
    )
    order = np.argsort(size)[::-1]
    moved = counted[int(np.argmin(data["load_rms"].values))].mean(axis=-1) > MOVED
    rest = sorted(
        order[1:], key=lambda channel: not moved[channel]
    )  # stable: by discrepancy within each half
    return [int(index) for index in (order[0], *rest)][:CHANNELS_SHOWN]


def _rms(values):
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else 0.0


def _load_unit(data):
    """Return the unit of the loads of a map as a reader is told it."""
    return {"m s-2": "m/s²"}.get(data["load_rms"].attrs.get("units", "N"), "N")


def _panel(sheet, axes, maps, record, channel, regions):
    """Draw one record and channel."""
    before = maps[0]
    name = str(before["record_name"].values[record])
    sensor = str(before["channel_name"].values[channel])
    held = " (held out)" if str(before["split"].values[record]) == "holdout" else ""
    gap = float(before["gap"].values[record])
    load = float(before["load_rms"].values[record])
    axes.set_title(
        f"{sensor}, {name}{held}\n{load:.3g} {_load_unit(before)}"
        f" RMS{f', gap {gap * 1e3:.3g} mm' if np.isfinite(gap) else ''}",
        fontsize=8.5,
    )
    unit = str(before["channel_unit"].values[channel]) if "channel_unit" in before else "m s-2"
    column = PSD_COLUMNS.get(unit, "psd_unit2_per_Hz")
    measured = before["psd_measured"].values[record, channel].astype(float)
    frequency = before["psd_frequency"].values.astype(float)
    band = before["band_Hz"].values
    shown = (frequency >= 0.7 * band[0, 0]) & (frequency <= 1.3 * band[-1, 1])
    inside = (frequency >= band[0, 0]) & (frequency <= band[-1, 1])
    tops, floor = [measured[inside].max()], max(measured[inside].min(), np.finfo(float).tiny)
    for (stage, label, colour), data in zip(STAGES, maps, strict=True):
        if data is None:
            continue
        mean, low, high = (
            data[f"psd_simulated_{part}"].values[record, channel].astype(float)
            for part in ("mean", "low", "high")
        )
        sheet.line(
            axes,
            ("frequency_Hz", frequency[shown]),
            (column, mean[shown]),
            stage,
            low=low[shown],
            high=high[shown],
            tags={"record": name, "channel": sensor},
            color=colour,
            linewidth=1.1,
            label=label,
            zorder=3,
        )
        tops.append(high[inside].max())
        floor = min(floor, max(low[inside].min(), BELOW * floor))
    sheet.line(
        axes,
        ("frequency_Hz", frequency[shown]),
        (column, measured[shown]),
        "measured",
        tags={"record": name, "channel": sensor},
        color=BLACK,
        linewidth=0.8,
        label="measured",
        zorder=2,
    )
    for low, high in [region.band_Hz for region in regions if _here(region, sensor, load, gap)]:
        axes.axvspan(low, high, color=BLACK, alpha=0.07, linewidth=0)
    for edge in (band[0, 0], band[-1, 1]):
        axes.axvline(edge, color=BLACK, linewidth=0.7, linestyle=":")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(0.5 * floor, 2.0 * max(tops))
    axes.set_xlabel(label_of("frequency_Hz"))


def _here(region, channel, load, gap):
    """Whether a region of verdict.json lies in the panel of a channel, load (N) and gap (m)."""
    same_gap = (
        region.gap_m is None or not np.isfinite(gap) or np.isclose(region.gap_m, gap, rtol=1e-3)
    )
    return region.channel == channel and np.isclose(region.load_rms_N, load, rtol=0.02) and same_gap
