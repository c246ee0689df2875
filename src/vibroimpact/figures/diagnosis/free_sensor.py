"""A sensor that is left free: what the others, held to their measurement, make of it."""

from __future__ import annotations

import numpy as np
import xarray as xr

from vibroimpact.figures.sheet import WIDTH_IN, Sheet
from vibroimpact.figures.style import BLACK, label_of, shown

from .states import AS_GIVEN, COLOURS, bars, level_in_words, name_rows, percent, shown_states

MOST_CHANNELS = 14
LARGEST = 2.0  # error that is drawn to scale
COLUMNS = {"m/s": "velocity_m_per_s", "1/s": "strain_rate_1_per_s"}

CAPTION = (
    "Each sensor in turn is left free while all others are held to their measurement; the model"
    " then says what it should have measured. Above: the sensor whose prediction gains most, where"
    " its response is largest. Below: RMS error over RMS response of every sensor that moves there,"
    " as velocities.{left_out} A sensor far beyond the others may be at fault."
)

NONE_HELD = (
    "No sensor is held: the steady response to the measured force, which repeats by itself, is"
    " predicted. Above: the sensor whose prediction gains most, where its response is largest."
    " Below: RMS error over RMS response of every sensor, as velocities.{left_out}"
)


def free_sensor_figure(evidence: xr.Dataset) -> Sheet:
    """Return the Sheet of the waveform of a sensor that was left free, and the errors of all."""
    states, error = shown_states(evidence), evidence["free_error"].values[:, 0]
    told = int(evidence["waveform_channel"].values)
    channels = _chosen(error, told)
    names = evidence["channel_name"].values
    left = int(np.isfinite(error[0]).sum()) - len(channels)
    words = f" {left} sensors that are predicted better are left out." if left else ""
    level = level_in_words(evidence, int(evidence["waveform_stretch"].values))
    errors = " → ".join(percent(error[state, told]) for state, _ in states)
    sheet = Sheet(
        "diagnosis_free_sensor",
        f"{names[told]}, left free, is predicted: error {errors}",
        (NONE_HELD if evidence.attrs.get("held") == "nothing" else CAPTION).format(left_out=words),
        [["waveform"], ["errors"]],
        size=(WIDTH_IN, 3.8 + 0.24 * len(channels)),
        height_ratios=(2.3, 0.7 + 0.24 * len(channels)),
    )
    _waveform(sheet, sheet.axes["waveform"], evidence, states)
    sheet.axes["waveform"].set_title(f"{names[told]}, {level}")
    _errors(sheet, sheet.axes["errors"], evidence, states, channels)
    return sheet


def _chosen(error, told):
    """Return the channels that are drawn, the telling one first, then by their error before."""
    known = np.flatnonzero(np.isfinite(error[0]))
    order = sorted(known.tolist(), key=lambda channel: (channel != told, -error[-1, channel]))
    return order[:MOST_CHANNELS]


def _waveform(sheet, axes, evidence, states):
    """Draw what was measured, and what each state predicts."""
    unit = evidence["waveform"].attrs["units"]
    column = COLUMNS[unit]
    series, time = evidence["waveform"].values, evidence["moment_time"].values
    rows = [(0, "measured", {"color": BLACK, "linewidth": 2.2, "zorder": 1})]
    for state, name in states:
        style = {"color": COLOURS[name], "linewidth": 1.2, "zorder": 3 + state}
        rows.append((1 + state, name, style | {"linestyle": "--" if name == AS_GIVEN else "-"}))
    for row, name, style in rows:
        sheet.line(axes, ("time_s", time), (column, series[row]), name, label=name, **style)
    largest = 1.35 * float(np.abs(shown(column, series[0])).max())
    axes.set_xlim(time[0], time[-1])
    axes.set_ylim(-largest, largest)
    axes.set_xlabel("Time in the record (s)")
    axes.legend(loc="upper right", ncols=3)


def _errors(sheet, axes, evidence, states, channels):
    """Draw a bar per channel and state."""
    error, names = evidence["free_error"].values[:, 0], evidence["channel_name"].values
    height = 0.8 / len(states)
    for position, (state, name) in enumerate(states):
        values = error[state, channels]
        place = sheet.record(axes, name, channel=names[channels], free_error=values)
        rows = np.arange(len(channels)) + (position - 0.5 * (len(states) - 1)) * height
        drawn = 100.0 * np.minimum(np.nan_to_num(values), LARGEST)
        style = {"color": COLOURS[name], "label": name}
        bars(axes, rows, drawn, [*map(percent, values)], place, height, **style)
    name_rows(axes, names[channels])
    axes.margins(x=0.12)
    axes.set_xlabel(label_of("free_error"))
