"""The output filter: from the integration step to the sampling of the records, without aliasing.

Two linear-phase stages. The first divides the rate by ``RATIO`` inside the integration; it only has
to stop the images of the final band around the multiples of its output rate, which would fold into
it. The second does the rest: >= 80 dB above half the sampling frequency, ripple <= 0.05 dB below
0.78 of it (800 Hz at 2048 Hz).

If the first stage alone gives the sampling of the records, it stops (by 50 dB) the images of the
passband and nothing else: enough for motion and forces of modes in the passband.
"""

from dataclasses import dataclass

import numpy as np

from .kernels.decimation import BEHIND, RATIO, SLOTS

LEAST_STAGES = 2  # decimation of the second stage of a record at least
PASS_FRACTION = 0.78125  # of half the sampling frequency: 800 Hz of 1024 Hz
KAISER_ATTENUATION_DB = 100.0
DIFFERENCE_ERROR = 1e-6  # relative, of the second derivative up to the end of the passband
LONGEST_DIFFERENCE = 30  # order at most, even if DIFFERENCE_ERROR asks for more
# Of the polynomial in 1 - cos that compensates the first stage's droop: with a second stage, and
# without one, where the passband goes up to 0.39 of the middle rate.
DROOP_TERMS, DROOP_TERMS_ALONE = 5, 15


@dataclass(frozen=True)
class OutputFilter:
    """The taps of both stages.

    first (2 * half + 1,): at the step rate.
    second (tap,): at the step rate / RATIO.
    first_derivative, second_derivative (tap,): the same with one and two time derivatives, 1/s and
    1/s².
    step: decimation of the second stage.
    """

    first: np.ndarray
    second: np.ndarray
    first_derivative: np.ndarray
    second_derivative: np.ndarray
    step: int

    def taps(self, order: int) -> np.ndarray:
        """Second stage with so many time derivatives, 0 to 2; it is correlated, not convolved."""
        return (self.second, self.first_derivative, self.second_derivative)[order]

    @property
    def delay(self) -> int:
        """Half length of the second stage, in its input samples."""
        return (self.second.size - 1) // 2

    def phase_weights(self) -> np.ndarray:
        """First stage by (phase, slot): weight of step n = RATIO * tick + phase in output tick -
        BEHIND + slot.
        """
        half = (self.first.size - 1) // 2
        weights = np.zeros((RATIO, SLOTS))
        for phase in range(RATIO):
            for slot in range(SLOTS):
                lag = phase - RATIO * (slot - BEHIND)
                if abs(lag) <= half:
                    weights[phase, slot] = self.first[half + lag]
        return weights

    def response(self, frequency: np.ndarray, steps_per_second: float) -> np.ndarray:
        """Amplitude response of both stages before decimation, (frequency,); arguments in Hz."""
        frequency = np.asarray(frequency, float)
        first = _amplitude(self.first, frequency / steps_per_second)
        return first * _amplitude(self.second, frequency * RATIO / steps_per_second)


def output_filter(steps_per_second: float, sampling_frequency: float) -> OutputFilter:
    """The filter for one pair of rates [Hz].

    Raises ValueError when the ratio of the rates is not a multiple of RATIO.
    """
    ratio = steps_per_second / sampling_frequency
    if abs(ratio / RATIO - round(ratio / RATIO)) > 1e-9 or ratio < RATIO - 1e-9:
        raise ValueError(
            f"steps per second / sampling frequency = {ratio:g} must be a multiple of {RATIO}:"
            f" choose a sampling frequency of {steps_per_second / RATIO:g} Hz divided by a whole"
            " number"
        )
    middle_rate = steps_per_second / RATIO
    stop = 0.5 * sampling_frequency
    passband, one_stage = PASS_FRACTION * stop / middle_rate, round(ratio / RATIO) == 1
    first = _first_stage((passband / RATIO) if one_stage else stop / steps_per_second)
    lowpass = np.ones(1) if one_stage else _kaiser_lowpass(passband, stop / middle_rate)
    terms = DROOP_TERMS_ALONE if one_stage else DROOP_TERMS
    second = np.convolve(lowpass, _droop_compensation(first, passband, terms))
    order = next(
        (
            order
            for order in range(3, LONGEST_DIFFERENCE)
            if _difference_error(order, passband) < DIFFERENCE_ERROR
        ),
        LONGEST_DIFFERENCE,
    )
    return OutputFilter(
        first=first,
        second=np.pad(second, order),
        first_derivative=np.convolve(second, _first_difference(order) * middle_rate),
        second_derivative=np.convolve(second, _second_difference(order) * middle_rate**2),
        step=round(ratio / RATIO),
    )


def _first_stage(band: float) -> np.ndarray:
    """Taps with a gain of about 1 up to band (cycles per step) that stop its images around
    multiples of 1 / RATIO.

    A polynomial in x = cos(2 pi f) with Chebyshev-spaced zeros in each image band, one more in the
    nearest. Its length is the largest that SLOTS outputs can share.
    """
    pairs = (RATIO * SLOTS - 2) // 2
    images = RATIO // 2
    taps = np.ones(1)
    for image in range(1, images + 1):
        count = pairs // images + (1 if image <= pairs % images else 0)
        nodes = np.cos((2 * np.arange(count) + 1) * np.pi / (2 * count))
        for zero in np.cos(2 * np.pi * (image / RATIO + band * nodes)):
            taps = np.convolve(taps, [0.5, -zero, 0.5]) / (1.0 - zero)
    return taps


def _droop_compensation(first: np.ndarray, passband: float, terms: int) -> np.ndarray:
    """Taps at the middle rate that compensate the first stage's droop up to passband (cycles per
    middle sample); gain exactly 1 at 0.
    """
    frequency = np.linspace(0.0, passband, 200)[1:]
    x = 1.0 - np.cos(2 * np.pi * frequency)
    powers = x[:, None] ** np.arange(1, terms + 1)
    weights = np.linalg.lstsq(powers, 1.0 / _amplitude(first, frequency / RATIO) - 1.0, rcond=None)[
        0
    ]
    taps, power = np.ones(1), np.ones(1)
    for weight in weights:
        power = np.convolve(power, [-0.5, 1.0, -0.5])
        taps = np.pad(taps, 1) + weight * power
    return taps


def _kaiser_lowpass(passband: float, stopband: float) -> np.ndarray:
    """Odd-length windowed-sinc low-pass, band edges in cycles per sample (Kaiser 1974)."""
    width = 2 * np.pi * (stopband - passband)
    count = int(np.ceil((KAISER_ATTENUATION_DB - 8.0) / (2.285 * width)))
    half = (count + 1) // 2
    n = np.arange(-half, half + 1)
    cut = passband + stopband
    taps = cut * np.sinc(cut * n) * np.kaiser(2 * half + 1, 0.1102 * (KAISER_ATTENUATION_DB - 8.7))
    return taps / taps.sum()


def _first_difference(order: int) -> np.ndarray:
    """Central-difference weights of the first derivative at unit spacing, 2 * order + 1 points
    (Fornberg), in the order of the samples.
    """
    n = np.arange(1, order + 1)
    powers = n[None, :].astype(float) ** (2 * n[:, None] - 1)
    side = np.linalg.solve(powers, np.where(n == 1, 0.5, 0.0))
    return np.concatenate([-side[::-1], [0.0], side])


def _second_difference(order: int) -> np.ndarray:
    """Central-difference weights of the second derivative at unit spacing, 2 * order + 1 points
    (Fornberg).
    """
    n = np.arange(1, order + 1)
    powers = n[None, :].astype(float) ** (2 * n[:, None])
    side = np.linalg.solve(powers, np.where(n == 1, 1.0, 0.0))
    return np.concatenate([side[::-1], [-2.0 * side.sum()], side])


def _difference_error(order: int, passband: float) -> float:
    """Relative error of the second difference at the end of the passband (cycles per sample)."""
    return abs(
        _amplitude(_second_difference(order), np.array([passband]))[0] / (2 * np.pi * passband) ** 2
        + 1.0
    )


def _amplitude(taps: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Amplitude response of symmetric taps; frequency in cycles per sample."""
    half = (taps.size - 1) // 2
    return np.cos(2 * np.pi * np.outer(frequency, np.arange(-half, half + 1))) @ taps
