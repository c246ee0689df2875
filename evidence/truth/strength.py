"""The strength of hidden effects: excess of the misfit over its floor.

The campaign is compared with the same campaign with nothing hidden.
"""

import numpy as np

BANDS, LOWEST_HZ, HIGHEST_HZ = 24, 5.0, 200.0
EXCITED = (LOWEST_HZ, HIGHEST_HZ)
ABOVE_NOISE = 4.0  # 6 dB
LEAST_FLOOR_DB = 0.5  # of a channel: what two codes of one physics differ by


def band_powers(series, sampling, band=EXCITED):
    """(…, band) mean square in 24 logarithmic bands of `band` [Hz] of (…, time), Hann window."""
    samples = series.shape[-1]
    window = np.hanning(samples)
    power = np.abs(np.fft.rfft(series * window)) ** 2 * 2.0 / (samples * np.sum(window**2))
    edges = np.searchsorted(
        np.fft.rfftfreq(samples, 1.0 / sampling), np.geomspace(*band, BANDS + 1)
    )
    return np.stack(
        [power[..., a:b].sum(axis=-1) for a, b in zip(edges[:-1], edges[1:], strict=True)], axis=-1
    )


def audible_powers(noise, sampling, band):
    """(channel, band) mean squares 6 dB above noise (channel,) RMS, white up to the Nyquist."""
    edges = np.geomspace(*band, BANDS + 1)
    return ABOVE_NOISE * (noise**2)[:, None] * np.diff(edges) / (0.5 * sampling)


def distance(one, others, audible, either=False):
    """RMS in dB over bands and channels of band powers against the mean of others.

    one (…, band), others (twin, …, band), audible (…, band): powers below it do not count.
    either: a band also counts where the mean of others is audible, as when an effect silences a
    channel.
    """
    mean = np.mean(others, axis=0)
    counted = (one > audible) | (either & (mean > audible))
    return float(np.sqrt(np.mean((10.0 * np.log10(one[counted] / mean[counted])) ** 2)))


def by_channel(one, others, audible):
    """(channel,) RMS in dB over records and bands against the mean of others, NaN where nothing is
    audible. Arguments as in `distance`. A band counts where `one` or the mean is audible: an effect
    may silence a channel.
    """
    mean = np.mean(others, axis=0)
    counted = (one > audible) | (mean > audible)
    squares = np.where(counted, (10.0 * np.log10(one / mean)) ** 2, 0.0).sum(axis=(0, 2))
    number = counted.sum(axis=(0, 2))
    return np.sqrt(np.divide(squares, number, out=np.full(len(number), np.nan), where=number > 0))


def strength_by_channel(seen, bare, repeats, audible):
    """Excess over the floor, each channel in floors of its own: the root of the mean of (distance
    over floor)² less 1.

    Band powers: seen (…), bare (twin, …) with nothing hidden, repeats (twin, …) of which each is
    compared with the others for the floor.
    In all channels together, one that moves by chance alone would hide what the others show.
    """
    floors = np.sqrt(
        np.mean(
            [
                by_channel(one, np.delete(repeats, k, axis=0), audible) ** 2
                for k, one in enumerate(repeats)
            ],
            axis=0,
        )
    )
    ratios = by_channel(seen, bare, audible) / np.maximum(floors, LEAST_FLOOR_DB)
    heard = np.isfinite(ratios)
    return float(np.sqrt(max(0.0, np.mean(ratios[heard] ** 2) - 1.0))) if heard.any() else 0.0


def excess(seen, bare, again, noise, sampling, band=EXCITED):
    """{floors, lsd_dB, floor_dB, excess_dB, excess_over_floor, either_over_floor} of responses.

    seen (record, channel, time): the responses.
    bare (twin, record, channel, time): with nothing hidden, from other initial states.
    again (twin, record, channel, time): with the same hidden, from other initial states.
    noise (channel,): RMS.

    lsd: distance of seen from the mean of bare. floor: RMS distance of each of seen and again from
    the mean of the rest; single pairs would scatter by a factor of 1.7 in 20 s records. Bands count
    where `seen` is 6 dB above noise, as in the definition of the misfit; in either_over_floor,
    where `seen` or the mean is. floors: see strength_by_channel.
    """
    audible = audible_powers(noise, sampling, band)
    powers = band_powers(np.array([seen, *again]), sampling, band)
    found = {}
    for either in (True, False):
        lsd = distance(powers[0], band_powers(np.asarray(bare), sampling, band), audible, either)
        floor = np.sqrt(
            np.mean(
                [
                    distance(one, np.delete(powers, k, axis=0), audible, either) ** 2
                    for k, one in enumerate(powers)
                ]
            )
        )
        value = np.sqrt(max(0.0, lsd**2 - floor**2))
        found["either_over_floor" if either else "excess_over_floor"] = round(
            float(value / floor), 2
        )
    bare_powers = band_powers(np.asarray(bare), sampling, band)
    return {
        "floors": round(strength_by_channel(powers[0], bare_powers, powers, audible), 2),
        "lsd_dB": round(lsd, 3),
        "floor_dB": round(float(floor), 3),
        "excess_dB": round(float(value), 3),
        **found,
    }
