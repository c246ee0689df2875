"""The main peak's pole from the outputs alone: half spectra, LSCF at growing orders, and the pole
of the first stable order.

At low orders the estimator has a bias of its own (the modes outside the band), at high orders it
follows the noise. A low order is taken, and its bias is taken off: the exact spectra of the linear
tube with the pole just found go through the very same estimator, and what comes out different from
that tube's pole is subtracted. Where there is no model the stable order stands for itself.
"""

from dataclasses import dataclass

import numpy as np

from .half_spectra import half_spectra, lag_window
from .lscf import NormalEquations
from .segments import left_out_changes, widened
from .stabilisation import StabilisationChart, first_stable_order, nearest_pole, stabilisation_chart
from .update import frequency_of

LAG_TIMES_WIDTH = 0.6  # longest lag kept, in units of one over the peak's half-power width
SHORTEST_LAG_S = 0.5
BIAS_PASSES = 2
REACH_WIDTHS = 2.0  # how far from the peak its pole is looked for, in half-power widths
SHORTEST_REACH = 0.06  # the same, as a fraction of the peak's frequency


@dataclass(frozen=True)
class OperationalPole:
    """frequency (Hz, undamped) and damping_ratio of the main peak's pole, covariance (2, 2) of the
    two; order taken, and whether the pole was stable against the order before; bias: what was taken
    off the pole (rad/s); chart: the StabilisationChart.
    """

    frequency: float
    damping_ratio: float
    covariance: np.ndarray
    order: int
    stable: bool
    bias: complex
    chart: StabilisationChart


@dataclass(frozen=True)
class PoleSearch:
    """What the estimator needs to know: frequency (frequency,) Hz of the spectra, contiguous from
    0; band_Hz; window name; max_order.
    """

    frequency: np.ndarray
    band_Hz: tuple
    window: str
    max_order: int

    @property
    def band(self):
        """Return the slice of the bins in the band."""
        first = np.searchsorted(self.frequency, self.band_Hz[0], side="left")
        return slice(
            int(first), int(np.searchsorted(self.frequency, self.band_Hz[1], side="right"))
        )

    def chart_orders(self):
        """Return the orders of the chart: each up to 8, every second one above."""
        return [order for order in range(2, self.max_order + 1) if order <= 8 or order % 2 == 0]


def operational_pole(
    outputs, references, search, peak, averages=np.inf, duration_s=np.inf, tube_spectra=None
):
    """Return the OperationalPole of segment spectra outputs (output, segment, frequency), or None
    where no pole is near the peak.

    references: indices of the outputs that serve as references; search: PoleSearch; peak: (Hz,
    half-power width in Hz) as find_peak gives; averages: effective degrees of freedom of a bin;
    duration_s: length of the record; tube_spectra(frequency, damping_ratio) -> (cross-spectra
    (output, reference, frequency) of the linear tube with about that first pole, its exact pole in
    rad/s), or None where there is none (default: no model).
    """
    segments = outputs.shape[1]
    lags = lag_window(
        search.window,
        2 * (search.frequency.size - 1),
        1.0 / search.frequency[1],
        max(LAG_TIMES_WIDTH / peak[1], SHORTEST_LAG_S),
    )
    pairs = np.einsum("osf,rsf->sorf", outputs, outputs[list(references)].conj())
    halves = half_spectra(pairs, lags, search.band)
    band_frequency = search.frequency[search.band]
    mean = halves.mean(axis=0)
    chart = stabilisation_chart(
        NormalEquations(band_frequency, mean, search.max_order), lags.decay, search.chart_orders()
    )
    start = 2.0 * np.pi * complex(-0.5 * peak[1], peak[0])
    reach = max(REACH_WIDTHS * peak[1], SHORTEST_REACH * peak[0])
    order, stable = first_stable_order(chart, start, reach)

    def pole_in(values):
        poles = NormalEquations(band_frequency, values, order).poles(order)[0] + lags.decay
        chosen = nearest_pole(poles, start, reach)
        return None if chosen is None else poles[chosen]

    found = pole_in(mean)
    if found is None:
        return None
    bias = (
        0.0
        if tube_spectra is None
        else _estimator_bias(
            found, tube_spectra, lambda cross: pole_in(half_spectra(cross, lags, search.band))
        )
    )
    frequency, ratio = frequency_of(found - bias)
    covariance = least_covariance(frequency, ratio, duration_s)
    if segments > 2:
        without = [pole_in((segments * mean - half) / (segments - 1)) for half in halves]
        moved = np.array(
            [frequency_of((found if pole is None else pole) - bias) for pole in without]
        )
        covariance = widened(covariance, left_out_changes(moved), averages)
    return OperationalPole(float(frequency), float(ratio), covariance, order, stable, bias, chart)


def least_covariance(frequency, damping_ratio, duration_s):
    """Return the covariance (2, 2) of (frequency in Hz, damping ratio) that no estimate from
    duration_s seconds of random response beats.

    The Cramer-Rao bound of a lightly damped mode under white noise: the variances of omega and of
    zeta omega are both zeta omega / T.
    """
    omega = 2.0 * np.pi * frequency
    variance = damping_ratio * omega / duration_s
    return np.diag([variance / (2.0 * np.pi) ** 2, variance / omega**2])


def _estimator_bias(found, tube_spectra, estimate):
    """Return what the estimator adds to a pole (rad/s), seen on exact spectra of the linear tube
    with the corrected pole.
    """
    bias = 0.0
    for _ in range(BIAS_PASSES):
        tube = tube_spectra(*frequency_of(found - bias))
        out = None if tube is None else estimate(tube[0])
        if out is None:
            return 0.0
        bias = out - tube[1]
    return bias
