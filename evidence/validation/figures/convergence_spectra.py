"""Effect of length, buffer, overlap and window of a record, and the scatter due to impacts."""

from __future__ import annotations

import numpy as np

from vibroimpact.reports.figures.plot import Axis, Item, Mark, Panel, Plot, Series
from vibroimpact.reports.figures.style import BLACK, BLUE, GREEN, GREY, ORANGE, RED, ordered_colours

WINDOWS = {"hann": ("-", "o"), "boxcar": ("--", "s")}
PEAK_COLOURS = (BLUE, RED, GREEN)


def spectra(averages, leakage, impacts):
    """Return the Plot of degrees of freedom, leakage and scatter, with four panels.

    averages: rows of `noise_rows` and `linear_rows`. leakage, impacts: rows of `leakage_rows` and
    `impact_rows`.
    """
    caption = (
        "Degrees of freedom: formula of Welch (1967) against 2 mean²/variance over records (bars:"
        " two standard errors), for white noise and for three peaks of the linear tube; open"
        " markers: the formula for a flat spectrum, which fails where a peak is narrower than a"
        " bin, because neighbouring buffers ring together; filled: the formula with the peak's own"
        " spectrum. Peak level and half-power damping: what a buffer's window makes of the true"
        " peak (damping 1.5 % at 16 Hz, 0.2 % at 45 and 105 Hz), expectation. Impacts: variance"
        " over seeds of the mean level of a band, over that of a Gaussian record, by the band's"
        " width (10 s buffers, 65 % overlap): a bin hardly shows what a band does."
    )
    panels = {
        "averages": _averages(averages),
        "impacts": _impacts(impacts),
        **_leakage(leakage),
    }
    title = "Spectra: what 49 s, 10 s buffers, 65 % overlap and a Hann window are worth"
    rows = [["averages", "impacts"], ["level", "damping"]]
    return [Plot("validation_convergence_spectra", title, caption, panels, rows, (7.6, 6.8))]


def _averages(rows):
    """Return the Panel of measured degrees of freedom against both formulas."""
    groups = (
        ("white noise", "nu_flat", BLACK, "o", "white noise"),
        ("linear tube", "nu_flat", ORANGE, "^", "peaks, flat formula"),
        ("linear tube", "nu_resonance", RED, "^", "peaks, with their spectrum"),
    )
    items: list[Item] = []
    for record, formula, colour, marker, label in groups:
        own = [row for row in rows if row["record"] == record]
        measured, error = (
            np.array([row[key] for row in own]) for key in ("nu_measured", "standard_error")
        )
        tags = {
            key: [row[key] for row in own]
            for key in ("segment_s", "overlap", "duration_s", "window", "frequency_Hz")
        }
        look = {"colour": colour, "marker": marker, "line": "", "label": label}
        look["hollow"] = "flat" in label
        expected, ends = [row[formula] for row in own], (measured - 2 * error, measured + 2 * error)
        items.append(Series(label, expected, measured, tags, *ends, **look))
    equal = np.array([4.0, 250.0])
    items.append(Series("equal", equal, equal, colour=GREY, width=0.9))
    axes = Axis("nu_formula", True), Axis("nu_measured", True)
    return Panel(*axes, items, "degrees of freedom of a bin", legend="upper left")


def _impacts(rows):
    """Return the Panel of the multiple of the Gaussian variance against the width of the bands.

    There is one curve per load, with the longest buffers.
    """
    longest, items = max(row["segment_s"] for row in rows), []
    for load, colour in ordered_colours(sorted({row["load_rms_N"] for row in rows})).items():
        own = [row for row in rows if (row["load_rms_N"], row["segment_s"]) == (load, longest)]
        middle, error = (
            np.array([row[key] for row in own]) for key in ("multiple", "standard_error")
        )
        label = f"{load:g} N, in contact {own[0]['contact_fraction']:.0%}"
        widths, ends = [row["width_Hz"] for row in own], (middle - error, middle + error)
        look = {"colour": colour, "marker": "o", "label": label}
        items.append(Series(label, widths, middle, {"load_rms_N": load}, *ends, **look))
    items.append(Mark("", "y", 1.0, colour=GREY, width=0.9))
    axes = Axis("band_width_Hz", True), Axis("variance_multiple", low=0.0)
    return Panel(*axes, items, "levels over seeds, with impacts", legend="upper left")


def _leakage(rows):
    """Return the Panels of level and half-power damping of the expected peaks by buffer."""
    level: list[Item] = []
    damping: list[Item] = []
    for colour, peak in zip(PEAK_COLOURS, sorted({row["peak_Hz"] for row in rows}), strict=False):
        for window, (line, marker) in WINDOWS.items():
            own = [row for row in rows if (row["peak_Hz"], row["window"]) == (peak, window)]
            buffer_s = [row["segment_s"] for row in own]
            name = f"{peak:.0f} Hz, {own[0]['damping_ratio']:.1%}, {window}"
            look = {"colour": colour, "line": line, "marker": marker, "size": 3.5}
            levels = [row["level_dB"] for row in own]
            level.append(Series(name, buffer_s, levels, label=name, **look))
            ratio = [row["apparent_damping_ratio"] / row["damping_ratio"] for row in own]
            damping.append(Series(name, buffer_s, ratio, **look))
    buffers, ratio_axis = Axis("buffer_s", True), Axis("damping_over_true", True)
    title, legend = "level of the peaks", "lower right"
    return {
        "level": Panel(buffers, Axis("peak_level_dB"), level, title, legend=legend),
        "damping": Panel(buffers, ratio_axis, damping, "half-power damping of the peaks"),
    }
