"""Band-limited Gaussian forces, and measured records resampled to the integration step."""

from collections.abc import Callable, Sequence

import numpy as np

EDGE_S = 0.25  # length of the odd reflection at each end of a measured record


class ForceError(Exception):
    """A force that cannot be used; the message names the file, the value and the remedy."""


def band_limited_noise(
    generator: np.random.Generator, samples: int, rate: float, band: Sequence[float]
) -> np.ndarray:
    """Return Gaussian noise (sample,) with a flat PSD inside a band and RMS near 1.

    rate: Hz.
    band: (low, high) in Hz; the PSD is zero outside.

    Raises ForceError when the band holds no line.
    """
    lines, first, length = noise_lines(generator, samples, rate, band)
    spectrum = np.zeros(length // 2 + 1, complex)
    spectrum[first : first + lines.size] = lines
    return np.fft.irfft(spectrum, length)[:samples] * length


def noise_lines(
    generator: np.random.Generator,
    samples: int,
    rate: float,
    band: Sequence[float],
    psd: Callable[[np.ndarray], np.ndarray] | None = None,
) -> tuple[np.ndarray, int, int]:
    """Return (lines (line,), number of the first one, period in samples) of band-limited noise.

    The noise is the real part of the sum over n of 2 lines_n exp(2 pi i n t / period), t the sample
    number. The lines are independent complex Gaussian numbers (Shinozuka and Deodatis 1991, random
    amplitudes). Its variance is 1 on average.

    psd: function of frequencies (line,) in Hz that returns the PSD in the band, on any scale; flat
        by default. Other arguments and ForceError as for band_limited_noise.
    """
    length = fft_length(samples)
    low, high = int(np.ceil(band[0] * length / rate)), int(np.floor(band[1] * length / rate))
    if high < low or low < 1 or high >= length // 2:
        raise ForceError(
            f"band {band[0]:g}-{band[1]:g} Hz holds no line between 0 and {rate / 2:g} Hz: give"
            " band_Hz as [low, high] in Hz"
        )
    count = high - low + 1
    lines = generator.standard_normal(count) + 1j * generator.standard_normal(count)
    if psd is None:
        return lines * (0.5 / np.sqrt(count)), low, length
    power = psd(np.arange(low, high + 1) * (rate / length))
    return lines * (0.5 * np.sqrt(power / power.sum())), low, length


def fft_length(samples: int) -> int:
    """Return the smallest 2^a 3^b 5^c that is at least `samples`: a fast length of an FFT."""
    best = 2 ** (samples - 1).bit_length()
    for threes in range(11):
        for fives in range(8):
            odd = 3**threes * 5**fives
            best = min(best, odd * 2 ** max((-(-samples // odd) - 1).bit_length(), 0))
    return best


def resample_measured(values: np.ndarray, from_rate: float, to_rate: float) -> np.ndarray:
    """Return a measured record (sample,), taken as band-limited, at another rate in Hz.

    The FFT runs over the record between odd, tapered reflections of its ends, so that the ends do
    not ring into each other. A few last samples are dropped if the ratio of the rates requires
    it.
    """
    edge = int(np.ceil(EDGE_S * from_rate))
    padded = np.pad(values.astype(float), edge, mode="reflect", reflect_type="odd")
    ramp = np.sin(0.5 * np.pi * (np.arange(edge) + 0.5) / edge) ** 2
    padded[:edge] *= ramp
    padded[-edge:] *= ramp[::-1]
    length = padded.size
    while (
        abs(length * to_rate / from_rate - round(length * to_rate / from_rate)) > 1e-9
        and length > padded.size - 10000
    ):
        length -= 1
    new_length = round(length * to_rate / from_rate)
    spectrum = np.fft.rfft(padded[:length])
    resized = np.zeros(new_length // 2 + 1, complex)
    count = min(spectrum.size, resized.size)
    resized[:count] = spectrum[:count]
    first = round(edge * to_rate / from_rate)
    last = first + round(values.size * to_rate / from_rate)
    return np.fft.irfft(resized, new_length)[first:last] * (new_length / length)
