"""Responses against load: maps (figures 6 and 8), PSDs (figure 7), and the in-plane share."""

from __future__ import annotations

import numpy as np
from matplotlib.cm import ScalarMappable

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import (
    BLACK,
    GAP_COLOURS,
    GAP_MARKERS,
    ORANGE,
    ORDERED,
    PALE,
    gap_label,
    number,
    ordered_colours,
    ordered_norm,
)
from vibroimpact.geometry.sections import outer_width
from vibroimpact.linear.responses import psd_family

from .linear_limits import contact_stiffness, linear_modes, shown_band
from .psd_table import driven_sensor, unit_force_psd
from .seed_scatter import over_seeds

FREE_K = 1.0  # N/m, the paper's lower bound
DYNAMIC_RANGE_DB = 75.0  # of the colour maps
LOWEST_SHARE_DB = -100.0  # below it is the effect of the seeded imperfection alone
LINEAR_STIFFNESS_STEPS = 90


def figure_06_levels(config, model, responses, level="load_rms_N"):
    """Return the Sheet of PSD / load² over frequency and load, at two points.

    They are the response point and the broadband point.

    level: column of the loads; response_rms_m where they are the RMS of the response.
    """
    word, column = {
        "load_rms_N": ("load", "psd_dB"),
        "response_rms_m": ("response", "psd_per_response2_dB"),
    }[level]
    points = list(
        dict.fromkeys((config.identification.response_point, config.identification.broadband.point))
    )
    caption = (
        f"PSD of displacement divided by the square of the {word}, over frequency and {word},"
        f" {_gap_words(config, responses)}, mean over segments and seeds. Where the tube is linear"
        f" a column has one colour; peaks that move to the right with the {word} show the"
        " stiffening by contact. Triangles: modes of the driven plane of the free tube (bottom) and"
        " in full bilateral contact (top)."
    )
    sheet = Sheet(
        "figure_06_levels",
        f"Peaks of the response against {'load' if word == 'load' else 'its level'}",
        caption,
        [points],
        size=(7.6, 4.4),
        sharey=True,
    )
    band = shown_band(model, responses.frequency[-1])
    kept = _inside(responses.frequency, band)
    psd = {
        point: responses.psd["displacement", driven_sensor(config, point), "mean"][:, kept]
        for point in points
    }
    levels = {
        point: _decibels(values / responses.load[:, None] ** 2) for point, values in psd.items()
    }
    top = max(values.max() for values in levels.values())
    for point, values in levels.items():
        axes = sheet.axes[point]
        axes.set_title(driven_sensor(config, point))
        mesh = sheet.map(
            axes,
            ("frequency_Hz", responses.frequency[kept]),
            (level, responses.load),
            (column, values),
            f"mean PSD / {word}²",
            vmin=top - DYNAMIC_RANGE_DB,
            vmax=top,
        )
        _mark_modes(sheet, axes, model, band)
        axes.label_outer()
    _legend_of_modes(sheet, axes)
    sheet.colour_bar(mesh, list(sheet.axes.values()), column, extend="min")
    return [sheet]


def figure_07_overlay_of_loads(config, model, responses):
    """Return the Sheet of PSD / load² at the broadband point for all loads.

    The linear responses at both ends are drawn with them.
    """
    sensor = driven_sensor(config, config.identification.broadband.point)
    stiff = contact_stiffness(model)
    caption = (
        f"PSD of displacement at {sensor} divided by the square of the load, all loads,"
        f" {_gap_words(config, responses)}, mean over segments and seeds (colour: load). Black:"
        f" linear tube with bilateral supports of k = {FREE_K:g} N/m (dashed) and k = {stiff:.3g}"
        " N/m (solid) under the same force. Low loads follow the first, high loads approach the"
        " second, with wider peaks and without its anti-resonances."
    )
    sheet = Sheet(
        "figure_07_overlay_of_loads",
        "Spectra of all loads between the linear limits",
        caption,
        size=(7.6, 4.6),
    )
    axes = sheet.axes["main"]
    axes.set_title(f"{sensor}, PSD of displacement / load²")
    band = shown_band(model, responses.frequency[-1])
    kept = _inside(responses.frequency, band)
    frequency = responses.frequency[kept]
    colours = ordered_colours(responses.load)
    for load, psd in zip(
        responses.load, responses.psd["displacement", sensor, "mean"], strict=True
    ):
        sheet.line(
            axes,
            ("frequency_Hz", frequency),
            ("psd_per_load2_m2_per_N2_per_Hz", psd[kept] / load**2),
            "non-linear",
            tags={"load_rms_N": load},
            color=colours[load],
            linewidth=0.9,
            alpha=0.9,
        )
    shape = model.sensor_shapes[:, model.sensor_names.index(sensor)]
    force = unit_force_psd(config, frequency)
    force[force == 0.0] = np.nan  # without force there is no linear line to draw
    for k, dash in ((FREE_K, (0, (4, 2))), (stiff, "-")):
        psd = psd_family(model, [k], [0.0], frequency, shape)[0, 0] * force
        sheet.line(
            axes,
            ("frequency_Hz", frequency),
            ("psd_per_load2_m2_per_N2_per_Hz", psd),
            "linear",
            tags={"k_N_per_m": k},
            color=BLACK,
            linestyle=dash,
            linewidth=1.3,
            label=f"linear, k = {number(k)} N/m",
            zorder=5,
        )
    axes.set_yscale("log")
    axes.set_xlim(band)
    levels = responses.psd["displacement", sensor, "mean"][:, kept] / responses.load[:, None] ** 2
    axes.set_ylim(max(0.1 * levels.min(), 1e-13 * levels.max()), 4.0 * levels.max())
    sheet.legend(axes, loc="upper right")
    _load_bar(sheet, axes, responses.load)
    return [sheet]


def figure_08_load_and_stiffness(config, model, responses):
    """Return the Sheet of the non-linear PSD against load and the linear PSD against stiffness."""
    sensor = driven_sensor(config, config.identification.broadband.point)
    caption = (
        f"PSD of displacement at {sensor} divided by the square of the load. Left: simulated with"
        f" contact, against the load, {_gap_words(config, responses)}, mean over segments and"
        " seeds. Right: linear tube with a bilateral support, against its stiffness (no damping"
        " added). The peaks take the same way; with contact they are wider and the anti-resonances"
        " (dark) fade. Same colours on both sides. Triangles: modes of the driven plane of the"
        " free tube (bottom) and in full contact (top)."
    )
    sheet = Sheet(
        "figure_08_load_and_stiffness",
        "Load with contact beside stiffness without",
        caption,
        [["load", "stiffness"]],
        size=(7.6, 4.4),
    )
    band = shown_band(model, responses.frequency[-1])
    kept = _inside(responses.frequency, band)
    frequency = responses.frequency[kept]
    measured = _decibels(
        responses.psd["displacement", sensor, "mean"][:, kept] / responses.load[:, None] ** 2
    )
    stiffness = np.geomspace(
        0.1 * config.identification.stiffness_range_N_per_m[0],
        2.5 * contact_stiffness(model),
        LINEAR_STIFFNESS_STEPS,
    )
    shape = model.sensor_shapes[:, model.sensor_names.index(sensor)]
    coarse = frequency[::2]
    linear = psd_family(model, stiffness, [0.0], coarse, shape)[:, 0] * unit_force_psd(
        config, coarse
    )
    top = measured.max()
    sides = (
        (
            "load",
            "non-linear, against the load",
            ("load_rms_N", responses.load),
            frequency,
            measured,
        ),
        (
            "stiffness",
            "linear, against the bilateral stiffness",
            ("support_stiffness_N_per_m", stiffness),
            coarse,
            _decibels(linear),
        ),
    )
    for name, title, vertical, across, values in sides:
        axes = sheet.axes[name]
        axes.set_title(title)
        mesh = sheet.map(
            axes,
            ("frequency_Hz", across),
            vertical,
            ("psd_dB", values),
            "PSD / load²",
            vmin=top - DYNAMIC_RANGE_DB,
            vmax=top,
        )
        _mark_modes(sheet, axes, model, band)
    _legend_of_modes(sheet, axes)
    sheet.colour_bar(mesh, list(sheet.axes.values()), "psd_dB", extend="both")
    return [sheet]


def in_plane_share(config, responses):
    """Return the Sheet of the in-plane share of the motion against load, for every gap."""
    caption = (
        "Mean square of the displacement in the other sensor directions over that in the driven"
        f" one, at {config.identification.response_point}, against load over gap: median and range"
        " over seeds. The drive acts out of the plane only; below contact the share is that of the"
        " seeded imperfection alone (nothing), from a level on the motion leaves its plane by"
        " itself because contact turns it."
    )
    sheet = Sheet(
        "in_plane_share",
        "Motion across the driven direction",
        caption,
        size=(7.6, 4.2),
    )
    axes = sheet.axes["main"]
    point = config.identification.response_point
    axes.set_title(f"in-plane share of the displacement at {point}")
    rows = [row for row in responses.share if row["point"] == point]
    diameter = outer_width(config.structure.section)
    for index, gap in enumerate(sorted({row["gap_m"] for row in rows}, reverse=True)):
        chosen = [
            {**row, "load_over_gap_N_per_m": row["load_rms_N"] / gap}
            for row in rows
            if row["gap_m"] == gap
        ]
        over_seeds(
            sheet,
            axes,
            chosen,
            "load_over_gap_N_per_m",
            "in_plane_share_dB",
            "in-plane share",
            tags=("gap_m", "load_rms_N"),
            color=GAP_COLOURS[index % len(GAP_COLOURS)],
            marker=GAP_MARKERS[index % len(GAP_MARKERS)],
            label=f"gap {gap_label(gap, diameter)}",
        )
    if not rows:
        sheet.note(
            axes, "sensors in one direction only", "load_over_gap_N_per_m", "in_plane_share_dB"
        )
    axes.set_xscale("log")
    axes.set_ylim(bottom=max(axes.get_ylim()[0], LOWEST_SHARE_DB))
    sheet.legend(axes, loc="lower right")
    return [sheet]


def _gap_words(config, responses):
    return f"gap {gap_label(responses.gap_m, outer_width(config.structure.section))}"


def _inside(frequency, band):
    """Return (frequency,) bool of the bins in a band, the zero bin left out."""
    return (frequency >= band[0]) & (frequency <= band[1]) & (frequency > 0.0)


def _decibels(values):
    """Return 10 log10 of positive values; 0 (no force there) becomes a level far below the rest."""
    return 10.0 * np.log10(np.maximum(values, np.finfo(float).tiny))


def _mark_modes(sheet, axes, model, band):
    """Mark the modes of the driven plane: free below a map, in full contact above it."""
    for name, k, height, style in (
        ("free modes", 0.0, 0.012, {"marker": "^", "color": "white"}),
        (
            "modes in full contact",
            contact_stiffness(model),
            0.988,
            {"marker": "v", "color": ORANGE},
        ),
    ):
        values = linear_modes(model, k, 12)
        values = values[(values > band[0]) & (values < band[1])]
        sheet.record(axes, name, frequency_Hz=values)
        axes.plot(
            values,
            np.full(values.size, height),
            transform=axes.get_xaxis_transform(),
            linestyle="none",
            markersize=7,
            markeredgecolor=BLACK,
            markeredgewidth=0.6,
            clip_on=False,
            zorder=6,
            label=name,
            **style,
        )


def _legend_of_modes(sheet, axes):
    """Add the legend of the marks of a map, beside the title of the figure."""
    handles, labels = axes.get_legend_handles_labels()
    sheet.figure.legend(handles, labels, loc="upper right", ncols=2, facecolor=PALE, framealpha=1.0)


def _load_bar(sheet, axes, loads):
    """Add the colour bar of curves coloured by load."""
    return sheet.colour_bar(ScalarMappable(ordered_norm(loads), ORDERED), axes, "load_rms_N")
