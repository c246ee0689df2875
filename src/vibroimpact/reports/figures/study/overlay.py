"""A campaign and the simulation: PSD of acceleration at the response point (figure 5)."""

from typing import Any

import numpy as np

from vibroimpact.campaign.file import SYNTHETIC, channel_at, channel_signal
from vibroimpact.identify.linear.family import LinearFamily, driven_modes
from vibroimpact.identify.spectra.welch import psd_statistics, segment_spectra
from vibroimpact.reports.figures.plot import Axis, Item, Mark, Panel, Plot, Series, in_rows
from vibroimpact.reports.figures.style import BLACK, BLUE, GREEN, RED, gap_label, label_of, shown
from vibroimpact.reports.table import spread_evenly

from .linear_limits import limit_modes, shown_band
from .psd_table import STATISTICS, driven_sensor, inside

LEVELS = 4
ENVELOPE_HZ = 0.5  # width of the blocks whose extremes are drawn; those of bins would hide the rest


def figure_05_overlay(config, model, responses, campaign):
    """Return the Plot of a campaign over the simulation, a panel per load.

    responses: Responses of one gap; campaign: Dataset of campaign.read_campaign.
    """
    sensor = driven_sensor(config, config.identification.response_point)
    records = _shown_records(campaign, responses.gap_m)
    gap = float(campaign["gap"].values[records[0]])
    source = str(campaign.attrs.get("source", "")) or "no source given"
    title = "Synthetic campaign" if source.startswith(SYNTHETIC) else "Campaign"
    caption = (
        f"PSD of acceleration at {sensor} for {len(records)} loads: campaign (green; gap"
        f" {gap_label(config, gap)}; {source}) over the simulation of the study (blue; gap"
        f" {gap_label(config, responses.gap_m)}, nearest load, all seeds). Thick: mean over"
        " segments; thin, dotted: smallest and largest segment (extremes of blocks of"
        f" {ENVELOPE_HZ:g} Hz). Vertical: modes of the driven plane of the tube, free (black,"
        " dashed) and in full contact (red, dashed)."
    )
    at = model.sensor_names.index(sensor)
    place = model.sensor_positions[at], model.sensor_directions[at]
    channel = channel_at(campaign, *place, "acceleration")
    highest_Hz, rate = responses.frequency[-1], float(campaign.attrs["sampling_frequency"])
    band, panels = shown_band(model, highest_Hz), {}
    for record in records:
        load = float(campaign["load_rms"].values[record])
        signal = channel_signal(campaign, record, channel)
        spectra = segment_spectra(signal, rate, config.spectra, highest_Hz)
        statistics = [values[0] for values in psd_statistics(spectra.values)]
        tags = {"load_rms_N": load}
        items = _spectrum(band, spectra.frequency, statistics, "campaign", tags, GREEN)
        nearest, simulated, nearby = _nearest(model, responses, sensor, load)
        same = np.isclose(load, nearest, rtol=0.01)
        name = f"load {load:.3g} N RMS" + ("" if same else f"; simulation {nearest:.3g} N RMS")
        items += nearby
        panels[f"record {record}"] = _panel(model, responses.frequency, simulated, items, name)
    return _in_pairs(f"{title} over simulation", caption, panels)


def _in_pairs(title, caption, panels):
    """Return the Plot of panels, two side by side."""
    rows = in_rows(list(panels), min(2, len(panels)))
    size = (9.0, 0.6 + 3.0 * len(rows))
    return Plot("figure_05_overlay", title, caption, panels, rows, size, share="x", legend=3)


def _panel(model, frequency, statistics, items, title):
    """Return the Panel of items and of the modes of the driven plane, free and in full contact.

    Its axes show the band of (mean, smallest, largest) PSDs.
    """
    band = shown_band(model, frequency[-1])
    for (name, values), colour in zip(limit_modes(model, band), (BLACK, RED), strict=True):
        look: dict[str, Any] = {"colour": colour, "line": "--", "width": 0.9, "order": 0}
        for index, value in enumerate(values):
            items.append(Mark(name, "x", value, label="" if index else name, **look))
    kept = inside(frequency, band)
    lowest, highest = np.percentile(statistics[0][kept], 1.0), statistics[2][kept].max()
    level = Axis("psd_m2_per_s4_per_Hz", True, 0.01 * lowest, 3.0 * highest)
    return Panel(Axis("frequency_Hz", False, *band), level, items, title)


def _nearest(model, responses, sensor, load):
    """Return (nearest load of a simulation, its mean, smallest and largest PSD of acceleration, the
    items that draw them).
    """
    at = int(np.argmin(np.abs(np.log(responses.load / load))))
    nearest, frequency = responses.load[at], responses.frequency
    psds = [responses.psd["acceleration", sensor, name][at] for name in STATISTICS]
    band, tags = shown_band(model, frequency[-1]), {"load_rms_N": nearest}
    return nearest, psds, _spectrum(band, frequency, psds, "simulation", tags, BLUE)


def _shown_records(campaign, gap_m):
    """Return up to LEVELS record indices of ascending load, one per load.

    They are at the gap of the campaign nearest to gap_m.
    """
    gaps, loads = campaign["gap"].values, campaign["load_rms"].values
    distance = np.where(np.isfinite(gaps), np.abs(gaps - gap_m), 0.0)
    same_gap = np.flatnonzero(np.isclose(distance, distance.min()))
    by_load = {round(float(np.log(loads[index])), 2): int(index) for index in same_gap[::-1]}
    return spread_evenly([by_load[key] for key in sorted(by_load)], LEVELS)


def _spectrum(band, frequency, statistics, curve, tags, colour) -> list[Item]:
    """Return mean, smallest and largest PSD (frequency,) in (m/s²)²/Hz inside a band."""
    kept = inside(frequency, band)
    frequency, (mean, low, high) = frequency[kept], (psd[kept] for psd in statistics)
    look: dict[str, Any] = {"colour": colour, "width": 0.8}
    items: list[Item] = [
        Series(f"{curve}, mean", frequency, mean, tags, label=curve, order=3, **look)
    ]
    steps = max(1, round(ENVELOPE_HZ / (frequency[1] - frequency[0])))
    starts = np.arange(0, frequency.size, steps)
    middle = np.add.reduceat(frequency, starts) / np.diff([*starts, frequency.size])
    look |= {"line": ":", "alpha": 0.8}
    for name, psd, combine in (("smallest", low, np.minimum), ("largest", high, np.maximum)):
        label = f"{curve}, extreme segments" if name == "smallest" else ""
        extremes, name = combine.reduceat(psd, starts), f"{curve}, {name} segment"
        items.append(Series(name, middle, extremes, tags, label=label, **look))
    return items


def figure_05_measured(config, model, measured, supports, simulated=None, level="load_rms_N"):
    """Return the Plot of measured spectra over those of the equivalent linear tube, and of a
    study's simulation if there is one, a panel per load.

    measured, simulated: Responses, the latter of a study of the same tube.
    supports: {load: (k in N/m, c in N s/m, relative PSD (low_frequency,) of the force or None)} of
        the loads at which they are known.
    level: column of the loads; response_rms_m if they are the RMS of the response.
    """
    sensor = driven_sensor(config, config.identification.response_point)
    band = shown_band(model, measured.frequency[-1])
    fitted, unit = config.identification.broadband.band_Hz, label_of(level).partition(" (")
    panels = {}
    for index in spread_evenly(range(measured.load.size), LEVELS):
        load = float(measured.load[index])
        psds = [measured.psd["acceleration", sensor, name][index] for name in STATISTICS]
        items = _spectrum(band, measured.frequency, psds, "measured", {level: load}, GREEN)
        if simulated is not None:
            (name,) = {sensor for _, sensor, _ in simulated.psd}
            items += _nearest(model, simulated, name, load)[2]
        if load in supports:
            mean = measured.frequency, psds[0]
            items.append(_equivalent_line(model, sensor, mean, fitted, supports[load]))
        title = f"{unit[0].lower()} {shown(level, load):.3g} {unit[2].rstrip(')')}"
        panels[f"level {index}"] = _panel(model, measured.frequency, psds, items, title)
    beside = " Blue: simulation of the study at the nearest load." if simulated else ""
    caption = (
        f"PSD of acceleration at {sensor.rpartition('.')[0]}, gap"
        f" {gap_label(config, measured.gap_m)}: measured (green;"
        " thick: mean over segments and records, dotted: smallest and largest segment). Black: the"
        " linear tube on its equivalent support in the band of the broadband comparison, its level"
        f" fitted.{beside} Vertical: modes of the"
        " driven plane of the tube, free (black, dashed) and held at the supports (red, dashed)."
    )
    return _in_pairs("Measured spectra over the equivalent linear tube", caption, panels)


def _equivalent_line(model, sensor, measured, band, support):
    """Return the PSD of the linear tube on a support (k, c, PSD of the force), its level fitted.

    measured: (frequency in Hz, mean PSD). band: of the fit, in Hz.
    """
    (frequency, mean), (k, c, force) = measured, support
    kept = inside(frequency, band)
    frequency, mean = frequency[kept], mean[kept]
    shape = model.sensor_shapes[:, [model.sensor_names.index(sensor)]]
    response = LinearFamily(driven_modes(model), frequency).response(shape)
    psd = response.psd(k, c)[0] * (2.0 * np.pi * frequency) ** 4
    if force is not None:
        psd = psd * np.interp(frequency, force["low_frequency"].values, force.values)
    name = "linear tube on the equivalent support"
    level = psd * np.exp(np.mean(np.log(mean / psd)))
    return Series(name, frequency, level, {"k_N_per_m": k}, label=name, width=1.0, order=4)
