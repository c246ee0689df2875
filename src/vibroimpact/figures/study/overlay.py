"""A campaign and the simulation: PSD of acceleration at the response point (figure 5)."""

from __future__ import annotations

import numpy as np

from vibroimpact.campaign.file import SYNTHETIC, channel_at, channel_signal
from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import BLACK, BLUE, GREEN, RED, gap_label, label_of, shown
from vibroimpact.geometry.sections import outer_width
from vibroimpact.linear.responses import response_psd
from vibroimpact.spectra.welch import psd_statistics, segment_spectra

from .linear_limits import contact_stiffness, linear_modes, shown_band
from .psd_table import driven_sensor

LEVELS = 4
ENVELOPE_HZ = 0.5  # width of the blocks whose extremes are drawn; those of bins would hide the rest


def figure_05_overlay(config, model, responses, campaign):
    """Return the Sheet of a campaign over the simulation, a panel per load.

    responses: Responses of one gap; campaign: Dataset of campaign.read_campaign.
    """
    sensor = driven_sensor(config, config.identification.response_point)
    records = _shown_records(campaign, responses.gap_m)
    gap = float(campaign["gap"].values[records[0]])
    diameter = outer_width(config.structure.section)
    source = str(campaign.attrs.get("source", "")) or "no source given"
    title = "Synthetic campaign" if source.startswith(SYNTHETIC) else "Campaign"
    caption = (
        f"PSD of acceleration at {sensor} for {len(records)} loads: campaign (green; gap"
        f" {gap_label(gap, diameter)}; {source}) over the simulation of the study (blue; gap"
        f" {gap_label(responses.gap_m, diameter)}, nearest load, all seeds). Thick: mean over"
        " segments; thin, dotted: smallest and largest segment (extremes of blocks of"
        f" {ENVELOPE_HZ:g} Hz). Vertical: modes of the driven plane of the tube, free (black,"
        " dashed) and in full contact (red, dashed)."
    )
    keys = [f"record {index}" for index in records]
    mosaic = [keys[row : row + 2] for row in range(0, len(keys), 2)]
    if len(mosaic[-1]) < len(mosaic[0]):
        mosaic[-1].append(".")
    sheet = Sheet(
        "figure_05_overlay",
        f"{title} over simulation",
        caption,
        mosaic,
        size=(9.0, 0.6 + 3.0 * len(mosaic)),
        sharex=True,
    )
    position, direction = (
        array[model.sensor_names.index(sensor)]
        for array in (model.sensor_positions, model.sensor_directions)
    )
    channel = channel_at(campaign, position, direction, "acceleration")
    for key, record in zip(keys, records, strict=True):
        _panel(sheet, sheet.axes[key], config, model, responses, (campaign, record, channel))
    for place, key in enumerate(keys):
        lowest = place >= len(keys) - 2
        sheet.axes[key].set_xlabel(label_of("frequency_Hz") if lowest else "")
        sheet.axes[key].tick_params(labelbottom=lowest)
    for row in mosaic:
        for key in row[1:]:
            if key in sheet.axes:
                sheet.axes[key].set_ylabel("")
    handles, labels = sheet.axes[keys[0]].get_legend_handles_labels()
    sheet.figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return [sheet]


def _panel(sheet, axes, config, model, responses, measured):
    """Draw one record, (campaign, record, channel), over the simulation of the nearest load."""
    campaign, record, channel = measured
    sensor = driven_sensor(config, config.identification.response_point)
    frequency = responses.frequency
    band = shown_band(model, frequency[-1])
    load = float(campaign["load_rms"].values[record])
    nearest = int(np.argmin(np.abs(np.log(responses.load / load))))
    rate = float(campaign.attrs["sampling_frequency"])
    spectra = segment_spectra(
        channel_signal(campaign, record, channel), rate, config.spectra, frequency[-1]
    )
    statistics = [values[0] for values in psd_statistics(spectra.values)]
    _spectrum(
        sheet, axes, band, spectra.frequency, statistics, "campaign", {"load_rms_N": load}, GREEN
    )
    simulated = [
        responses.psd["acceleration", sensor, statistic][nearest]
        for statistic in ("mean", "min", "max")
    ]
    _spectrum(
        sheet,
        axes,
        band,
        frequency,
        simulated,
        "simulation",
        {"load_rms_N": responses.load[nearest]},
        BLUE,
    )
    _mark_modes(sheet, axes, model, band)
    same = np.isclose(load, responses.load[nearest], rtol=0.01)
    axes.set_title(
        f"load {load:.3g} N RMS"
        + ("" if same else f"; simulation {responses.load[nearest]:.3g} N RMS")
    )
    axes.set_yscale("log")
    axes.set_xlim(band)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    axes.set_ylim(0.01 * np.percentile(simulated[0][inside], 1.0), 3.0 * simulated[2][inside].max())


def _shown_records(campaign, gap_m):
    """Return up to LEVELS record indices of ascending load, one per load.

    They are at the gap of the campaign nearest to gap_m.
    """
    gaps, loads = campaign["gap"].values, campaign["load_rms"].values
    distance = np.where(np.isfinite(gaps), np.abs(gaps - gap_m), 0.0)
    same_gap = np.flatnonzero(np.isclose(distance, distance.min()))
    by_load = {round(float(np.log(loads[index])), 2): int(index) for index in same_gap[::-1]}
    records = [by_load[key] for key in sorted(by_load)]
    chosen = np.unique(
        np.round(np.linspace(0, len(records) - 1, min(LEVELS, len(records)))).astype(int)
    )
    return [records[index] for index in chosen]


def _spectrum(sheet, axes, band, frequency, statistics, curve, tags, colour):
    """Draw mean, smallest and largest PSD (frequency,) in (m/s²)²/Hz inside a band."""
    kept = (frequency >= band[0]) & (frequency <= band[1])
    frequency, (mean, low, high) = frequency[kept], (psd[kept] for psd in statistics)
    sheet.line(
        axes,
        ("frequency_Hz", frequency),
        ("psd_m2_per_s4_per_Hz", mean),
        f"{curve}, mean",
        tags=tags,
        color=colour,
        linewidth=0.8,
        label=curve,
        zorder=3,
    )
    starts = np.arange(
        0, frequency.size, max(1, round(ENVELOPE_HZ / (frequency[1] - frequency[0])))
    )
    middle = np.add.reduceat(frequency, starts) / np.diff([*starts, frequency.size])
    for name, psd, combine in (("smallest", low, np.minimum), ("largest", high, np.maximum)):
        sheet.line(
            axes,
            ("frequency_Hz", middle),
            ("psd_m2_per_s4_per_Hz", combine.reduceat(psd, starts)),
            f"{curve}, {name} segment",
            tags=tags,
            color=colour,
            linewidth=0.8,
            linestyle=(0, (1, 1)),
            alpha=0.8,
            label=f"{curve}, extreme segments" if name == "smallest" else None,
        )


def _mark_modes(sheet, axes, model, band):
    """Mark the modes of the driven plane, free and in full contact."""
    stiff = contact_stiffness(model)
    for name, k, colour in (("free modes", 0.0, BLACK), ("modes in full contact", stiff, RED)):
        values = [value for value in linear_modes(model, k, 12) if band[0] < value < band[1]]
        for index, value in enumerate(values):
            sheet.mark(
                axes,
                "frequency_Hz",
                value,
                name,
                color=colour,
                linestyle="--",
                linewidth=0.9,
                label=name if index == 0 else None,
                zorder=0,
            )


def figure_05_measured(config, model, measured, supports, simulated=None, level="load_rms_N"):
    """Return the Sheet of measured spectra over those of the equivalent linear tube, and of a
    study's simulation where there is one, a panel per load.

    measured, simulated: Responses, the latter of a study of the same tube.
    supports: {load: (k in N/m, c in N s/m, relative PSD (low_frequency,) of the force or None)} of
        the loads at which they are known.
    level: column of the loads; response_rms_m where they are the RMS of the response.
    """
    sensor = driven_sensor(config, config.identification.response_point)
    chosen = np.unique(
        np.round(np.linspace(0, measured.load.size - 1, min(LEVELS, measured.load.size)))
    ).astype(int)
    keys = [f"level {index}" for index in chosen]
    mosaic = [keys[row : row + 2] for row in range(0, len(keys), 2)]
    if len(mosaic[-1]) < len(mosaic[0]):
        mosaic[-1].append(".")
    sheet = Sheet(
        "figure_05_overlay",
        "Measured spectra over the equivalent linear tube",
        _measured_caption(config, sensor, measured.gap_m, simulated is not None),
        mosaic,
        size=(9.0, 0.6 + 3.0 * len(mosaic)),
        sharex=True,
    )
    for key, index in zip(keys, chosen, strict=True):
        axes, load = sheet.axes[key], float(measured.load[index])
        _measured_panel(sheet, axes, model, sensor, (measured, index), level)
        if simulated is not None:
            _nearest_simulation(sheet, axes, model, simulated, load)
        if load in supports:
            band = config.identification.broadband.band_Hz
            _equivalent_line(sheet, axes, model, sensor, (measured, index, band), supports[load])
        _mark_modes(sheet, axes, model, shown_band(model, measured.frequency[-1]))
        axes.set_title(f"{label_of(level).partition(' (')[0].lower()} {_in_unit(level, load)}")
    named = {}
    for key in keys:  # an equivalent support may be known at one level only
        handles, labels = sheet.axes[key].get_legend_handles_labels()
        named = dict(zip(labels, handles, strict=True)) | named
    sheet.figure.legend(named.values(), named.keys(), loc="outside lower center", ncols=3)
    return [sheet]


def _measured_caption(config, sensor, gap_m, simulated):
    """Return the caption of measured spectra; simulated: whether a study is drawn too."""
    beside = " Blue: simulation of the study at the nearest load." if simulated else ""
    return (
        f"PSD of acceleration at {sensor.rpartition('.')[0]}, gap"
        f" {gap_label(gap_m, outer_width(config.structure.section))}: measured (green;"
        " thick: mean over segments and records, dotted: smallest and largest segment). Black: the"
        " linear tube on its equivalent support in the band of the broadband comparison, its level"
        f" fitted.{beside} Vertical: modes of the"
        " driven plane of the tube, free (black, dashed) and held at the supports (red, dashed)."
    )


def _in_unit(level, value):
    """Return a level with the unit of its axis."""
    return f"{shown(level, value):.3g} {label_of(level).partition(' (')[2].rstrip(')')}"


def _measured_panel(sheet, axes, model, sensor, measured, level):
    """Draw one level of Responses, (Responses, index)."""
    responses, index = measured
    band = shown_band(model, responses.frequency[-1])
    statistics = [
        responses.psd["acceleration", sensor, name][index] for name in ("mean", "min", "max")
    ]
    tags = {level: responses.load[index]}
    _spectrum(sheet, axes, band, responses.frequency, statistics, "measured", tags, GREEN)
    axes.set_yscale("log")
    axes.set_xlim(band)
    inside = (responses.frequency >= band[0]) & (responses.frequency <= band[1])
    mean, largest = statistics[0][inside], statistics[2][inside]
    axes.set_ylim(0.01 * np.percentile(mean, 1.0), 3.0 * largest.max())


def _nearest_simulation(sheet, axes, model, simulated, load):
    """Draw the Responses of a study at the nearest load."""
    nearest = int(np.argmin(np.abs(np.log(simulated.load / load))))
    (name,) = {sensor for _, sensor, _ in simulated.psd}
    statistics = [
        simulated.psd["acceleration", name, each][nearest] for each in ("mean", "min", "max")
    ]
    band = shown_band(model, simulated.frequency[-1])
    tags = {"load_rms_N": simulated.load[nearest]}
    _spectrum(sheet, axes, band, simulated.frequency, statistics, "simulation", tags, BLUE)


def _equivalent_line(sheet, axes, model, sensor, measured, support):
    """Draw the PSD of the linear tube on a support (k, c, PSD of the force), its level fitted.

    measured: (Responses, index of the level, band in Hz).
    """
    responses, index, band = measured
    k, c, force = support
    inside = (responses.frequency >= band[0]) & (responses.frequency <= band[1])
    frequency = responses.frequency[inside]
    shape = model.sensor_shapes[:, [model.sensor_names.index(sensor)]]
    psd = response_psd(model, k, c, frequency, shape, "acceleration")[0]
    if force is not None:
        psd = psd * np.interp(frequency, force["low_frequency"].values, force.values)
    mean = responses.psd["acceleration", sensor, "mean"][index][inside]
    sheet.line(
        axes,
        ("frequency_Hz", frequency),
        ("psd_m2_per_s4_per_Hz", psd * np.exp(np.mean(np.log(mean / psd)))),
        "linear tube on the equivalent support",
        tags={"k_N_per_m": k},
        color=BLACK,
        linewidth=1.0,
        label="linear tube on the equivalent support",
        zorder=4,
    )
