"""Effect of length, buffer, overlap and window of a record, and the scatter due to impacts."""

from __future__ import annotations

import numpy as np

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import BLACK, BLUE, GREEN, GREY, ORANGE, RED, ordered_colours

WINDOWS = {"hann": ("-", "o"), "boxcar": ((0, (2, 1)), "s")}
PEAK_COLOURS = (BLUE, RED, GREEN)


def spectra(averages, leakage, impacts):
    """Return the Sheet of degrees of freedom, leakage and scatter, with four panels.

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
    sheet = Sheet(
        "validation_convergence_spectra",
        "Spectra: what 49 s, 10 s buffers, 65 % overlap and a Hann window are worth",
        caption,
        [["averages", "impacts"], ["level", "damping"]],
        size=(7.6, 6.8),
    )
    _averages(sheet, sheet.axes["averages"], averages)
    _impacts(sheet, sheet.axes["impacts"], impacts)
    _leakage(sheet, leakage)
    return [sheet]


def _averages(sheet, axes, rows):
    """Draw measured degrees of freedom against both formulas."""
    axes.set_title("degrees of freedom of a bin")
    groups = (
        ("white noise", "nu_flat", BLACK, "o", BLACK, "white noise"),
        ("linear tube", "nu_flat", ORANGE, "^", "white", "peaks, flat formula"),
        ("linear tube", "nu_resonance", RED, "^", RED, "peaks, with their spectrum"),
    )
    for record, formula, colour, marker, face, label in groups:
        own = [row for row in rows if row["record"] == record]
        measured, error = (
            np.array([row[key] for row in own]) for key in ("nu_measured", "standard_error")
        )
        tags = {
            key: [row[key] for row in own]
            for key in ("segment_s", "overlap", "duration_s", "window", "frequency_Hz")
        }
        sheet.bars(
            axes,
            ("nu_formula", [row[formula] for row in own]),
            ("nu_measured", measured),
            label,
            measured - 2.0 * error,
            measured + 2.0 * error,
            tags=tags,
            color=colour,
            marker=marker,
            markerfacecolor=face,
            linestyle="none",
            label=label,
        )
    ends = np.array([4.0, 250.0])
    sheet.line(
        axes, ("nu_formula", ends), ("nu_measured", ends), "equal", color=GREY, linewidth=0.9
    )
    axes.set_xscale("log")
    axes.set_yscale("log")
    sheet.legend(axes, loc="upper left")


def _impacts(sheet, axes, rows):
    """Draw the multiple of the Gaussian variance against the width of the bands.

    There is one curve per load, with the longest buffers.
    """
    axes.set_title("levels over seeds, with impacts")
    longest = max(row["segment_s"] for row in rows)
    for load, colour in ordered_colours(sorted({row["load_rms_N"] for row in rows})).items():
        own = [row for row in rows if (row["load_rms_N"], row["segment_s"]) == (load, longest)]
        middle, error = (
            np.array([row[key] for row in own]) for key in ("multiple", "standard_error")
        )
        label = f"{load:g} N, in contact {own[0]['contact_fraction']:.0%}"
        sheet.bars(
            axes,
            ("band_width_Hz", [row["width_Hz"] for row in own]),
            ("variance_multiple", middle),
            label,
            middle - error,
            middle + error,
            tags={"load_rms_N": load},
            color=colour,
            marker="o",
            label=label,
        )
    axes.axhline(1.0, color=GREY, linewidth=0.9)
    axes.set_xscale("log")
    axes.set_ylim(0.0, None)
    sheet.legend(axes, loc="upper left")


def _leakage(sheet, rows):
    """Draw level and half-power damping of the expected peaks against the buffer."""
    sheet.axes["level"].set_title("level of the peaks")
    sheet.axes["damping"].set_title("half-power damping of the peaks")
    for colour, peak in zip(PEAK_COLOURS, sorted({row["peak_Hz"] for row in rows}), strict=False):
        for window, (dash, marker) in WINDOWS.items():
            own = [row for row in rows if (row["peak_Hz"], row["window"]) == (peak, window)]
            buffer_s = [row["segment_s"] for row in own]
            name = f"{peak:.0f} Hz, {own[0]['damping_ratio']:.1%}, {window}"
            style = {"color": colour, "linestyle": dash, "marker": marker, "markersize": 3.5}
            sheet.line(
                sheet.axes["level"],
                ("buffer_s", buffer_s),
                ("peak_level_dB", [row["level_dB"] for row in own]),
                name,
                label=name,
                **style,
            )
            ratio = [row["apparent_damping_ratio"] / row["damping_ratio"] for row in own]
            sheet.line(
                sheet.axes["damping"],
                ("buffer_s", buffer_s),
                ("damping_over_true", ratio),
                name,
                **style,
            )
    sheet.axes["level"].set_xscale("log")
    sheet.axes["damping"].set_xscale("log")
    sheet.axes["damping"].set_yscale("log")
    sheet.legend(sheet.axes["level"], loc="lower right")
