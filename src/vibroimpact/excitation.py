"""Forces: band-limited Gaussian records of exact RMS, and measured records resampled to the integration step."""

import numpy as np

from .force_files import read_force

EDGE_S = 0.25  # odd reflection added at both ends of a measured record before resampling


class ForceError(Exception):
    """A force that can not be used; the message names the file, the value and the remedy."""


def band_limited_noise(generator: np.random.Generator, samples: int, rate: float, band) -> np.ndarray:
    """Gaussian noise (sample,) with a flat PSD inside band (low, high) [Hz] and nothing outside, at rate [Hz]; RMS near 1.

    Synthesised by inverse FFT of independent complex Gaussian lines (Shinozuka & Deodatis 1991, random amplitudes).
    Raises ForceError when the band holds no line.
    """
    length = fast_length(samples)
    low, high = (int(np.ceil(band[0] * length / rate)), int(np.floor(band[1] * length / rate)))
    if high < low or low < 1 or high >= length // 2:
        raise ForceError(
            f"band {band[0]:g}-{band[1]:g} Hz holds no line between 0 and {rate / 2:g} Hz: give band_Hz as [low, high] in Hz"
        )
    count = high - low + 1
    lines = np.zeros(length // 2 + 1, complex)
    lines[low : high + 1] = generator.standard_normal(count) + 1j * generator.standard_normal(count)
    return np.fft.irfft(lines, length)[:samples] * (0.5 * length / np.sqrt(count))


def fast_length(samples: int) -> int:
    """The smallest 2^a 3^b 5^c that is at least ``samples``, a length that an FFT likes."""
    best = 2 ** (samples - 1).bit_length()
    for threes in range(11):
        for fives in range(8):
            odd = 3**threes * 5**fives
            best = min(best, odd * 2 ** max((-(-samples // odd) - 1).bit_length(), 0))
    return best


def resample_measured(values: np.ndarray, from_rate: float, to_rate: float) -> np.ndarray:
    """A measured record (sample,) taken as band-limited, at another rate [Hz].

    By FFT between odd, tapered reflections of the ends, so that the ends do not ring into each other; a few last samples are
    dropped when the ratio of the rates asks for it.
    """
    edge = int(np.ceil(EDGE_S * from_rate))
    padded = np.pad(values.astype(float), edge, mode="reflect", reflect_type="odd")
    ramp = np.sin(0.5 * np.pi * (np.arange(edge) + 0.5) / edge) ** 2
    padded[:edge] *= ramp
    padded[-edge:] *= ramp[::-1]
    length = padded.size
    while abs(length * to_rate / from_rate - round(length * to_rate / from_rate)) > 1e-9 and length > padded.size - 10000:
        length -= 1
    new_length = round(length * to_rate / from_rate)
    spectrum = np.fft.rfft(padded[:length])
    resized = np.zeros(new_length // 2 + 1, complex)
    kept = min(spectrum.size, resized.size)
    resized[:kept] = spectrum[:kept]
    first = round(edge * to_rate / from_rate)
    last = first + round(values.size * to_rate / from_rate)
    return np.fft.irfft(resized, new_length)[first:last] * (new_length / length)


def unit_force(excitation, generator, samples: int, rate: float, recorded: slice, first_time_s: float = 0.0) -> np.ndarray:
    """Force record (sample,) at rate [Hz]: RMS exactly 1 over the recorded samples, but for a sine or white noise, which are 1 by law.

    excitation: the section of the configuration; generator: the seed's random stream (unused by a measured force or a sine);
    first_time_s: time of the first sample, which a sine needs.
    Raises ForceError: a measured record is too short or has no force in it.
    """
    source = excitation.signal if excitation.kind == "base_motion" else excitation
    if source.kind == "none":
        return np.zeros(samples)
    if source.kind == "harmonic":
        time = first_time_s + np.arange(samples) / rate
        return np.sqrt(2.0) * np.sin(2.0 * np.pi * source.frequency_Hz * time + np.deg2rad(source.phase_deg))
    if source.kind == "white_noise":
        return generator.standard_normal(samples)
    if source.kind == "band_limited":
        values = band_limited_noise(generator, samples, rate, source.band_Hz)
    else:
        measured, measured_rate = read_force(excitation.file, excitation.variable, excitation.sampling_frequency_Hz)
        values = resample_measured(measured, measured_rate, rate)
        if values.size < samples:
            raise ForceError(
                f"{excitation.file}: {excitation.variable} lasts {measured.size / measured_rate:.3f} s, but start-up and record "
                f"need {samples / rate:.3f} s: lower integration.start_up_s or record.duration_s"
            )
        values = values[:samples]
    rms = np.sqrt(np.mean(np.square(values[recorded])))
    if not rms > 0.0:
        raise ForceError("the force is zero over the record: check excitation.variable")
    return values / rms
