"""A sensor that is left free: its prediction by the others, held to their measurement."""

import numpy as np
import xarray as xr

from vibroimpact.reports.figures.plot import Axis, Bars, Panel, Plot, Series
from vibroimpact.reports.figures.sheet import WIDTH_IN

from .states import AS_GIVEN, COLOURS, level_in_words, percent, shown_states

MOST_CHANNELS = 14
LARGEST = 2.0  # error that is drawn to scale
COLUMNS = {"m/s": "velocity_m_per_s", "1/s": "strain_rate_1_per_s"}

CAPTION = (
    "Each sensor in turn is left free while all others are held to their measurement; the model"
    " then predicts its signal. Above: the sensor whose prediction gains most, where"
    " its response is largest. Below: RMS error over RMS response of every sensor that moves there,"
    " as velocities.{left_out} A sensor far beyond the others may be at fault."
)

NONE_HELD = (
    "No sensor is held: the steady response to the measured force, which repeats by itself, is"
    " predicted. Above: the sensor whose prediction gains most, where its response is largest."
    " Below: RMS error over RMS response of every sensor, as velocities.{left_out}"
)


def free_sensor_figure(evidence: xr.Dataset) -> Plot:
    """Return the Plot of the waveform of a sensor that was left free, and the errors of all."""
    states, error = shown_states(evidence), evidence["free_error"].values[:, 0]
    free = int(evidence["waveform_channel"].values)
    known = np.flatnonzero(np.isfinite(error[0])).tolist()
    known.sort(key=lambda channel: (channel != free, -error[-1, channel]))
    channels = known[:MOST_CHANNELS]  # the free one first, then by their error before
    names = evidence["channel_name"].values
    left = len(known) - len(channels)
    words = f" {left} sensors that are predicted better are left out." if left else ""
    level = level_in_words(evidence, int(evidence["waveform_stretch"].values))
    errors = " → ".join(percent(error[state, free]) for state, _ in states)
    caption = NONE_HELD if evidence.attrs.get("held") == "nothing" else CAPTION
    return Plot(
        "diagnosis_free_sensor",
        f"{names[free]}, left free, is predicted: error {errors}",
        caption.format(left_out=words),
        {
            "waveform": _waveform(evidence, states, f"{names[free]}, {level}"),
            "errors": _errors(evidence, states, channels),
        },
        [["waveform"], ["errors"]],
        (WIDTH_IN, 3.8 + 0.24 * len(channels)),
        heights=(2.3, 0.7 + 0.24 * len(channels)),
    )


def _waveform(evidence, states, title):
    """Return the Panel of the measurement and the prediction of each state."""
    column = COLUMNS[evidence["waveform"].attrs["units"]]
    series, time = evidence["waveform"].values, evidence["moment_time"].values
    items = [Series("measured", time, series[0], label="measured", width=2.2, order=1)]
    for state, name in states:
        look = {"colour": COLOURS[name], "width": 1.2, "order": 3 + state, "label": name}
        look["line"] = "--" if name == AS_GIVEN else "-"
        items.append(Series(name, time, series[1 + state], **look))
    largest = 1.35 * float(np.abs(series[0]).max())
    moments = Axis("time_s", False, time[0], time[-1], "Time in the record (s)")
    motion = Axis(column, False, -largest, largest)
    return Panel(moments, motion, items, title, legend="upper right", legend_columns=3)


def _errors(evidence, states, channels):
    """Return the Panel of a bar per channel and state."""
    error, names = evidence["free_error"].values[:, 0], evidence["channel_name"].values
    thickness, items = 0.8 / len(states), []
    for position, (state, name) in enumerate(states):
        values = error[state, channels]
        at = np.arange(len(channels)) + (position - 0.5 * (len(states) - 1)) * thickness
        tags = {"channel": names[channels], "free_error": values}
        look = {"colour": COLOURS[name], "label": name, "thickness": thickness}
        drawn, texts = np.minimum(np.nan_to_num(values), LARGEST), [*map(percent, values)]
        items.append(Bars(name, at, drawn, tags, texts=texts, **look))
    highest = 1.12 * max(float(np.max(item.values)) for item in items)
    across, down = Axis("free_error", False, 0.0, highest), names[channels].tolist()
    return Panel(across, Axis("channel", names=down), items)
