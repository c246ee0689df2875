"""The features that are compared: band powers, coherences, skewness and kurtosis of a record.

Both measured and simulated records contain the measuring noise. Features are scaled so that their
scatter hardly depends on their level: decibels for powers, Fisher's z for coherences and
correlations, the cube root of skewness, the logarithm of kurtosis.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import fft

from .signals import Signals

COARSE = 8  # bands of the coherences
SEGMENT_S = 5.0
LEAST_SEGMENTS = 7
SAME_POINT_M = 1.0e-3
# variance in SI below which a channel does not move: it is given the shape of noise
STILL = 1.0e-100
BLEND = {
    "power": 10.0,
    "coherence": 1.0,
    "co": 1.0,
    "quad": 1.0,
    "skewness": 0.5,
    "kurtosis": 0.5,
}  # larger differences are compressed, see `compressed`


@dataclass(frozen=True)
class FeatureLayout:
    """The features of a record of a campaign.

    rate: Hz. edges (band + 1,), coarse (coarse + 1,): Hz. pairs [(channel, channel)]: two
    directions at one point. kind, channel, band (feature,): of each feature; band -1 for none.
    """

    rate: float
    edges: np.ndarray
    coarse: np.ndarray
    pairs: list[tuple[int, int]]
    kind: np.ndarray
    channel: np.ndarray
    band: np.ndarray

    @cached_property
    def blend(self) -> np.ndarray:
        """Return (feature,): the difference beyond which each feature is compressed."""
        return np.array([BLEND[kind] for kind in self.kind])

    def power(self, features: np.ndarray) -> np.ndarray:
        """Return the band powers (..., channel, band) in dB of features (..., feature)."""
        chosen = np.flatnonzero(self.kind == "power")
        return features[..., chosen].reshape(*features.shape[:-1], -1, len(self.edges) - 1)


def feature_layout(signals: Signals, points: np.ndarray) -> FeatureLayout:
    """Return the FeatureLayout of Signals; points (channel, 3): places of the channels in m."""
    channels = len(signals.names)
    pairs = [
        (a, b)
        for a in range(channels)
        for b in range(a + 1, channels)
        if np.linalg.norm(points[a] - points[b]) < SAME_POINT_M
        and signals.kinds[a] == signals.kinds[b]
    ]
    bands = len(signals.edges) - 1
    rows = [("power", c, b) for c in range(channels) for b in range(bands)]
    rows += [("coherence", c, b) for c in range(channels) for b in range(COARSE)]
    rows += [(kind, a, b) for kind in ("co", "quad") for a, _ in pairs for b in range(COARSE)]
    rows += [(kind, c, -1) for kind in ("skewness", "kurtosis") for c in range(channels)]
    kind, channel, band = zip(*rows, strict=True)
    return FeatureLayout(
        signals.rate,
        signals.edges,
        np.geomspace(*signals.band_Hz, COARSE + 1),
        pairs,
        np.array(kind),
        np.array(channel),
        np.array(band),
    )


def record_features(layout: FeatureLayout, force: np.ndarray, response: np.ndarray) -> np.ndarray:
    """Return (feature,) of one record: force (sample,), response (channel, sample), valid samples
    only.
    """
    samples = response.shape[-1]
    length = fft.next_fast_len(
        min(round(SEGMENT_S * layout.rate), 2 * samples // (LEAST_SEGMENTS + 1))
    )
    step = length // 2
    count = 1 + (samples - length) // step
    window = np.hanning(length + 1)[:-1].astype(np.float32)
    series = np.concatenate([response, force[None]]).astype(np.float32)
    segments = np.lib.stride_tricks.sliding_window_view(series, length, axis=-1)[
        :, : count * step : step
    ]
    frequency = fft.rfftfreq(length, 1.0 / layout.rate)
    lines = frequency <= layout.edges[-1]
    spectra = fft.rfft(segments * window, axis=-1)[..., lines]
    scale = 2.0 / (layout.rate * np.sum(window.astype(float) ** 2)) * layout.rate / length
    power = scale * _mean_product(spectra, spectra).real.astype(float)
    cross = scale * _mean_product(spectra[:-1], spectra[-1:])
    fine = _sums(frequency[lines], layout.edges)
    coarse = _sums(frequency[lines], layout.coarse)
    values = [10.0 * np.log10(np.maximum(power[:-1] @ fine, 1.0e-300)).ravel()]
    # Spectra summed over lines would mix phases: coherence is averaged over lines, weighted by
    # power.
    coherent = np.abs(cross) ** 2 / np.maximum(power[-1], 1.0e-300)
    share = (coherent @ coarse) / np.maximum(power[:-1] @ coarse, 1.0e-300)
    values.append(np.arctanh(np.sqrt(np.clip(share, 0.0, 0.9999))).ravel())
    both = [scale * _mean_product(spectra[[a]], spectra[[b]])[0] for a, b in layout.pairs]
    for part in (np.real, np.imag):
        for (a, b), product in zip(layout.pairs, both, strict=True):
            level = np.sqrt((power[a] @ coarse) * (power[b] @ coarse))
            values.append(
                np.arctanh(
                    np.clip(part(product) @ coarse / np.maximum(level, 1.0e-300), -0.9999, 0.9999)
                )
            )
    centred = np.asarray(response, np.float64) - response.mean(
        axis=-1, keepdims=True, dtype=np.float64
    )
    square = centred * centred
    variance = square.mean(axis=-1)
    still = variance < STILL
    variance = np.where(still, 1.0, variance)
    skewness = np.mean(square * centred, axis=-1) / variance**1.5
    kurtosis = np.mean(square * square, axis=-1) / (3.0 * variance**2)
    values.append(np.cbrt(np.where(still, 0.0, skewness)))
    values.append(np.log(np.where(still, 1.0, kurtosis)))
    return np.concatenate(values)


def _mean_product(one, other):
    """Return (channel, line): the mean over segments of one times the conjugate of the other.

    one, other: (channel, segment, line).
    """
    return np.einsum("csl,csl->cl", one, np.broadcast_to(other, one.shape).conj()) / one.shape[1]


def compressed(difference: np.ndarray, layout: FeatureLayout) -> np.ndarray:
    """Return differences (..., feature) of features, linear well below BLEND and logarithmic
    above, so that large differences do not dominate.
    """
    return layout.blend * np.arcsinh(difference / layout.blend)


def _sums(frequency, edges):
    """Return (line, band) 0 or 1: the lines of each band, the nearest one where a band has none."""
    inside = (frequency[:, None] >= edges[:-1]) & (frequency[:, None] < edges[1:])
    middle = np.sqrt(edges[:-1] * edges[1:])
    for band in np.flatnonzero(~inside.any(axis=0)):
        inside[np.argmin(np.abs(frequency - middle[band])), band] = True
    return inside.astype(float)
