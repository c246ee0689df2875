"""The spectra of a case, averaged while its record arrives; memory holds one segment.

Variables of the dataset, with X the segment spectra of a channel:

- psd_{displacement,acceleration}_{mean,min,max} (sensor, frequency): one-sided, unit²/Hz; mean,
  smallest and largest over segments
- sensor_spectra_{re,im} (driven_sensor, segment, low_frequency): X of the sensors in the driven
  directions, m/sqrt(Hz)
- line_spectra_{re,im} (line_point, segment, line_frequency): X along the shape line, m/sqrt(Hz)

A cross-spectrum is the mean over segments of X conj(Y).
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.identify.spectra.welch import (
    SegmentTransform,
    driven_axes,
    effective_averages,
    highest_kept_frequency_Hz,
    segment_layout,
)

UNITS = {"displacement": "m2 Hz-1", "acceleration": "m2 s-4 Hz-1"}
# No attribute `units`: UDUNITS has no fractional powers and reads "m Hz-1/2" as half a m s.
ROOT_UNIT = "in m/sqrt(Hz)"
COORDINATES = {
    "sensor": {"long_name": "sensor: point and axis"},
    "driven_sensor": {"long_name": "sensor in the direction of the force: point and axis"},
    "frequency": {"units": "Hz", "long_name": "frequency"},
    "low_frequency": {
        "units": "Hz",
        "long_name": "frequency of the segment spectra of the sensors",
    },
    "line_frequency": {
        "units": "Hz",
        "long_name": "frequency of the segment spectra along the shape line",
    },
}
SERIES = ("displacement", "acceleration", "line_displacement")  # of a record, that spectra are of
PARTS = {"re": "real part", "im": "imaginary part"}


class CaseSpectra:
    """Averages the spectra of one case from pieces of its record.

    config: its sections record, spectra, excitation and identification are read. Without
        identification, segment spectra are kept at all frequencies.
    sensors (sensor,): names, such as "apex.y".
    line_points: number of points on the shape line.
    samples: number of samples of the whole record.
    dtype: of the record's values.

    Attributes:
    write: callback write(name, index, values) that stores a finished part; set it before `put`.
    head: Dataset of the coordinates and scalar variables.
    parts: {name: (dimensions, type, attributes)} of the variables that go to `write`.
    sizes: {dimension: length}.
    """

    def __init__(
        self, config: Any, sensors: Sequence[str], line_points: int, samples: int, dtype: Any
    ):
        rate, spectra = config.record.sampling_frequency_Hz, config.spectra
        self.write: Callable[[str, Any, np.ndarray], Any] = _no_callback
        self._length, self._step, self._count = segment_layout(
            samples, rate, spectra.segment_s, spectra.overlap
        )
        identified = config.identification is not None
        lowest, highest = config.identification.lscf.band_Hz if identified else (0.0, 0.5 * rate)
        self._transforms = [
            SegmentTransform(rate, spectra, dtype),
            SegmentTransform(rate, spectra, dtype, highest),
        ]
        frequency, line_frequency = (transform.frequency for transform in self._transforms)
        force = config.excitation
        one = hasattr(force, "direction") and not getattr(force, "both_directions", False)
        driven = driven_axes(force.direction) if one else tuple("xyz")
        self._driven = [
            index for index, name in enumerate(sensors) if name.rsplit(".", 1)[-1] in driven
        ]
        kept = highest_kept_frequency_Hz(config) if identified else highest
        self._low = int(np.sum(frequency <= kept))
        self._band = line_frequency >= lowest
        self._buffer = np.empty((2 * len(sensors) + line_points, self._length), dtype)
        self._sensors = len(sensors)
        self._filled = self._segment = 0
        self._power: dict[str, np.ndarray] = {}
        values = {
            "sensor": list(sensors),
            "driven_sensor": [sensors[index] for index in self._driven],
            "frequency": frequency,
            "low_frequency": frequency[: self._low],
            "line_frequency": line_frequency[self._band],
        }
        coords = {name: (name, own, COORDINATES[name]) for name, own in values.items()}
        averages = effective_averages(samples / rate, rate, spectra)
        about_averages = {"units": "1", "long_name": "degrees of freedom of a PSD bin"}
        self.head = xr.Dataset(
            {"effective_averages": ((), averages, about_averages)},
            coords,
            {name: getattr(spectra, name) for name in ("window", "segment_s", "overlap")},
        )
        self.sizes: dict[str, int] = {str(name): size for name, size in self.head.sizes.items()}
        self.sizes |= {"segment": self._count, "line_point": line_points}
        self.parts = _declared_parts()

    def put(self, displacement: np.ndarray, acceleration: np.ndarray, line: np.ndarray) -> None:
        """Add the next samples of the record.

        displacement (sensor, time) m.
        acceleration (sensor, time) m/s².
        line (line_point, time) m: displacement along the shape line.
        """
        read, samples = 0, displacement.shape[-1]
        while read < samples and self._segment < self._count:
            count = min(samples - read, self._length - self._filled)
            place, part = slice(self._filled, self._filled + count), slice(read, read + count)
            row = 0
            for values in (displacement, acceleration, line):
                self._buffer[row : row + len(values), place] = values[:, part]
                row += len(values)
            self._filled += count
            read += count
            if self._filled == self._length:
                self._finish_segment()

    def _finish_segment(self) -> None:
        """Transform the full segment and keep its overlap with the next one in the buffer."""
        sensors = 2 * self._sensors
        line = self._transforms[1](self._buffer[sensors:])
        values = self._transforms[0](self._buffer[:sensors])
        low = values[self._driven, : self._low]
        for name, stored in (("sensor_spectra", low), ("line_spectra", line[:, self._band])):
            self.write(f"{name}_re", np.s_[:, self._segment], stored.real)
            self.write(f"{name}_im", np.s_[:, self._segment], stored.imag)
        power = values.real**2 + values.imag**2
        if not self._power:
            self._power = {"mean": power.copy(), "min": power.copy(), "max": power}
        else:
            self._power["mean"] += power
            np.minimum(self._power["min"], power, out=self._power["min"])
            np.maximum(self._power["max"], power, out=self._power["max"])
        self._segment += 1
        self._filled = max(self._length - self._step, 0)
        self._buffer[:, : self._filled] = self._buffer[:, self._step :].copy()

    def finish(self) -> None:
        """Write the PSDs. Raises ValueError when the record ended before its last segment."""
        if self._segment < self._count:
            raise ValueError(f"the record ended after {self._segment} of {self._count} segments")
        for name, power in self._power.items():
            values = power / self._count if name == "mean" else power
            self.write(f"psd_displacement_{name}", np.s_[:], values[: self._sensors])
            self.write(f"psd_acceleration_{name}", np.s_[:], values[self._sensors :])


def case_spectra(config: Any, record: xr.Dataset) -> xr.Dataset:
    """Return the spectra of one case, with the attributes of its record.

    record: Dataset with displacement (sensor, time) m, acceleration (sensor, time) m/s² and
    line_displacement (line_point, time) m.
    """
    spectra = CaseSpectra(
        config,
        [str(name) for name in record["sensor"].values],
        record.sizes["line_point"],
        record.sizes["time"],
        record["displacement"].dtype,
    )
    arrays = {
        name: np.empty([spectra.sizes[dim] for dim in dims], dtype)
        for name, (dims, dtype, _) in spectra.parts.items()
    }
    spectra.write = lambda name, index, values: arrays[name].__setitem__(index, values)
    spectra.put(*(record[name].values for name in SERIES))
    spectra.finish()
    data = {
        name: (dims, arrays[name], attributes)
        for name, (dims, _, attributes) in spectra.parts.items()
    }
    return spectra.head.assign(data).assign_attrs(record.attrs | spectra.head.attrs)


def _declared_parts() -> dict[str, tuple]:
    """Return {name: (dimensions, type, attributes)} of the variables with a frequency axis."""
    parts: dict[str, tuple] = {}
    for quantity, unit in UNITS.items():
        for name in ("mean", "min", "max"):
            text = f"{name} over segments of the one-sided power spectral density of {quantity}"
            about = {"units": unit, "long_name": text}
            parts[f"psd_{quantity}_{name}"] = (("sensor", "frequency"), "f4", about)
    for name, dims in (
        ("sensor_spectra", ("driven_sensor", "segment", "low_frequency")),
        ("line_spectra", ("line_point", "segment", "line_frequency")),
    ):
        for suffix, part in PARTS.items():
            about = {"long_name": f"segment spectra of displacement, {part}", "comment": ROOT_UNIT}
            parts[f"{name}_{suffix}"] = (dims, "f4", about)
    return parts


def _no_callback(name: str, index: Any, values: np.ndarray) -> None:
    raise ValueError("set the attribute `write` before the first sample")
