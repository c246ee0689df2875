"""Measured spectra and those of free runs, with the model as given and completed."""

from __future__ import annotations

import numpy as np
import xarray as xr

from vibroimpact.figures.discrepancy.quicklook import PSD_COLUMNS
from vibroimpact.figures.sheet import WIDTH_IN, Sheet
from vibroimpact.figures.style import BLACK, label_of
from vibroimpact.verdict.content import Misfit, Verdict

from .states import AS_GIVEN, COLOURS, COMPLETED

MOST_RECORDS, CHANNELS_SHOWN = 3, 2
BELOW = 1.0e-8  # of the largest PSD: the lowest drawn
LOWEST = 1.0e-5  # of the peak of a measured PSD: what counts as response
LOWEST_HZ, PASSED = 1.0, 0.78  # drawn from; of the highest line, which a filter has passed
SI_UNITS = {
    "acceleration": "m s-2",
    "velocity": "m s-1",
    "displacement": "m",
    "contact_force": "N",
    "strain": "1",
}
MOVES = 1.0e-3  # of the power of the channel of its kind that moves most

CAPTION = (
    "PSD, measured (black) and of free runs under the measured force, not held to any sensor: with"
    " the model as given (orange, dashed) and with the completed one (blue). Records: the lowest"
    " and the highest that was fitted, and the held-out one that disagrees most; channels: those"
    " that disagree most."
)


def psd_figure(psd: xr.Dataset, verdict: Verdict) -> Sheet:
    """Return the Sheet with a row per channel and a column per record, for those that matter most.

    psd: variable psd (state: measured, before, after; record, channel, frequency) in unit²/Hz, NaN
    of a run that failed, with frequency in Hz, load, record_name, split (record,), channel_name and
    channel_kind (channel,).
    """
    records, channels = chosen_records(psd), chosen_channels(psd)
    mosaic = [[f"{record} {channel}" for record in records] for channel in channels]
    sheet = Sheet(
        "diagnosis_psd",
        _title(verdict.misfit.holdout, bool(verdict.shown_effects())),
        CAPTION,
        mosaic,
        size=(min(1.0 + 2.9 * len(records), WIDTH_IN), 1.3 + 2.4 * len(channels)),
        sharex=True,
    )
    for row in mosaic:
        for key in row:
            record, channel = map(int, key.split())
            _panel(sheet, sheet.axes[key], psd, record, channel, bool(verdict.shown_effects()))
            if key != row[0]:
                sheet.axes[key].set_ylabel("")
            sheet.axes[key].set_xlabel(label_of("frequency_Hz") if row is mosaic[-1] else "")
    handles, labels = sheet.axes[mosaic[0][0]].get_legend_handles_labels()
    sheet.figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return sheet


def _title(misfit: Misfit | None, completed: bool) -> str:
    """Return the misfit of the records that took no part, before and after."""
    if misfit is None or misfit.before_dB is None:
        return "Spectra of free runs"
    told = [f"{misfit.before_dB:.2g} dB"]
    if completed and misfit.after_dB is not None:
        told.append(f"{misfit.after_dB:.2g} dB")
    floor = f", floor {misfit.floor_dB:.2g} dB" if misfit.floor_dB is not None else ""
    return f"Spectra of free runs, held out: {' → '.join(told)} off{floor}"


def _gap(psd):
    """Return (record, channel) dB: RMS of measured over simulated PSD with the model as given,
    where the measured one is no more than LOWEST below its peak; 0 of channels that hardly move,
    measured or simulated, beside others of their kind.
    """
    values = np.maximum(psd["psd"].values[:2].astype(float), np.finfo(float).tiny)
    apart = 10.0 * np.log10(values[0] / values[1])
    counted = np.isfinite(apart) & (values[0] > LOWEST * values[0].max(axis=-1, keepdims=True))
    power = np.nan_to_num(values).max(axis=0).mean(axis=-1)
    kinds = np.array([_kind(psd, channel) for channel in range(power.shape[-1])])
    largest = [power[:, kinds == kind].max(axis=-1) for kind in kinds]
    moves = power > MOVES * np.transpose(largest)
    sums = np.sum(np.where(counted, apart, 0.0) ** 2, axis=-1)
    return np.sqrt(sums / np.maximum(counted.sum(axis=-1), 1)) * moves


def chosen_records(psd: xr.Dataset) -> list[int]:
    """Return up to three records: the lowest and the highest load that were fitted, and the
    held-out one that disagrees most.
    """
    load, gap = psd["load"].values, _gap(psd).max(axis=-1)
    held = np.array([str(value) == "holdout" for value in psd["split"].values])
    fitted = np.flatnonzero(~held)
    order = [int(row) for row in fitted[np.argsort(load[fitted])]]
    chosen = [*order[:1], *order[-1:]]
    if held.any():
        chosen.append(int(np.argmax(np.where(held, gap, -np.inf))))
    return list(dict.fromkeys(chosen))[:MOST_RECORDS]


def chosen_channels(psd: xr.Dataset) -> list[int]:
    """Return up to two channels, those that disagree most."""
    order = np.argsort(-np.sqrt(np.mean(_gap(psd) ** 2, axis=0)), kind="stable")
    return [int(channel) for channel in order[:CHANNELS_SHOWN]]


def _panel(sheet, axes, psd, record, channel, completed):
    """Draw one record and channel."""
    name, sensor = (
        str(psd[f"{kind}_name"].values[number])
        for kind, number in (("record", record), ("channel", channel))
    )
    held = " (held out)" if str(psd["split"].values[record]) == "holdout" else ""
    unit = psd["load"].attrs.get("units", "N")
    load = float(psd["load"].values[record])
    axes.set_title(f"{sensor}\n{name}{held}\n{load:.3g} {unit} RMS", fontsize=8.5)
    column = PSD_COLUMNS.get(SI_UNITS.get(_kind(psd, channel), ""), "psd_unit2_per_Hz")
    frequency = psd["frequency"].values.astype(float)
    values = psd["psd"].values[:, record, channel].astype(float)
    shown = (frequency >= LOWEST_HZ) & (frequency <= PASSED * frequency[-1])
    rows = [(0, "measured", BLACK), (1, AS_GIVEN, COLOURS[AS_GIVEN])]
    rows += [(2, COMPLETED, COLOURS[COMPLETED])] if completed else []
    for row, label, colour in rows:
        sheet.line(
            axes,
            ("frequency_Hz", frequency[shown]),
            (column, values[row][shown]),
            label,
            tags={"record": name, "channel": sensor},
            color=colour,
            linewidth=1.6 if row == 0 else 1.0,
            linestyle="--" if label == AS_GIVEN else "-",
            label=label,
            zorder=2 + row,
        )
    axes.set_xscale("log")
    axes.set_yscale("log")
    drawn = values[[row for row, _, _ in rows]][:, shown]
    largest = np.nanmax(drawn)
    if largest > 0.0:
        least = np.nanmin(np.where(drawn > 0.0, drawn, np.nan))
        axes.set_ylim(0.5 * max(least, BELOW * largest), 2.0 * largest)


def _kind(psd, channel):
    """Return the kind of a channel, empty where it is not known."""
    return str(psd["channel_kind"].values[channel]) if "channel_kind" in psd else ""
