"""The force of a seed in every force channel, in blocks: any stretch of it at the integration step.

The whole record is never in memory. A band-limited record is drawn as Fourier lines. Its values at
every n-th step are the inverse transform of the same lines over a length n times shorter. The steps
between follow by interpolation, exact to round-off, because the short record is sampled several
times faster than its band requires. A block always comes from the same arithmetic, so that a step
has the same bits in every stretch.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import fsum, pi
from typing import Any, NamedTuple, TypeVar

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.sections import outer_width

from .force_files import read_force, require_lasting
from .line_force_spectrum import line_force_psd
from .random_force import ForceError, noise_lines, resample_measured
from .random_streams import random_generator

OVERSAMPLING = 5  # lowest rate of the short record, in units of the band's upper edge
# Taps of the interpolation. With OVERSAMPLING 5 a Kaiser window of this length leaves 1e-14 of the
# images of the band.
TAPS = 40
KAISER_BETA = 32.5
BLOCK_STEPS = 25600  # steps of a block, approximately for an interpolated record
MAX_STORED_BLOCKS = 3


@dataclass(frozen=True)
class SpectralForce:
    """A Gaussian force of any spectrum, with an RMS of 1 on average over realisations.

    band_Hz: (low, high), the PSD is 0 outside.
    psd: function of frequencies (frequency,) in Hz that returns the PSD in the band, on any scale.
    """

    band_Hz: Sequence[float]
    psd: Callable[[np.ndarray], np.ndarray]


Made = TypeVar("Made")


def force_channels(
    config: ConfigPart,
    seed: int,
    channels: int,
    made: Callable[[ConfigPart | SpectralForce, np.random.Generator], Made],
) -> list[Made]:
    """Return the force of a seed in each channel, per newton of the load.

    Turbulence has independent forces of one spectrum in all channels; a channel does not depend on
    how many there are. Any other excitation has one channel.

    config: parts seed, excitation and structure.section.
    channels: number of force channels of the model.
    made: function (excitation, random stream) that makes the force of a channel, as a ForceStream
        or an array.
    """
    force = config.excitation
    if force.kind != "turbulence":
        return [made(force, random_generator(config.seed, seed, "force"))]
    diameter = outer_width(config.structure.section)
    spectral = SpectralForce(
        force.band_Hz, lambda frequency: line_force_psd(force, diameter, frequency)
    )
    return [
        made(spectral, random_generator(config.seed, seed, "force", channel))
        for channel in range(channels)
    ]


class ForceStream:
    """A force at the integration rate, normalised to an RMS of 1 over the recorded samples.

    A sine, white noise and a SpectralForce are not rescaled: their RMS is 1 by definition.
    """

    def __init__(
        self,
        excitation: ConfigPart | SpectralForce,
        generator: np.random.Generator | None,
        samples: int,
        rate: float,
        recorded: slice,
        first_time_s: float = 0.0,
    ) -> None:
        """Prepare the blocks.

        excitation: section of the configuration, or a SpectralForce.
        generator: random stream of the seed; not used by a measured force or a sine.
        samples: length of the force.
        rate: Hz.
        recorded: slice of the samples that are recorded.
        first_time_s: time of the first sample in s, for a sine.

        Raises ForceError, or ForceFileError for a measured record that is too short or zero.
        """
        self._source = _source(excitation, generator, samples, rate, recorded, first_time_s)
        self._blocks: dict[int, np.ndarray] = {}
        self._scale = 1.0
        if self._source.exact_rms:
            start, stop, _ = recorded.indices(samples)
            pieces = (
                self.values(first, min(BLOCK_STEPS, stop - first))
                for first in range(start, stop, BLOCK_STEPS)
            )
            rms = np.sqrt(fsum(piece @ piece for piece in pieces) / (stop - start))
            if not rms > 0.0:
                raise ForceError("the force is zero over the record: check excitation.variable")
            self._blocks.clear()
            self._scale = 1.0 / rms

    def values(self, first: int, count: int) -> np.ndarray:
        """Return the samples (count,) from the first one on."""
        out, size = np.empty(count), self._source.block_steps
        for index in range(first // size, (first + count - 1) // size + 1):
            begin = index * size
            low, high = max(first, begin), min(first + count, begin + size)
            out[low - first : high - first] = self._block(index)[low - begin : high - begin]
        return out

    def _block(self, index):
        if index not in self._blocks:
            while len(self._blocks) >= MAX_STORED_BLOCKS:
                del self._blocks[min(self._blocks)]
            self._blocks[index] = self._source.block(index) * self._scale
        return self._blocks[index]


def _source(
    excitation: ConfigPart | SpectralForce,
    generator: Any,
    samples: int,
    rate: float,
    recorded: slice,
    first_time_s: float,
) -> Any:
    """Return the source of blocks of a kind of excitation."""
    if isinstance(excitation, SpectralForce):
        lines = noise_lines(generator, samples, rate, excitation.band_Hz, excitation.psd)
        return _Interpolated(*lines, exact_rms=False)
    source = excitation.signal if excitation.kind == "base_motion" else excitation
    if source.kind == "none":
        return _Blocks(lambda index: np.zeros(BLOCK_STEPS))
    if source.kind == "harmonic":
        omega, phase = 2.0 * pi * source.frequency_Hz, np.deg2rad(source.phase_deg)
        steps = np.arange(BLOCK_STEPS)

        def sine(index: int) -> np.ndarray:
            time = first_time_s + (index * BLOCK_STEPS + steps) / rate
            return np.sqrt(2.0) * np.sin(omega * time + phase)

        return _Blocks(sine)
    if source.kind == "white_noise":
        return _WhiteNoise(generator)
    if source.kind == "band_limited":
        return _Interpolated(*noise_lines(generator, samples, rate, source.band_Hz))
    file = (excitation.file, excitation.variable, excitation.sampling_frequency_Hz)
    values = _measured(file, rate, (recorded.start or 0) / rate, samples / rate)
    return _Blocks(lambda index: values[index * BLOCK_STEPS : (index + 1) * BLOCK_STEPS], True)


@lru_cache(maxsize=1)
def _measured(
    file: tuple[str, str, float | None], rate: float, start_up_s: float, needed_s: float
) -> np.ndarray:
    """Return a measured record at rate [Hz]; one copy serves all seeds.

    file: path, variable, sampling frequency. Times as for require_lasting.
    """
    force = read_force(*file)
    require_lasting(file[0], force, rate, start_up_s, needed_s)
    return resample_measured(force.values, force.rate, rate)


class _Blocks(NamedTuple):
    """A source of blocks: block(index) of block_steps samples.

    exact_rms: whether the force is scaled to its RMS over the record.
    """

    block: Callable[[int], np.ndarray]
    exact_rms: bool = False
    block_steps: int = BLOCK_STEPS


class _WhiteNoise:
    """Independent Gaussian values, equal to those of a single call of the generator."""

    exact_rms, block_steps = False, BLOCK_STEPS

    def __init__(self, generator):
        self._generator, self._states = generator, [generator.bit_generator.state]

    def block(self, index):
        for number in range(min(index, len(self._states) - 1), index + 1):
            self._generator.bit_generator.state = self._states[number]
            values = self._generator.standard_normal(BLOCK_STEPS)
            if number + 1 == len(self._states):
                self._states.append(self._generator.bit_generator.state)
        return values


class _Interpolated:
    """The inverse transform of Fourier lines, by way of a short record.

    lines: (line,) complex; the first of them is line `first` of a record of `length` steps.
    exact_rms: whether the force is scaled to its RMS over the record.
    """

    def __init__(self, lines, first, length, exact_rms=True):
        self.exact_rms = exact_rms
        highest = first + lines.size - 1
        factor = max(
            divisor
            for divisor in range(1, length // (OVERSAMPLING * highest) + 2)
            if length % divisor == 0
            and (divisor == 1 or length >= divisor * OVERSAMPLING * highest)
        )
        short = length // factor
        spectrum = np.zeros(short // 2 + 1, complex)
        spectrum[first : highest + 1] = lines
        values = np.fft.irfft(spectrum, short) * short
        self._rows = max(1, BLOCK_STEPS // factor)
        # The record is periodic. It is extended in front for the taps of the first steps, and
        # behind up to the end of the last block.
        if factor > 1:
            end = -(-short // self._rows) * self._rows
            values = values[np.arange(1 - TAPS // 2, end + TAPS // 2 + 1) % short]
        self._short = values
        self._weights = interpolation_weights(factor)
        self.block_steps = self._rows * factor

    def block(self, index):
        first = index * self._rows
        if self._weights.shape[1] == 1:
            return self._short[first : first + self._rows]
        windows = np.lib.stride_tricks.sliding_window_view(
            self._short[first : first + self._rows + TAPS - 1], TAPS
        )
        # Many forces act at once if exact_rms is false. A copy makes the product several times as
        # fast, but with other last bits; the other forces keep theirs.
        return ((windows if self.exact_rms else windows.copy()) @ self._weights).ravel()


def interpolation_weights(factor: int) -> np.ndarray:
    """Return (TAPS, factor): weights of the short record's values in the steps between two of them.

    Rows belong to the values -(TAPS / 2 - 1) .. TAPS / 2, columns to the `factor` steps from value
    0 on. The weights are a sinc under a Kaiser window. It passes up to 1/OVERSAMPLING of the short
    record's rate and stops from 1 - 1/OVERSAMPLING of it on, where the band's first image begins.
    """
    distance = np.arange(TAPS)[:, None] - (TAPS // 2 - 1) - np.arange(factor) / factor
    window = np.i0(
        KAISER_BETA * np.sqrt(np.maximum(1.0 - (distance / (TAPS // 2)) ** 2, 0.0))
    ) / np.i0(KAISER_BETA)
    return np.sinc(distance) * window
