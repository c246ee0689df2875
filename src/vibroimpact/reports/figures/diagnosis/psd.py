"""Measured spectra and those of free runs, with the model as given and completed."""

from dataclasses import replace

import numpy as np
import xarray as xr

from vibroimpact.diagnosis.verdict.content import Verdict
from vibroimpact.io.units import SI_OF_KIND
from vibroimpact.reports.figures.plot import Axis, Panel, Plot, Series
from vibroimpact.reports.figures.quicklook import PSD_COLUMNS
from vibroimpact.reports.figures.sheet import WIDTH_IN
from vibroimpact.reports.figures.style import BLACK

from .states import AS_GIVEN, COLOURS, COMPLETED

MOST_RECORDS, CHANNELS_SHOWN = 3, 2
BELOW = 1.0e-8  # of the largest PSD: the lowest drawn
LOWEST = 1.0e-5  # of the peak of a measured PSD: a lower one is no response
LOWEST_HZ, PASSED = 1.0, 0.78  # drawn from; of the highest line, which a filter has passed

CAPTION = (
    "PSD, measured (black) and of free runs under the measured force, not held to any sensor: with"
    " the model as given (orange, dashed) and with the completed one (blue). Records: the lowest"
    " and the highest that was fitted, and the held-out one that disagrees most; channels: those"
    " that disagree most."
)


def psd_figure(psd: xr.Dataset, verdict: Verdict) -> Plot:
    """Return the Plot with a row per channel and a column per record, for those that matter most.

    psd: variable psd (state: measured, before, after; record, channel, frequency) in unit²/Hz, NaN
    of a run that failed, with frequency in Hz, load, record_name, split (record,), channel_name,
    channel_kind (channel,) and compared (record, channel), 1 or 0.
    """
    records, channels = chosen_records(psd), chosen_channels(psd)
    completed = bool(verdict.shown_effects())
    rows = [[f"{record} {channel}" for record in records] for channel in channels]
    panels = {
        f"{record} {channel}": _panel(psd, record, channel, completed)
        for channel in channels
        for record in records
    }
    title, apart = "Spectra of free runs", verdict.misfit.holdout
    if apart is not None and apart.before_dB is not None:
        told = [apart.before_dB, *([apart.after_dB] if completed else [])]
        words = " → ".join(f"{value:.2g} dB" for value in told if value is not None)
        floor = f", floor {apart.floor_dB:.2g} dB" if apart.floor_dB is not None else ""
        title = f"{title}, held out: {words} off{floor}"
    size = (min(1.0 + 2.9 * len(records), WIDTH_IN), 1.3 + 2.4 * len(channels))
    return Plot("diagnosis_psd", title, CAPTION, panels, rows, size, share="x", legend=3)


def _gap(psd):
    """Return (record, channel) dB: RMS of measured over simulated PSD with the model as given, at
    lines above LOWEST of the measured peak; 0 where they are not compared.
    """
    values = np.maximum(psd["psd"].values[:2].astype(float), np.finfo(float).tiny)
    apart = 10.0 * np.log10(values[0] / values[1])
    counted = np.isfinite(apart) & (values[0] > LOWEST * values[0].max(axis=-1, keepdims=True))
    sums = np.sum(np.where(counted, apart, 0.0) ** 2, axis=-1)
    return np.sqrt(sums / np.maximum(counted.sum(axis=-1), 1)) * psd["compared"].values


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


def _panel(psd, record, channel, completed):
    """Return the Panel of one record and channel."""
    name, sensor = (
        str(psd[f"{kind}_name"].values[number])
        for kind, number in (("record", record), ("channel", channel))
    )
    held = " (held out)" if str(psd["split"].values[record]) == "holdout" else ""
    unit = psd["load"].attrs.get("units", "N")
    load = float(psd["load"].values[record])
    frequency = psd["frequency"].values.astype(float)
    shown = (frequency >= LOWEST_HZ) & (frequency <= PASSED * frequency[-1])
    values = psd["psd"].values[:, record, channel].astype(float)[:, shown]
    curves = [("measured", BLACK), (AS_GIVEN, COLOURS[AS_GIVEN])]
    curves += [(COMPLETED, COLOURS[COMPLETED])] if completed else []
    items = []
    for row, (label, colour) in enumerate(curves):
        look = {"label": label, "colour": colour, "line": "--" if label == AS_GIVEN else "-"}
        look |= {"width": 1.0 if row else 1.6, "order": 2 + row}
        tags = {"record": name, "channel": sensor}
        items.append(Series(label, frequency[shown], values[row], tags, **look))
    drawn = values[: len(curves)]
    unit_SI = SI_OF_KIND.get(str(psd["channel_kind"].values[channel]), "")
    level = Axis(PSD_COLUMNS.get(unit_SI, "psd_unit2_per_Hz"), True)
    largest = np.nanmax(drawn)
    if largest > 0.0:
        least = max(np.nanmin(np.where(drawn > 0.0, drawn, np.nan)), BELOW * largest)
        level = replace(level, low=0.5 * least, high=2.0 * largest)
    title = f"{sensor}\n{name}{held}\n{load:.3g} {unit} RMS"
    return Panel(Axis("frequency_Hz", True), level, items, title)
