"""The instruments: gains, delays, noise and faults, applied to the true signals."""

import numpy as np


def sensor_gain(data, channel="apex_y", factor=1.15):
    """Multiply a channel, "force", or "all" by factor.

    "all" is the force and every response, which is exactly the same as a scaled gap.
    """
    if channel in ("force", "all"):
        data.force *= factor
    for number, name in enumerate(data.names):
        if channel in (name, "all"):
            data.response[:, number] *= factor


def sensor_delay(data, channel="apex_y", delay=1.0e-3):
    """Delay a channel or "force" by delay [s]."""
    for series in data.series(channel):
        series[:] = delayed(series, delay * data.sampling)


def swap(data, channel="apex_y", other="left_leg_upper_y"):
    """Exchange two channels."""
    a, b = data.names.index(channel), data.names.index(other)
    data.response[:, [a, b]] = data.response[:, [b, a]]


def clip(data, channel="apex_y", fraction=0.4):
    """Limit a channel to a fraction of its highest peak."""
    series = data.series(channel)
    limit = fraction * max(np.abs(one).max() for one in series)
    for one in series:
        np.clip(one, -limit, limit, out=one)


def dropout(data, channel="apex_y", start=0.4, duration=1.5):
    """Set a channel to zero for duration [s], from a fraction `start` of each record."""
    for series in data.series(channel):
        first = int(start * len(series))
        series[first : first + int(duration * data.sampling)] = 0.0


def sensor_saturation(data, channel="apex_y", fraction=0.5):
    """Bend a channel smoothly, L tanh(y / L), with L a fraction of its highest peak."""
    series = data.series(channel)
    limit = fraction * max(np.abs(one).max() for one in series)
    for one in series:
        one[:] = limit * np.tanh(one / limit)


def delayed(series, samples):
    """(time,) a series delayed by a number of samples, band-limited, zero before it begins."""
    pad = len(series) // 8
    wide = np.concatenate([np.zeros(pad), series, np.zeros(pad)])
    turn = np.exp(-2j * np.pi * np.fft.rfftfreq(len(wide)) * samples)
    return np.fft.irfft(np.fft.rfft(wide) * turn, len(wide))[pad : pad + len(series)]


SENSOR_EFFECTS = {"sensor_gain": sensor_gain, "sensor_delay": sensor_delay}
FAULTS = {"swap": swap, "clip": clip, "dropout": dropout}
SENSOR_STRANGERS = {"sensor_saturation": sensor_saturation}
INSTRUMENTS = SENSOR_EFFECTS | FAULTS | SENSOR_STRANGERS


class Measured:
    """The signals that instruments act on.

    force (record, time), response (record, channel, time).
    names: of the channels. sampling: Hz.
    """

    def __init__(self, force, response, names, sampling):
        self.force, self.response, self.names, self.sampling = force, response, names, sampling

    def series(self, channel):
        """The (time,) series of a channel, or of "force", one per record; views."""
        if channel == "force":
            return list(self.force)
        return list(self.response[:, self.names.index(channel)])
