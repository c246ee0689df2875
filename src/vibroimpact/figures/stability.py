"""The stability of a tube in a flow: ratios of velocities by mode, and eigenvalues."""

from __future__ import annotations

from typing import Any

import numpy as np

from vibroimpact.flow.stability import Eigenvalues, Stability, StabilityRow

from .sheet import Sheet
from .style import BLACK, GAP_COLOURS, GREY, RED

SHOWN_MODES = 4


def stability_figure(found: Stability) -> Sheet:
    """Return the Sheet of the ratio of each mode at the highest velocity and, with a fluid-elastic
    force, of frequency and damping against velocity.
    """
    highest = max(row.velocity for row in found.rows)
    rows = [row for row in found.rows if row.velocity == highest]
    worst = max(rows, key=lambda row: row.ratio_high)
    stable = worst.ratio_high < 1.0
    with_force = found.eigenvalues is not None
    sheet = Sheet(
        "figure_stability",
        f"At {highest:g} m/s {'every mode is' if stable else 'not every mode is'} below its"
        " critical velocity",
        "Effective over critical velocity of the lowest modes against their frequency, with bars"
        " over the range of the criterion's constant: filled, all supports hold; open, the worst"
        " case in which some do not. 1 is the limit of stability."
        + (
            " Below: frequency and damping ratio of the lowest oscillations against velocity, all"
            " supports holding, from the eigenvalues with the fluid-elastic force; a negative"
            " damping ratio grows."
            if with_force
            else ""
        ),
        [["ratio", "ratio"], ["frequency", "damping"]] if with_force else [["ratio"]],
        size=(7.6, 6.0 if with_force else 3.6),
    )
    _ratios(sheet, rows)
    if found.eigenvalues is not None:
        _eigenvalues(sheet, found.eigenvalues)
    return sheet


def _ratios(sheet: Sheet, rows: list[StabilityRow]) -> None:
    """Draw the ratios of all modes, by direction."""
    axes = sheet.axes["ratio"]
    for number, direction in enumerate(dict.fromkeys(row.direction for row in rows)):
        own = [row for row in rows if row.direction == direction]
        held = [row for row in own if not row.inactive]
        colour = GAP_COLOURS[number]
        _bars(sheet, held, direction, color=colour, fmt="o")
        worst = {
            mode: max(
                (row for row in own if row.inactive and row.mode == mode),
                key=lambda row: row.ratio_high,
                default=None,
            )
            for mode in {row.mode for row in own}
        }
        left = [row for row in worst.values() if row is not None]
        if left:
            label = f"{direction}, some supports not holding"
            _bars(sheet, left, label, color=colour, fmt="o", mfc="white")
    sheet.mark(axes, "velocity_ratio", 1.0, "limit", vertical=False, color=BLACK, linewidth=0.8)
    axes.set_yscale("log")
    sheet.legend(axes, fontsize=8)


def _bars(sheet: Sheet, rows: list[StabilityRow], label: str, **style: Any) -> None:
    """Draw the ratios of rows with their range."""
    low, high = (
        np.array([getattr(row, f"ratio_{end}") for row in rows]) for end in ("low", "high")
    )
    sheet.bars(
        sheet.axes["ratio"],
        ("frequency_Hz", [row.frequency for row in rows]),
        ("velocity_ratio", np.sqrt(low * high)),
        label,
        low,
        high,
        label=label,
        **style,
    )


def _eigenvalues(sheet: Sheet, own: Eigenvalues) -> None:
    """Draw frequency and damping ratio of the lowest oscillations against velocity."""
    for mode in range(min(SHOWN_MODES, own.frequency.shape[1])):
        for panel, column, values in (
            ("frequency", "frequency_Hz", own.frequency),
            ("damping", "damping_ratio", own.damping_ratio),
        ):
            sheet.line(
                sheet.axes[panel],
                ("flow_velocity_m_per_s", own.velocity),
                (column, values[:, mode]),
                f"oscillation {mode + 1}",
                color=GAP_COLOURS[mode],
                label=f"oscillation {mode + 1}",
            )
    axes = sheet.axes["damping"]
    sheet.mark(axes, "damping_ratio", 0.0, "limit", vertical=False, color=GREY, linewidth=0.8)
    if own.critical <= own.velocity[-1]:
        for panel in ("frequency", "damping"):
            sheet.mark(
                sheet.axes[panel],
                "flow_velocity_m_per_s",
                own.critical,
                "growth begins",
                color=RED,
                linewidth=0.8,
                linestyle="--",
            )
    sheet.legend(sheet.axes["frequency"], fontsize=8)
