"""A campaign as arrays: forces and responses in SI, the excited band, the noise of channels."""

import itertools
from dataclasses import dataclass

import numpy as np
import xarray as xr

from vibroimpact.campaign.base_motion import relative_to_base
from vibroimpact.campaign.force_kinds import shown_load_unit
from vibroimpact.campaign.signals import campaign_signals, excited_band

BANDS = 24
QUIET = 0.75  # of half the sampling frequency: the anti-alias filter begins there
QUIET_ABOVE = 1.6  # times the upper end of the band: the range without excitation begins there
LEAST_QUIET = 50  # lines in that range: with fewer, the noise is read in the band
# The spectrum is divided into parts from the band's lower end over BELOW on; lines of a part.
BELOW, LEAST_LINES, MOST_LINES = 5.0, 40, 500
# Relative sigma of the median of n lines, times sqrt(n): 1 / ln 2 for exponentials, times sqrt(1.5)
# for neighbours under a Hann window.
MEDIAN_SCATTER = 1.77
SEGMENT_S = 4.0
RESOLUTION = 1.0e-6  # of a channel's largest response: no recorder resolves less of its range
STOPPED = 0.975  # of half the sampling frequency, from which the anti-alias filter stops a signal
SAME_LOAD = 9  # decimals of a load in N: loads equal to so many are one level
# sigma: the least of some dozens of parts lies two below their mean, and none far above it
ALIKE = 4.0


@dataclass(frozen=True)
class Signals:
    """The signals of a campaign in SI units, NaN beyond the valid samples of a record.

    force (record, force_channel, sample): N, or m/s² of the base.
    response (record, channel, sample): relative to the base.
    rate: sampling frequency, Hz. band_Hz: the excited band. kinds, names (channel,).
    gap (record,): m. load (record,): RMS of the first force, in load_unit.
    split, record_names (record,).
    noise (channel,): RMS of white measuring noise over the range to half the sampling frequency, at
    the lowest load. record_noise (record, channel): the same of each record.
    from_rest: whether records begin at rest.
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
    record_noise: np.ndarray
    from_rest: bool
    load_unit: str = "N"

    @property
    def edges(self) -> np.ndarray:
        """Return (BANDS + 1,) in Hz: the edges of logarithmic bands over the excited band."""
        return np.geomspace(*self.band_Hz, BANDS + 1)

    def fit(self) -> np.ndarray:
        """Return the records not of the split "holdout"; all records if all of them are."""
        chosen = np.flatnonzero(self.split != "holdout")
        return chosen if len(chosen) else np.arange(len(self.load))

    def holdout(self) -> np.ndarray:
        """Return the records of the split "holdout"."""
        return np.flatnonzero(self.split == "holdout")


def signals_of(campaign: xr.Dataset) -> Signals:
    """Return the Signals of a campaign Dataset."""
    measured = relative_to_base(campaign_signals(campaign).require_units())
    rate = measured.rate
    force, response = measured.padded(campaign.sizes["time"])
    valid = np.isfinite(response).all(axis=1)
    force = np.where(valid[:, None], force, np.nan)
    band = measured.stated_band or excited_band(force, rate)
    load = measured.load_rms
    gap = measured.gap
    # of equal loads (repeats of one force, up to rounding) that of the widest gap
    lowest = np.lexsort((-np.nan_to_num(gap, nan=np.inf), np.round(load, SAME_LOAD)))[0]
    read = noise_of(campaign, (force[lowest], response[lowest]), rate, band, measured.factors)
    noise = np.maximum(read, RESOLUTION * np.sqrt(np.nanmean(response**2, axis=-1)).max(axis=0))
    # simulations get at least RESOLUTION of noise: a measurement with less is raised to that
    quiet, rng = np.flatnonzero(noise > read), np.random.default_rng(7)
    lacking = np.sqrt(noise[quiet] ** 2 - read[quiet] ** 2)[:, None]
    response[:, quiet] += lacking * rng.standard_normal(response[:, quiet].shape)
    return Signals(
        force=force,
        response=response,
        rate=rate,
        band_Hz=band,
        kinds=np.array(measured.kinds),
        names=tuple(measured.channels),
        gap=gap,
        load=load,
        split=np.array(measured.splits),
        record_names=tuple(measured.records),
        noise=noise,
        record_noise=_of_records(campaign, response, noise, lowest, rate),
        from_rest=str(campaign.attrs.get("start_up", "rest")) == "rest",
        load_unit=shown_load_unit(campaign),
    )


def noise_of(
    campaign: xr.Dataset,
    lowest: tuple[np.ndarray, np.ndarray],
    rate: float,
    band: tuple[float, float],
    factors: np.ndarray | float = 1.0,
) -> np.ndarray:
    """Return (channel,) RMS of the noise in SI, as stated by the campaign.

    Without a statement, it is the least spectral density of the record of the lowest load: (force
    (force_channel, sample), response (channel, sample)). With contact, impacts fill the range above
    the band, so that it is the mean over the parts of the spectrum that are as low as the lowest
    one, within their scatter. With too few lines above the band, it is the part that the forces do
    not explain in the band. rate, band: Hz. factors (channel,): SI units per stored unit.
    """
    if "noise_floor_rms" in campaign:
        return np.asarray(campaign["noise_floor_rms"].values, float) * factors
    inside = np.isfinite(lowest[1]).all(axis=0)
    force, response = (rows[:, inside] for rows in lowest)
    window = np.hanning(response.shape[-1])
    frequency = np.fft.rfftfreq(response.shape[-1], 1.0 / rate)
    quiet = (frequency > QUIET_ABOVE * band[1]) & (frequency < QUIET * 0.5 * rate)
    if quiet.sum() < LEAST_QUIET:
        return _unexplained(force, response, rate, band)
    power = np.abs(np.fft.rfft(window * response, axis=-1)) ** 2
    edges = _edges(*np.searchsorted(frequency, [band[0] / BELOW, QUIET * 0.5 * rate]))
    lines = np.diff(edges)
    # The lines of noise follow an exponential law. Its median ignores a few lines of other origin.
    density = np.array(
        [np.median(power[:, low:high], axis=-1) for low, high in itertools.pairwise(edges)]
    ) / np.log(2.0)
    # The scatter is a factor: the least of some dozens of narrow parts has half of the density, and
    # would otherwise exclude all others.
    least = np.min(density * np.exp(ALIKE * MEDIAN_SCATTER / np.sqrt(lines))[:, None], axis=0)
    share = lines[:, None] * (density <= least)
    return np.sqrt(np.sum(share * density, axis=0) / np.sum(share, axis=0) / np.sum(window**2))


def _of_records(
    campaign: xr.Dataset, response: np.ndarray, noise: np.ndarray, lowest: int, rate: float
) -> np.ndarray:
    """Return (record, channel) RMS of the noise of each record, as stated by the campaign.

    A recorder whose range follows the level has noise that does. Without a statement, it is read
    where the anti-alias filter stops the signal, and lies between that of the lowest load and this
    times the level.
    """
    if "noise_floor_rms" in campaign:
        return np.tile(noise, (len(response), 1))
    power = np.nanmean(response**2, axis=-1)
    level = np.sqrt(power / np.maximum(power[lowest], np.finfo(float).tiny))
    return np.clip([_stopped(own, rate) for own in response], noise, noise * np.maximum(level, 1.0))


def _stopped(response, rate):
    """Return (channel,) RMS of white noise with the spectral density of a record above STOPPED."""
    response = response[:, np.isfinite(response).all(axis=0)]
    window = np.hanning(response.shape[-1])
    frequency = np.fft.rfftfreq(len(window), 1.0 / rate)
    lines = np.fft.rfft(window * response, axis=-1)[:, frequency > STOPPED * 0.5 * rate]
    return np.sqrt(np.median(np.abs(lines) ** 2, axis=-1) / np.log(2.0) / np.sum(window**2))


def _unexplained(force, response, rate, band):
    """Return (channel,) RMS, over the range to half the rate, of the noise that is not coherent
    with the forces; arguments as of noise_of.

    The density is the least of BANDS parts of the band: between the peaks of a response the forces
    explain it best.
    """
    length = min(response.shape[-1], round(SEGMENT_S * rate))
    starts = range(0, response.shape[-1] - length + 1, length // 2)
    window = np.hanning(length)
    force, response = (
        np.stack([np.fft.rfft(window * rows[:, at : at + length], axis=-1) for at in starts], 1)
        for rows in (force, response)
    )
    own = np.einsum("fsl,gsl->lfg", force, force.conj())
    both = np.einsum("csl,fsl->lcf", response, force.conj())
    own += 1.0e-12 * np.einsum("lff->l", own).real[:, None, None] * np.eye(len(force))
    explained = np.einsum("lcf,lfg,lcg->cl", both, np.linalg.pinv(own), both.conj()).real
    freedom = max(len(starts) - len(force), 1)
    rest = np.maximum(np.sum(np.abs(response) ** 2, axis=1) - explained, 0.0) / freedom
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    edges = np.searchsorted(frequency, np.geomspace(*band, BANDS + 1))
    density = [
        rest[:, low:high].mean(axis=-1)
        for low, high in itertools.pairwise(edges)
        if high - low >= LEAST_LINES // 4
    ]
    least = np.min(density, axis=0) if density else np.zeros(len(response))
    return np.sqrt(least / np.sum(window**2))


def _edges(first, last):
    """Return the line numbers that divide the lines from first to last into parts, each of half as
    many lines as lie below it, LEAST_LINES to MOST_LINES.
    """
    edges = [first]
    while edges[-1] < last:
        edges.append(edges[-1] + min(MOST_LINES, max(LEAST_LINES, edges[-1] // 2)))
    return edges[:-1] if len(edges) > 2 else [first, last]
