"""A campaign as arrays: forces and responses in SI, the excited band, the noise of every
channel.
"""

import itertools
from dataclasses import dataclass

import numpy as np

from vibroimpact.campaign.file import channel_signal, force_signal

BANDS = 24
DEFAULT_BAND_HZ = (5.0, 200.0)
EXCITED = 1.0e-3  # of the largest smoothed force PSD: above it a line is excited
QUIET = 0.75  # of half the sampling frequency: where the anti-alias filter begins
QUIET_ABOVE = 1.6  # times the band's upper end
LEAST_QUIET = 50  # lines above the band: with fewer, the record was not sampled to tell its noise
BELOW, LEAST_LINES, MOST_LINES = (
    5.0,
    40,
    500,
)  # the spectrum is looked at from this much below the band; lines of a part of it
# sigma of the median of n lines is this over sqrt(n) of it: 1 / ln 2 for exponentials, sqrt(1.5)
# for neighbours under a Hann window
MEDIAN_SCATTER = 1.77
ALIKE = (
    4.0  # sigma: the least of some dozens of parts lies two below their mean, and none far above it
)


@dataclass(frozen=True)
class Signals:
    """force (record, force_channel, sample) N and response (record, channel, sample) SI, NaN beyond
    a record's valid samples.

    rate Hz; band_Hz: excited; kinds, names (channel,); gap (record,) m; load (record,) N RMS;
    split, record_names (record,); noise (channel,): RMS of white measuring noise over the whole
    range to half the sampling frequency; from_rest; sources: attributes of the file.
    """

    force: np.ndarray
    response: np.ndarray
    rate: float
    band_Hz: tuple[float, float]
    kinds: np.ndarray
    names: tuple[str, ...]
    gap: np.ndarray
    load: np.ndarray
    split: np.ndarray
    record_names: tuple[str, ...]
    noise: np.ndarray
    from_rest: bool

    @property
    def lowest(self):
        """Return the record of the lowest load; of several the one with the widest gap."""
        order = np.lexsort((-np.nan_to_num(self.gap, nan=np.inf), np.round(self.load, 9)))
        return int(order[0])

    @property
    def edges(self):
        """Return (BANDS + 1,) Hz: logarithmic bands over the excited band."""
        return np.geomspace(*self.band_Hz, BANDS + 1)

    @property
    def noise_in_band(self):
        """Return (channel,): RMS of the noise within the excited band."""
        return self.noise * np.sqrt((self.band_Hz[1] - self.band_Hz[0]) / (0.5 * self.rate))

    def fit(self):
        """Return the records of the split "fit"; all where none is named so."""
        chosen = np.flatnonzero(self.split != "holdout")
        return chosen if len(chosen) else np.arange(len(self.load))

    def holdout(self):
        """Return the records of the split "holdout"."""
        return np.flatnonzero(self.split == "holdout")


def signals_of(campaign, longest_s=None):
    """Return the Signals of a campaign Dataset, each record cut to longest_s where it is given;
    band, noise and loads are those of whole records.
    """
    rate = float(campaign.attrs["sampling_frequency"])
    records = campaign.sizes["record"]
    channels = campaign.sizes["channel"]
    samples = campaign.sizes["time"]
    kept = samples if longest_s is None else min(samples, round(longest_s * rate))
    response = np.full((records, channels, samples), np.nan)
    for record in range(records):
        for channel in range(channels):
            signal = channel_signal(campaign, record, channel)
            response[record, channel, : len(signal)] = signal
    force = np.full((records, campaign.sizes["force_channel"], samples), np.nan)
    for record, channel in np.ndindex(force.shape[:2]):
        signal = force_signal(campaign, record, channel)
        force[record, channel, : len(signal)] = signal
    valid = np.isfinite(response).all(axis=1)
    force = np.where(valid[:, None], force, np.nan)
    band = excited_band(force, rate)
    load = np.sqrt(np.nanmean(force[:, 0] ** 2, axis=-1))
    gap = np.asarray(campaign["gap"].values, float)
    split = (
        np.array([str(value) for value in campaign["split"].values])
        if "split" in campaign
        else np.full(records, "fit")
    )
    lowest = int(np.lexsort((-np.nan_to_num(gap, nan=np.inf), load))[0])
    return Signals(
        force=force[..., :kept],
        response=response[..., :kept],
        rate=rate,
        band_Hz=band,
        kinds=np.array([str(kind) for kind in campaign["channel_kind"].values]),
        names=tuple(map(str, campaign["channel_name"].values)),
        gap=gap,
        load=load,
        split=split,
        record_names=tuple(map(str, campaign["record_name"].values)),
        noise=noise_of(campaign, response[lowest], rate, band),
        from_rest=str(campaign.attrs.get("start_up", "rest")) == "rest",
    )


def excited_band(force, rate):
    """Return (low, high) Hz: where the PSD of the first force of all records is above EXCITED of
    its largest, within 1 % of a decade.
    """
    length = int(4.0 * rate)
    window = np.hanning(length)
    power = np.zeros(length // 2 + 1)
    for series in np.nan_to_num(force[:, 0]):
        for first in range(0, max(len(series) - length, 0) + 1, length // 2):
            power += (
                np.abs(np.fft.rfft(window * np.resize(series[first : first + length], length))) ** 2
            )
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    smooth = np.convolve(power, np.ones(5) / 5.0, mode="same")
    inside = (
        np.flatnonzero(smooth[1:] > EXCITED * np.median(np.sort(smooth[1:])[-len(smooth) // 50 :]))
        + 1
    )
    low, high = frequency[inside[0]] + 0.5, frequency[inside[-1]] - 0.5
    if abs(low - DEFAULT_BAND_HZ[0]) < 1.5 and abs(high - DEFAULT_BAND_HZ[1]) < 3.0:
        return DEFAULT_BAND_HZ
    return float(max(low, 2.0 / (force.shape[-1] / rate))), float(high)


def noise_of(campaign, response, rate, band):
    """Return (channel,) RMS of the noise: as the campaign says, or the least density of the lowest
    record's spectrum; 0 where neither tells.

    Where the lowest record touches, impacts fill the range above the band: noise is what parts of
    the spectrum that are as low as the lowest have, within their scatter.
    """
    if "noise_floor_rms" in campaign:
        return np.asarray(campaign["noise_floor_rms"].values, float)
    valid = response[:, np.isfinite(response).all(axis=0)]
    window = np.hanning(valid.shape[-1])
    frequency = np.fft.rfftfreq(valid.shape[-1], 1.0 / rate)
    quiet = (frequency > QUIET_ABOVE * band[1]) & (frequency < QUIET * 0.5 * rate)
    if quiet.sum() < LEAST_QUIET:
        return np.zeros(len(response))
    power = np.abs(np.fft.rfft(window * valid, axis=-1)) ** 2
    edges = _edges(*np.searchsorted(frequency, [band[0] / BELOW, QUIET * 0.5 * rate]))
    lines = np.diff(edges)
    # from the median: lines of noise are exponentials, and a few of something else do not count
    density = np.array(
        [np.median(power[:, low:high], axis=-1) for low, high in itertools.pairwise(edges)]
    ) / np.log(2.0)
    # as a factor: of some dozens of narrow parts one has half of the density, and would leave out
    # all others
    least = np.min(density * np.exp(ALIKE * MEDIAN_SCATTER / np.sqrt(lines))[:, None], axis=0)
    share = lines[:, None] * (density <= least)
    return np.sqrt(np.sum(share * density, axis=0) / np.sum(share, axis=0) / np.sum(window**2))


def _edges(first, last):
    """Return the lines between parts of a spectrum's lines from first to last: narrow where lines
    are few, never wider than MOST_LINES.
    """
    edges = [first]
    while edges[-1] < last:
        edges.append(edges[-1] + min(MOST_LINES, max(LEAST_LINES, edges[-1] // 2)))
    return edges[:-1] if len(edges) > 2 else [first, last]
