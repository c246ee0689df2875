"""The stability of a tube in a flow: ratios of velocities by mode, and eigenvalues."""

from typing import Any

import numpy as np

from vibroimpact.flow.stability import Eigenvalues, Stability, StabilityRow

from .plot import Axis, Item, Mark, Panel, Plot, Series
from .style import GAP_COLOURS, GREY, RED

SHOWN_MODES = 4


def stability_figure(found: Stability) -> Plot:
    """Return the Plot of the ratio of each mode at the highest velocity and, with a fluid-elastic
    force, of frequency and damping against velocity.
    """
    highest = max(row.velocity for row in found.rows)
    rows = [row for row in found.rows if row.velocity == highest]
    worst = max(rows, key=lambda row: row.ratio_high)
    title = (
        f"At {highest:g} m/s {'every mode is' if worst.ratio_high < 1.0 else 'not every mode is'}"
        " below its critical velocity"
    )
    caption = (
        "Effective over critical velocity of the lowest modes against their frequency, with bars"
        " over the range of the criterion's constant: filled, all supports hold; open, the worst"
        " case in which some do not. 1 is the limit of stability."
    )
    ratio = Panel(Axis("frequency_Hz"), Axis("velocity_ratio", True), _ratios(rows), legend="best")
    if found.eigenvalues is None:
        return Plot("figure_stability", title, caption, {"ratio": ratio}, size=(7.6, 3.6))
    caption += (
        " Below: frequency and damping ratio of the lowest oscillations against velocity, all"
        " supports holding, from the eigenvalues with the fluid-elastic force; a negative"
        " damping ratio grows."
    )
    panels = {"ratio": ratio, **_eigenvalues(found.eigenvalues)}
    rows_of_panels = [["ratio", "ratio"], ["frequency", "damping"]]
    return Plot("figure_stability", title, caption, panels, rows_of_panels, (7.6, 6.0))


def _ratios(rows: list[StabilityRow]) -> list[Item]:
    """Return the ratios of all modes, by direction."""
    items: list[Item] = []
    for number, direction in enumerate(dict.fromkeys(row.direction for row in rows)):
        own = [row for row in rows if row.direction == direction]
        look = {"colour": GAP_COLOURS[number], "line": "", "marker": "o"}
        items.append(_ranges([row for row in own if not row.inactive], direction, look))
        left: dict[int, StabilityRow] = {}
        for row in own:
            if row.inactive and (
                row.mode not in left or left[row.mode].ratio_high < row.ratio_high
            ):
                left[row.mode] = row
        if left:
            label = f"{direction}, some supports not holding"
            items.append(_ranges([*left.values()], label, look | {"hollow": True}))
    return [*items, Mark("limit", "y", 1.0, width=0.8)]


def _ranges(rows: list[StabilityRow], label: str, look: dict[str, Any]) -> Series:
    """Return the ratios of rows with their range."""
    low, high = (
        np.array([getattr(row, f"ratio_{end}") for row in rows]) for end in ("low", "high")
    )
    frequency = [row.frequency for row in rows]
    return Series(label, frequency, np.sqrt(low * high), {}, low, high, label=label, **look)


def _eigenvalues(own: Eigenvalues) -> dict[str, Panel]:
    """Return the Panels of frequency and damping ratio of the lowest oscillations by velocity."""
    modes = range(min(SHOWN_MODES, own.frequency.shape[1]))
    growth = Mark("growth begins", "x", own.critical, colour=RED, width=0.8, line="--")
    panels = {}
    for panel, column, values in (
        ("frequency", "frequency_Hz", own.frequency),
        ("damping", "damping_ratio", own.damping_ratio),
    ):
        items: list[Item] = [
            Series(name, own.velocity, values[:, mode], colour=GAP_COLOURS[mode], label=name)
            for mode, name in ((mode, f"oscillation {mode + 1}") for mode in modes)
        ]
        items += [Mark("limit", "y", 0.0, colour=GREY, width=0.8)] if panel == "damping" else []
        items += [growth] if own.critical <= own.velocity[-1] else []
        axes = Axis("flow_velocity_m_per_s"), Axis(column)
        panels[panel] = Panel(*axes, items, legend="best" if panel == "frequency" else "")
    return panels
