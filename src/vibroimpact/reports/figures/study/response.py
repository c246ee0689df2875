"""Responses against load: maps (figures 6 and 8), PSDs (figure 7), and the in-plane share."""

from typing import Any

import numpy as np

from vibroimpact.reports.figures.plot import (
    Axis,
    ColourBar,
    Map,
    Panel,
    Plot,
    Series,
    Signs,
    extent,
)
from vibroimpact.reports.figures.style import BLACK, ORANGE, gap_label, number, ordered_colours

from .equivalent import looks_of_gaps
from .linear_limits import contact_stiffness, limit_modes, shown_band
from .psd_table import driven_sensor, inside, linear_psds
from .seed_scatter import over_seeds

FREE_K = 1.0  # N/m, the paper's lower bound
DYNAMIC_RANGE_DB = 75.0  # of the colour maps
LOWEST_SHARE_DB = -100.0  # below it is the effect of the seeded imperfection alone
LINEAR_STIFFNESS_STEPS = 90


def figure_06_levels(config, model, responses, level="load_rms_N"):
    """Return the Plot of PSD / load² over frequency and load, at two points.

    They are the response point and the broadband point.

    level: column of the loads; response_rms_m if they are the RMS of the response.
    """
    of_load, asked = level == "load_rms_N", config.identification
    word, column = ("load", "psd_dB") if of_load else ("response", "psd_per_response2_dB")
    points = dict.fromkeys((asked.response_point, asked.broadband.point))
    caption = (
        f"PSD of displacement divided by the square of the {word}, over frequency and {word},"
        f" {_gap_words(config, responses)}, mean over segments and seeds. If the tube is linear,"
        f" a column has one colour; peaks that move to the right with the {word} show the"
        " stiffening by contact. Triangles: modes of the driven plane of the free tube (bottom) and"
        " in full bilateral contact (top)."
    )
    band = shown_band(model, responses.frequency[-1])
    spectra = {point: _per_load2(responses, driven_sensor(config, point), band) for point in points}
    levels = {point: _decibels(values) for point, (_, values) in spectra.items()}
    top = max(values.max() for values in levels.values())
    ends = top - DYNAMIC_RANGE_DB, top
    curve = f"mean PSD / {word}²"
    panels = {
        point: _map_panel(
            level,
            Map(curve, spectra[point][0], responses.load, values, column, *ends),
            _modes(model, band),
            driven_sensor(config, point),
        )
        for point, values in levels.items()
    }
    title = f"Peaks of the response against {'load' if of_load else 'its level'}"
    bars = [ColourBar(column, *ends, ends="min")]
    look = {"size": (7.6, 4.4), "share": "y", "legend": 2, "colour_bars": bars}
    return Plot("figure_06_levels", title, caption, panels, **look)


def figure_07_overlay_of_loads(config, model, responses):
    """Return the Plot of PSD / load² at the broadband point for all loads.

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
    band, loads = shown_band(model, responses.frequency[-1]), responses.load
    frequency, levels = _per_load2(responses, sensor, band)
    colours, items = ordered_colours(loads), []
    for load, psd in zip(loads, levels, strict=True):
        look = {"colour": colours[load], "width": 0.9, "alpha": 0.9}
        items.append(Series("non-linear", frequency, psd, {"load_rms_N": load}, **look))
    for k, line in ((FREE_K, "--"), (stiff, "-")):
        (psd,) = linear_psds(config, model, sensor, [k], frequency)
        psd[psd == 0.0] = np.nan  # without force there is no linear line to draw
        look: dict[str, Any] = {"line": line, "width": 1.3, "order": 5, "colour": BLACK}
        look["label"] = f"linear, k = {number(k)} N/m"
        items.append(Series("linear", frequency, psd, {"k_N_per_m": k}, **look))
    lowest = max(0.1 * levels.min(), 1e-13 * levels.max())
    panel = Panel(
        Axis("frequency_Hz", False, *band),
        Axis("psd_per_load2_m2_per_N2_per_Hz", True, lowest, 4.0 * levels.max()),
        items,
        f"{sensor}, PSD of displacement / load²",
        legend="upper right",
    )
    title = "Spectra of all loads between the linear limits"
    ends = (loads[0], loads[-1]) if len(loads) > 1 else extent(loads, log=True)
    look = {"colour_bars": [ColourBar("load_rms_N", *ends, log=True, curves=True)]}
    panels = {"main": panel}
    return Plot("figure_07_overlay_of_loads", title, caption, panels, size=(7.6, 4.6), **look)


def figure_08_load_and_stiffness(config, model, responses):
    """Return the Plot of the non-linear PSD against load and the linear PSD against stiffness."""
    sensor = driven_sensor(config, config.identification.broadband.point)
    caption = (
        f"PSD of displacement at {sensor} divided by the square of the load. Left: simulated with"
        f" contact, against the load, {_gap_words(config, responses)}, mean over segments and"
        " seeds. Right: linear tube with a bilateral support, against its stiffness (no damping"
        " added). The peaks take the same way; with contact they are wider and the anti-resonances"
        " (dark) fade. Same colours on both sides. Triangles: modes of the driven plane of the"
        " free tube (bottom) and in full contact (top)."
    )
    band, loads = shown_band(model, responses.frequency[-1]), responses.load
    frequency, levels = _per_load2(responses, sensor, band)
    measured = _decibels(levels)
    stiffness = np.geomspace(
        0.1 * config.identification.stiffness_range_N_per_m[0],
        2.5 * contact_stiffness(model),
        LINEAR_STIFFNESS_STEPS,
    )
    coarse = frequency[::2]
    linear = _decibels(linear_psds(config, model, sensor, stiffness, coarse))
    ends, curve = (measured.max() - DYNAMIC_RANGE_DB, measured.max()), "PSD / load²"
    modes = _modes(model, band)
    of_load = Map(curve, frequency, loads, measured, "psd_dB", *ends)
    of_k, k = Map(curve, coarse, stiffness, linear, "psd_dB", *ends), "support_stiffness_N_per_m"
    panels = {
        "load": _map_panel("load_rms_N", of_load, modes, "non-linear, against the load"),
        "stiffness": _map_panel(k, of_k, modes, "linear, against the bilateral stiffness"),
    }
    title, bars = "Load with contact, stiffness without", [ColourBar("psd_dB", *ends, ends="both")]
    look = {"size": (7.6, 4.4), "legend": 2, "colour_bars": bars}
    return Plot("figure_08_load_and_stiffness", title, caption, panels, **look)


def in_plane_share(config, responses):
    """Return the Plot of the in-plane share of the motion against load, for every gap."""
    point = config.identification.response_point
    caption = (
        "Mean square of the displacement in the other sensor directions over that in the driven"
        f" one, at {point}, against load over gap: median and range"
        " over seeds. The drive acts out of the plane only; below contact the share is that of the"
        " seeded imperfection alone (nothing), from a level on the motion leaves its plane by"
        " itself because contact turns it."
    )
    rows = [row for row in responses.share if row["point"] == point]
    items = []
    x, y, tags = "load_over_gap_N_per_m", "in_plane_share_dB", ("gap_m", "load_rms_N")
    for gap, look in looks_of_gaps(config, [row["gap_m"] for row in rows]):
        chosen = [{**row, x: row["load_rms_N"] / gap} for row in rows if row["gap_m"] == gap]
        items += over_seeds(chosen, x, y, "in-plane share", tags, **look)
    lowest = extent([value for item in items for value in item.low])[0]
    panel = Panel(
        Axis("load_over_gap_N_per_m", True),
        Axis("in_plane_share_dB", low=max(lowest, LOWEST_SHARE_DB)),
        items,
        f"in-plane share of the displacement at {point}",
        "sensors in one direction only",
        legend="lower right",
    )
    return Plot("in_plane_share", "Motion across the driven direction", caption, {"main": panel})


def _map_panel(column, item, modes, title):
    """Return the Panel of a Map over frequency and a column, with the modes of the tube."""
    return Panel(Axis("frequency_Hz"), Axis(column, True), [item, *modes], title)


def _gap_words(config, responses):
    return f"gap {gap_label(config, responses.gap_m)}"


def _per_load2(responses, sensor, band):
    """Return (frequency, mean PSD / load² (load, frequency)) of a sensor in a band above 0 Hz."""
    kept = inside(responses.frequency, band) & (responses.frequency > 0.0)
    psd = responses.psd["displacement", sensor, "mean"][:, kept]
    return responses.frequency[kept], psd / responses.load[:, None] ** 2


def _decibels(values):
    """Return 10 log10 of positive values; 0 (no force there) becomes a level far below the rest."""
    return 10.0 * np.log10(np.maximum(values, np.finfo(float).tiny))


def _modes(model, band):
    """Return the modes of the driven plane: free below a map, in full contact above it."""
    (free, low), (held, high) = limit_modes(model, band)
    look: dict[str, Any] = {"size": 7, "order": 6}
    return [
        Signs(free, low, 0.012, label=free, marker="^", colour="white", **look),
        Signs(held, high, 0.988, label=held, marker="v", colour=ORANGE, **look),
    ]
