"""A first look at a campaign: PSD of all signals at every level, and RMS against load."""

from dataclasses import replace

import numpy as np

from vibroimpact.campaign.file import force_units, with_no_force
from vibroimpact.campaign.force_kinds import BASE, FORCE, unit_kinds
from vibroimpact.campaign.signals import Averaging, campaign_signals, transfer_band
from vibroimpact.identify.spectra.welch import psd_statistics, segment_spectra
from vibroimpact.io.units import UnitError, si_unit

from .plot import Axis, Panel, Plot, Series, Span, in_rows
from .style import BLACK, BLUE, BROWN, GREEN, GREY, ORANGE, PINK, RED, SKY, ordered_colours

MOST_PANELS = 12
ACROSS = 3
BINS_PER_OCTAVE = 48
SEGMENTS = 12
FORCE_FLOOR, LOWEST = 1e-6, 1e-12  # lowest drawn value, over the highest
PSD_COLUMNS = {
    "m s-2": "psd_m2_per_s4_per_Hz",
    "m s-1": "psd_m2_per_s2_per_Hz",
    "m": "psd_m2_per_Hz",
    "N": "psd_N2_per_Hz",
    "V": "psd_V2_per_Hz",
    "1": "psd_1_per_Hz",
}
LOADS = {FORCE: "load_rms_N", BASE: "load_rms_m_per_s2"}
CURVES = (BLUE, ORANGE, GREEN, RED, PINK, BLACK, SKY, BROWN, GREY)
MARKERS = "os^Dv<>PX"


def quicklook(campaign):
    """Return the Plot of a campaign Dataset, in SI units.

    There is a panel for each of the first 12 forces and responses, and one of the levels.
    """
    campaign = with_no_force(campaign)
    measured = campaign_signals(campaign)
    panels = [
        ("force", index, name, _shown_unit(force_units(campaign, index), kind))
        for index, (name, kind) in enumerate(
            zip(measured.forces, unit_kinds(campaign), strict=True)
        )
    ]
    units = map(str, campaign["channel_units"].values)
    panels += [
        ("response", index, name, _shown_unit(unit, measured.kinds[index]))
        for index, (name, unit) in enumerate(zip(measured.channels, units, strict=True))
    ]
    left_out, panels = panels[MOST_PANELS:], panels[:MOST_PANELS]
    colours = ordered_colours(
        [load if np.isfinite(load) and load > 0.0 else 1.0 for load in measured.load_rms]
    )
    band = transfer_band(measured)
    drawn = {
        f"{role} {name}": _spectra(measured, (role, index, name, unit), colours, band)
        for role, index, name, unit in panels
    }
    rows = in_rows([*drawn, "levels"], ACROSS)
    duration = max(signal.shape[-1] for signal in measured.force) / measured.rate
    title = (
        f"{len(measured.records)} records of up to {duration:.3g} s at {measured.rate:g} Hz:"
        f" {len(measured.forces)} force{'s' if len(measured.forces) > 1 else ''},"
        f" {len(measured.channels)} responses"
    )
    source = str(campaign.attrs.get("source", "")) or "no source given"
    hidden = f" Not shown: {', '.join(name for _, _, name, _ in left_out)}." if left_out else ""
    caption = (
        f"Campaign: {source}. PSD of each force and response in SI units, Hann windows, mean power"
        f" in bins of 1/{BINS_PER_OCTAVE} octave, one curve per record, light for high loads;"
        " dashed: held out. The shaded band is that of the force, or that stated by the file."
        " Last panel: RMS of each response about its mean over that at the lowest level; a linear"
        f" structure follows the grey line.{hidden}"
    )
    return Plot(
        "quicklook",
        title,
        caption,
        {**drawn, "levels": _levels(measured)},
        rows,
        (12.0, 0.9 + 2.5 * len(rows)),
        legend=4,
    )


def _drive(measured):
    """Return the kind of the first force channel; that of a force if none was measured."""
    return (*measured.force_kinds, FORCE)[0]


def _shown_unit(units, kind):
    """Return the SI unit of a channel, or its stored unit if that can not be converted."""
    try:
        return si_unit(units, kind)
    except UnitError:
        return units or "no unit"


def _spectra(measured, signal, colours, band):
    """Return the Panel of the PSDs of one force or response, record by record.

    signal: ("force" or "response", index, name, unit).
    """
    role, index, name, unit = signal
    load_unit = "m/s²" if _drive(measured) == BASE else "N"
    lowest, highest, items = np.inf, 0.0, []
    for record in np.argsort(measured.load_rms, kind="stable"):
        values = getattr(measured, role)[record][index]
        if not np.isfinite(values).all() or values.size < 64 or not values.any():
            continue
        frequency, psd = _binned(values, measured.rate, band)
        load, record_name = measured.load_rms[record], measured.records[record]
        held = measured.splits[record] == "holdout"
        tags = {LOADS[_drive(measured)]: float(load), "split": measured.splits[record]}
        driven = f"{load:.3g} {load_unit} RMS" if measured.forces else "no force"
        look = {"colour": colours.get(load, BLACK), "width": 0.9, "line": "--" if held else "-"}
        look["label"] = f"{record_name} ({driven}{', held out' if held else ''})"
        items.append(Series(record_name, frequency, psd, tags, **look))
        lowest, highest = min(lowest, np.percentile(psd, 3)), max(highest, psd.max())
    level = Axis(PSD_COLUMNS.get(unit, "psd_unit2_per_Hz"), True)
    if highest > 0.0:
        floor = (FORCE_FLOOR if role == "force" else LOWEST) * highest
        level = replace(level, low=max(0.3 * lowest, floor), high=3.0 * highest)
        items += [Span("x", *band, SKY, 0.12)] if band is not None else []
    kind = "" if role == "force" else ", " + measured.kinds[index].replace("_", " ")
    title = f"{name}{kind}, {unit}"
    return Panel(Axis("frequency_Hz", True), level, items, title, "holes in every record")


def _binned(values, rate, band):
    """Return (frequency, PSD) in logarithmic bins.

    They begin at a third of the lowest excited frequency.
    """
    segment_s = values.size / rate / (0.5 * SEGMENTS + 0.5)
    spectra = segment_spectra(values - values.mean(), rate, Averaging(segment_s))
    psd = psd_statistics(spectra.values)[0][0]
    first = max(spectra.frequency[1], (band[0] if band else spectra.frequency[1]) / 3.0)
    place = np.floor(np.log2(np.maximum(spectra.frequency, 1e-9) / first) * BINS_PER_OCTAVE)
    kept = spectra.frequency >= first
    _, inverse, counts = np.unique(place[kept], return_inverse=True, return_counts=True)
    middle, mean = (np.bincount(inverse, of[kept]) / counts for of in (spectra.frequency, psd))
    return middle, np.maximum(mean, np.finfo(float).tiny)


def _levels(measured):
    """Return the Panel of the RMS of every response over its RMS at the lowest level, by load."""
    order = np.argsort(measured.load_rms, kind="stable")
    loads, items = measured.load_rms[order], []
    for index, name in enumerate(measured.channels if measured.forces else ()):
        rms = np.array([np.std(measured.response[record][index]) for record in order])
        if np.isfinite(rms[0]) and rms[0] > 0.0:
            look = {"colour": CURVES[index % len(CURVES)], "marker": MARKERS[index % len(MARKERS)]}
            items.append(Series(name, loads, rms / rms[0], line="", alpha=0.85, label=name, **look))
    axes = Axis(LOADS[_drive(measured)], True), Axis("rms_over_lowest", True)
    if not items or not np.isfinite(loads).all():
        why = "no response without holes" if measured.forces else "no force was measured"
        return Panel(*axes, [], "Levels", why)
    line = np.array([loads[0], loads[-1]])
    items.append(Series("linear", line, line / line[0], colour=GREY, width=1.0, order=0))
    columns = 2 if len(measured.channels) > 6 else 1
    return Panel(*axes, items, "Levels", legend="best", legend_columns=columns)
