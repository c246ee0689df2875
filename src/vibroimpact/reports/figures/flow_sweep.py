"""A tube with gaps in flows of rising velocity, and the predictions of the linear tubes."""

from __future__ import annotations

from typing import Any

import numpy as np

from vibroimpact.study.flow_sweep import FlowRun, FlowSweep, Onset

from .sheet import Sheet
from .style import BLACK, GAP_COLOURS, GREY

MARKERS = {"small": "o", "large": "s"}


def flow_sweep_figures(found: FlowSweep) -> list[Sheet]:
    """Return a Sheet for each gap: response against velocity, and work rate against velocity over
    that at which the equivalent linear tube becomes unstable.
    """
    gaps = list(dict.fromkeys(own.gap_m for own in found.onsets))
    return [_sheet(found, gap, number) for number, gap in enumerate(gaps)]


def _sheet(found: FlowSweep, gap: float, number: int) -> Sheet:
    """Return the Sheet of a gap."""
    sheet = Sheet(
        "figure_flow_sweep" + (f"_{number + 1}" if number else ""),
        f"Response in a flow with a gap of {1e3 * gap:.3g} mm",
        "Left: RMS of the point that moves most against the velocity of the flow, one colour for"
        " each turbulent load; circles started at rest, open squares with a large motion; medians"
        " over seeds. Dashed: the turbulence alone, where it follows the velocity. Dotted lines:"
        " critical velocity of the linear tube with the k and c that each load has without the"
        " fluid-elastic force. Grey lines: that without supports, and with closed ones. Black:"
        " limit cycle without turbulence by the describing function, at the support that moves"
        " most. Right: wear work rate of all"
        " supports against velocity over that critical velocity.",
        [["response", "work"]],
        size=(7.6, 3.8),
    )
    onsets = [own for own in found.onsets if own.gap_m == gap]
    for onset, colour in zip(onsets, GAP_COLOURS, strict=False):
        for start in MARKERS:
            runs = [run for run in found.runs if _of(run, onset, start)]
            alone = [run for run in runs if not run.coupled]
            follows = any(run.velocity_m_per_s > 0.0 for run in alone)
            _curves(sheet, [own for own in runs if own.coupled or not follows], onset, colour)
            if follows and start == "small":
                _alone(sheet, alone, onset, colour)
        _critical(sheet, onset.equivalent_m_per_s, f"equivalent at {onset.load_rms_N:g} N", colour)
    for name in ("open", "closed"):
        _critical(sheet, getattr(onsets[0], f"{name}_m_per_s"), name, GREY)
    cycles = [own for own in found.cycles if own.gap_m == gap and own.velocity_m_per_s > 0.0]
    sheet.line(
        sheet.axes["response"],
        ("flow_velocity_m_per_s", [own.velocity_m_per_s for own in cycles]),
        ("response_rms_m", [own.amplitude_m / np.sqrt(2.0) for own in cycles]),
        "limit cycle",
        color=BLACK,
        linewidth=1.0,
        label="limit cycle",
    )
    sheet.axes["work"].set_yscale("log")
    sheet.axes["response"].set_ylim(bottom=0.0)
    labels = sheet.axes["response"].get_legend_handles_labels()
    sheet.figure.legend(*labels, loc="outside lower center", ncols=4, fontsize=7)
    return sheet


def _of(run: FlowRun, onset: Onset, start: str) -> bool:
    """Return whether a run is at the load and gap of an onset and starts so."""
    same = (run.load_rms_N, run.gap_m) == (onset.load_rms_N, onset.gap_m)
    return same and run.start == start


def _critical(sheet: Sheet, velocity: float, name: str, colour: str) -> None:
    """Mark a critical velocity, if there is one."""
    if np.isfinite(velocity):
        axes, column = sheet.axes["response"], "flow_velocity_m_per_s"
        label = "critical velocity, linear" if name == "closed" else None
        style: dict[str, Any] = {"color": colour, "linewidth": 0.9, "linestyle": ":"}
        sheet.mark(axes, column, velocity, name, label=label, **style)


def _alone(sheet: Sheet, runs: list[FlowRun], onset: Onset, colour: str) -> None:
    """Draw the median response to the turbulence alone."""
    velocities, rms = _median(runs, "rms_m")
    sheet.line(
        sheet.axes["response"],
        ("flow_velocity_m_per_s", velocities),
        ("response_rms_m", rms),
        f"{onset.load_rms_N:g} N, turbulence alone",
        tags={"load_rms_N": onset.load_rms_N, "start": "small"},
        color=colour,
        linestyle="--",
        label=f"{onset.load_rms_N:g} N, turbulence alone",
    )


def _median(runs: list[FlowRun], name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return (velocities, medians over seeds of a field of runs), each (velocity,)."""
    velocities = np.array(sorted({run.velocity_m_per_s for run in runs}))
    values = [
        np.median([getattr(run, name) for run in runs if run.velocity_m_per_s == velocity])
        for velocity in velocities
    ]
    return velocities, np.array(values)


def _curves(sheet: Sheet, runs: list[FlowRun], onset: Onset, colour: str) -> None:
    """Draw the median runs of one load and start."""
    start, tags = runs[0].start, {"load_rms_N": onset.load_rms_N, "start": runs[0].start}
    small = start == "small"
    style: dict[str, Any] = {
        "color": colour,
        "marker": MARKERS[start],
        "markersize": 4,
        "mfc": colour if small else "white",
        "linestyle": "-" if small else "none",
    }
    (velocities, rms), (_, work) = _median(runs, "rms_m"), _median(runs, "wear_work_rate_W")
    name = f"{onset.load_rms_N:g} N, {start} start"
    label = f"{onset.load_rms_N:g} N" + ("" if small else ", large start")
    bounded, worn = np.isfinite(rms), work > 0.0
    x = ("flow_velocity_m_per_s", velocities[bounded])
    y = ("response_rms_m", rms[bounded])
    sheet.line(sheet.axes["response"], x, y, name, tags=tags, label=label, **style)
    share = velocities[worn] / onset.equivalent_m_per_s
    x, y = ("velocity_over_critical", share), ("wear_work_rate_W", work[worn])
    sheet.line(sheet.axes["work"], x, y, name, tags=tags, **style)
