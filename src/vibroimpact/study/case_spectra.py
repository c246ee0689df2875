"""The spectra of a case, made while its record comes in: nothing longer than a segment is held.

They are psd_{displacement,acceleration}_{mean,min,max} (sensor, frequency) in unit²/Hz, the segment
spectra of the driven direction's sensors, sensor_spectra_{re,im} (driven_sensor, segment,
low_frequency) m/sqrt(Hz), and those of the shape line, line_spectra_{re,im} (line_point, segment,
line_frequency) m/sqrt(Hz). A cross-spectrum is the mean over segments of X conj(Y).
"""

import numpy as np
import xarray as xr

from vibroimpact.spectra.welch import (
    SegmentTransform,
    driven_axis,
    effective_averages,
    highest_kept_frequency_Hz,
    segment_layout,
)

UNITS = {"displacement": "m2 Hz-1", "acceleration": "m2 s-4 Hz-1"}
PARTS = {"re": "real part", "im": "imaginary part"}


class SpectraOfCase:
    """Takes pieces of the record of one case and hands each finished part of its spectra to
    keep(name, place, values), to be set.

    config: with record, spectra, excitation and identification; sensors: names (sensor,);
    line_points: how many; samples: of the whole record; dtype of its values. head: Dataset of
    coordinates and small variables; parts {name: (dimensions, type, attributes)} and sizes
    {dimension: length}: what `keep` is going to be given.
    """

    def __init__(self, config, sensors, line_points, samples, dtype):
        rate, spectra = config.record.sampling_frequency_Hz, config.spectra
        self.keep = None
        self._length, self._step, self._count = segment_layout(
            samples, rate, spectra.segment_s, spectra.overlap
        )
        lowest, highest = config.identification.lscf.band_Hz
        self._transforms = [
            SegmentTransform(rate, spectra, dtype),
            SegmentTransform(rate, spectra, dtype, highest),
        ]
        frequency, line_frequency = (transform.frequency for transform in self._transforms)
        self._driven = [
            index
            for index, name in enumerate(sensors)
            if name.endswith("." + driven_axis(config.excitation.direction))
        ]
        self._low, self._band = (
            int(np.sum(frequency <= highest_kept_frequency_Hz(config))),
            line_frequency >= lowest,
        )
        self._held = np.empty((2 * len(sensors) + line_points, self._length), dtype)
        self._sensors, self._filled, self._segment, self._power = len(sensors), 0, 0, None
        coords = {
            "sensor": list(sensors),
            "driven_sensor": [sensors[index] for index in self._driven],
            "frequency": ("frequency", frequency, _about("Hz", "frequency")),
            "low_frequency": ("low_frequency", frequency[: self._low], _about("Hz", "frequency")),
            "line_frequency": (
                "line_frequency",
                line_frequency[self._band],
                _about("Hz", "frequency"),
            ),
        }
        averages = effective_averages(samples / rate, rate, spectra)
        attributes = {
            "window": spectra.window,
            "segment_s": spectra.segment_s,
            "overlap": spectra.overlap,
        }
        self.head = xr.Dataset(
            {"effective_averages": ((), averages, _about("1", "degrees of freedom of a PSD bin"))},
            coords,
            attributes,
        )
        self.sizes = {**self.head.sizes, "segment": self._count, "line_point": line_points}
        self.parts = {
            f"psd_{quantity}_{name}": (
                ("sensor", "frequency"),
                "f4",
                _about(
                    unit,
                    f"{name} over segments of the one-sided power spectral density of {quantity}",
                ),
            )
            for quantity, unit in UNITS.items()
            for name in ("mean", "min", "max")
        }
        for name, dims in (
            ("sensor_spectra", ("driven_sensor", "segment", "low_frequency")),
            ("line_spectra", ("line_point", "segment", "line_frequency")),
        ):
            self.parts.update(
                {
                    f"{name}_{suffix}": (
                        dims,
                        "f4",
                        _about("m Hz-1/2", f"segment spectra of displacement, {part}"),
                    )
                    for suffix, part in PARTS.items()
                }
            )

    def put(self, displacement, acceleration, line):
        """Take the next samples: displacement (sensor, time) m, acceleration (sensor, time) m/s²,
        line (line_point, time) m.
        """
        taken, samples = 0, displacement.shape[-1]
        while taken < samples and self._segment < self._count:
            count = min(samples - taken, self._length - self._filled)
            place, part = slice(self._filled, self._filled + count), slice(taken, taken + count)
            row = 0
            for values in (displacement, acceleration, line):
                self._held[row : row + len(values), place] = values[:, part]
                row += len(values)
            self._filled += count
            taken += count
            if self._filled == self._length:
                self._finish_segment()

    def _finish_segment(self):
        """Transform the segment that is held, and keep of it what the next one shares."""
        sensors, line = 2 * self._sensors, self._transforms[1](self._held[2 * self._sensors :])
        values = self._transforms[0](self._held[:sensors])
        low = values[self._driven, : self._low]
        for name, kept in (("sensor_spectra", low), ("line_spectra", line[:, self._band])):
            self.keep(f"{name}_re", np.s_[:, self._segment], kept.real)
            self.keep(f"{name}_im", np.s_[:, self._segment], kept.imag)
        power = values.real**2 + values.imag**2
        if self._power is None:
            self._power = {"mean": power.copy(), "min": power.copy(), "max": power}
        else:
            self._power["mean"] += power
            np.minimum(self._power["min"], power, out=self._power["min"])
            np.maximum(self._power["max"], power, out=self._power["max"])
        self._segment += 1
        self._filled = max(self._length - self._step, 0)
        self._held[:, : self._filled] = self._held[:, self._step :].copy()

    def finish(self):
        """Hand over the PSDs. Raises ValueError when the record ended before its last segment."""
        if self._segment < self._count:
            raise ValueError(f"the record ended after {self._segment} of {self._count} segments")
        for name, power in self._power.items():
            values = power / self._count if name == "mean" else power
            self.keep(f"psd_displacement_{name}", np.s_[:], values[: self._sensors])
            self.keep(f"psd_acceleration_{name}", np.s_[:], values[self._sensors :])


def case_spectra(config, record):
    """Return the spectra Dataset of one case, with the attributes of its record.

    record: Dataset with displacement (sensor, time) m, acceleration (sensor, time) m/s² and
    line_displacement (line_point, time) m.
    """
    arrays = {}
    made = SpectraOfCase(
        config,
        [str(name) for name in record["sensor"].values],
        record.sizes["line_point"],
        record.sizes["time"],
        record["displacement"].dtype,
    )
    made.keep = lambda name, place, values: arrays[name].__setitem__(place, values)
    arrays.update(
        {
            name: np.empty([made.sizes[dim] for dim in dims], dtype)
            for name, (dims, dtype, _) in made.parts.items()
        }
    )
    made.put(
        *(record[name].values for name in ("displacement", "acceleration", "line_displacement"))
    )
    made.finish()
    data = {
        name: (dims, arrays[name], attributes) for name, (dims, _, attributes) in made.parts.items()
    }
    return made.head.assign(data).assign_attrs(record.attrs | made.head.attrs)


def _about(unit, long_name):
    return {"units": unit, "long_name": long_name}
