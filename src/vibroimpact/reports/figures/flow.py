"""A tube in a flow: ratios of velocities by mode and eigenvalues; with gaps in flows of rising
velocity, its response, and the predictions of the linear tubes.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from vibroimpact.flow.stability import Eigenvalues, Stability, StabilityRow

from .plot import Axis, Item, Mark, Panel, Plot, Series
from .style import BLACK, GAP_COLOURS, GREY, RED

if TYPE_CHECKING:  # a simulation takes long to import
    from vibroimpact.study.flow_sweep import FlowRun, FlowSweep, Onset

SHOWN_MODES = 4
MARKERS = {"small": "o", "large": "s"}
CAPTION = (
    "Left: RMS of the point that moves most against the velocity of the flow, one colour for"
    " each turbulent load; circles started at rest, open squares with a large motion; medians"
    " over seeds. Dashed: the turbulence alone, where it follows the velocity. Dotted lines:"
    " critical velocity of the linear tube with the k and c that each load has without the"
    " fluid-elastic force. Grey lines: that without supports, and with closed ones. Black:"
    " limit cycle without turbulence by the describing function, at the support that moves"
    " most. Right: wear work rate of all supports against velocity over that critical velocity."
)


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


def flow_sweep_figures(found: "FlowSweep") -> list[Plot]:
    """Return a Plot for each gap: response against velocity, and work rate against velocity over
    that at which the equivalent linear tube becomes unstable.
    """
    plots = []
    for number, gap in enumerate(dict.fromkeys(own.gap_m for own in found.onsets)):
        name = "figure_flow_sweep" + (f"_{number + 1}" if number else "")
        title = f"Response in a flow with a gap of {1e3 * gap:.3g} mm"
        velocity = Axis("flow_velocity_m_per_s")
        response, work = _items(found, gap)
        panels = {
            "response": Panel(velocity, Axis("response_rms_m", low=0.0), response),
            "work": Panel(Axis("velocity_over_critical"), Axis("wear_work_rate_W", True), work),
        }
        plots.append(Plot(name, title, CAPTION, panels, size=(7.6, 3.8), legend=3))
    return plots


def _items(found: "FlowSweep", gap: float) -> tuple[list[Item], list[Item]]:
    """Return the items of both panels at a gap."""
    response: list[Item] = []
    work: list[Item] = []
    onsets = [own for own in found.onsets if own.gap_m == gap]
    for onset, colour in zip(onsets, GAP_COLOURS, strict=False):
        for start in MARKERS:
            case = (onset.load_rms_N, gap, start)
            runs = [run for run in found.runs if (run.load_rms_N, run.gap_m, run.start) == case]
            alone = [run for run in runs if not run.coupled]
            follows = any(run.velocity_m_per_s > 0.0 for run in alone)
            with_flow = [own for own in runs if own.coupled or not follows]
            for items, curve in zip((response, work), _curves(with_flow, onset), strict=True):
                items.append(Series(**curve, colour=colour, marker=MARKERS[start], size=4))
            if follows and start == "small":
                label = f"{onset.load_rms_N:g} N, turbulence alone"
                tags = {"load_rms_N": onset.load_rms_N, "start": start}
                look: dict[str, Any] = {"colour": colour, "line": "--", "label": label}
                response.append(Series(label, *_median(alone, "rms_m"), tags, **look))
        name = f"equivalent at {onset.load_rms_N:g} N"
        response += _critical(onset.equivalent_m_per_s, name, colour)
    response += _critical(onsets[0].open_m_per_s, "open", GREY)
    response += _critical(onsets[0].closed_m_per_s, "closed", GREY, "critical velocity, linear")
    cycles = [own for own in found.cycles if own.gap_m == gap and own.velocity_m_per_s > 0.0]
    velocities = [own.velocity_m_per_s for own in cycles]
    rms, name = [own.amplitude_m / np.sqrt(2.0) for own in cycles], "limit cycle"
    response.append(Series(name, velocities, rms, label=name, colour=BLACK, width=1.0))
    return response, work


def _curves(runs: "list[FlowRun]", onset: "Onset") -> list[dict[str, Any]]:
    """Return the Series of the median response and work rate of the runs of one load and start, as
    keywords.
    """
    load, start = onset.load_rms_N, runs[0].start
    small = start == "small"
    (velocities, rms), (_, work) = _median(runs, "rms_m"), _median(runs, "wear_work_rate_W")
    bounded, worn = np.isfinite(rms), work > 0.0
    share = velocities[worn] / onset.equivalent_m_per_s
    look = {
        "curve": f"{load:g} N, {start} start",
        "tags": {"load_rms_N": load, "start": start},
        "line": "-" if small else "",
        "hollow": not small,
    }
    label = f"{load:g} N" + ("" if small else ", large start")
    return [
        {"x": velocities[bounded], "y": rms[bounded], "label": label, **look},
        {"x": share, "y": work[worn], **look},
    ]


def _critical(velocity: float, name: str, colour: str, label: str = "") -> list[Item]:
    """Return the Mark of a critical velocity in a list, empty if there is none."""
    look: dict[str, Any] = {"label": label, "colour": colour, "width": 0.9, "line": ":"}
    return [Mark(name, "x", velocity, **look)] if np.isfinite(velocity) else []


def _median(runs: "list[FlowRun]", name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return (velocities, medians over seeds of a field of runs), each (velocity,)."""
    velocities = np.array(sorted({run.velocity_m_per_s for run in runs}))
    values = [
        np.median([getattr(run, name) for run in runs if run.velocity_m_per_s == velocity])
        for velocity in velocities
    ]
    return velocities, np.array(values)
