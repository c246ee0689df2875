"""Exact spectra and records of a linear structure, as the identification reads them."""

import numpy as np
import xarray as xr

from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.excitation.random_streams import random_generator
from vibroimpact.identify.secant import MOMENTS
from vibroimpact.identify.spectra.welch import highest_kept_frequency_Hz
from vibroimpact.identify.spectra.window_leakage import spectral_kernel
from vibroimpact.study.case_spectra import case_spectra

STREAM = "chain"


def statistics(points):
    """What identify_case reads of a record beside its spectra; the contact forces play no part."""
    data = {}
    for name in MOMENTS:
        shape = (points,) if name.endswith("product") else (points, 2)
        data[name] = (("contact_point", "direction")[: len(shape)], np.ones(shape))
    return xr.Dataset(data, attrs={"load_rms_N": 1.0, "gap_m": 1.0e-3})


class LinearRecords:
    """The response of a linear structure to the forces of a study's seeds.

    config: of the study; its force is band limited.
    sensors: names of the sensors, such as apex.y.
    respond: function of frequencies (frequency,) in Hz that returns the responses (output,
        frequency) in m/N: the sensors, then the shape line.
    """

    def __init__(self, config, sensors, respond):
        self.config, self.sensors, self.respond = config, list(sensors), respond
        self.rate = round(config.record.sampling_frequency_Hz)
        self.samples = round(config.record.duration_s * self.rate)
        self.period = 51 * self.rate  # a little longer than the record, and quick to transform
        self._lines = None

    def exact(self, window):
        """Spectra as case_spectra gives them, without any scatter: "segments" whose mean is the
        expected averaged spectrum.

        Segment j holds the exact response at a frequency shifted by the kernel's offset j, weighted
        with the root of the kernel.
        """
        segment = self.config.spectra.segment_s
        kernel = spectral_kernel(window, segment)
        fine, bins = kernel.oversampling, round(highest_kept_frequency_Hz(self.config) * segment)
        index = np.arange(-kernel.half_width, bins * fine + kernel.half_width + 1)
        frequency = np.abs(index) / (segment * fine)
        response = self.respond(frequency)
        response = np.where(index < 0, response.conj(), response) * (
            frequency >= self.config.excitation.band_Hz[0] - 1.0e-9
        )
        taps = [
            np.sqrt(weight * kernel.weights.size) * response[:, tap : tap + bins * fine + 1 : fine]
            for tap, weight in enumerate(kernel.weights)
        ]
        values = np.stack(taps, axis=1)
        low = np.arange(bins + 1) / segment
        first, last = self.config.identification.lscf.band_Hz
        band = (low >= first - 1.0e-9) & (low <= last + 1.0e-9)
        count, data = len(self.sensors), {}
        for name, part, dims in (
            ("sensor_spectra", values[:count], ("driven_sensor", "segment", "low_frequency")),
            (
                "line_spectra",
                values[count:][..., band],
                ("line_point", "segment", "line_frequency"),
            ),
        ):
            data |= {name + "_re": (dims, part.real), name + "_im": (dims, part.imag)}
        coords = {"driven_sensor": self.sensors, "low_frequency": low, "line_frequency": low[band]}
        return xr.Dataset(
            data | {"effective_averages": ((), np.inf)},
            coords,
            {"window": window, "segment_s": segment},
        )

    def record(self, seed):
        """The record of one seed as far as case_spectra reads it."""
        if self._lines is None:
            frequency = np.fft.rfftfreq(self.period, 1.0 / self.rate)
            low, high = self.config.excitation.band_Hz
            self._lines = np.flatnonzero((frequency >= low) & (frequency <= high))
            self._response = self.respond(frequency[self._lines]).astype(np.complex64)
        force = band_limited_noise(
            random_generator(self.config.seed, seed, STREAM),
            self.period,
            self.rate,
            self.config.excitation.band_Hz,
        )
        lines = np.zeros((len(self._response), self.period // 2 + 1), np.complex64)
        lines[:, self._lines] = self._response * np.fft.rfft(force)[self._lines]
        motion = np.fft.irfft(lines, self.period, axis=-1)[:, : self.samples].astype(np.float32)
        count = len(self.sensors)
        return xr.Dataset(
            {
                "displacement": (("sensor", "time"), motion[:count]),
                "acceleration": (("sensor", "time"), motion[:1].repeat(count, 0)),
                "line_displacement": (("line_point", "time"), motion[count:]),
            },
            {"sensor": self.sensors},
        )

    def spectra(self, seed):
        """The spectra of one seed."""
        return case_spectra(self.config, self.record(seed))
