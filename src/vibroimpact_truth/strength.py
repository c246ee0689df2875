"""How strong what is hidden is: excess of the misfit over its floor, against the same campaign with nothing hidden."""

import numpy as np

BANDS, LOWEST_HZ, HIGHEST_HZ = 24, 5.0, 200.0
ABOVE_NOISE = 4.0  # 6 dB


def band_powers(series, sampling):
    """(…, band) mean square in 24 logarithmic bands from 5 to 200 Hz of (…, time), Hann window."""
    samples = series.shape[-1]
    window = np.hanning(samples)
    power = np.abs(np.fft.rfft(series * window)) ** 2 * 2.0 / (samples * np.sum(window**2))
    edges = np.searchsorted(np.fft.rfftfreq(samples, 1.0 / sampling), np.geomspace(LOWEST_HZ, HIGHEST_HZ, BANDS + 1))
    return np.stack([power[..., a:b].sum(axis=-1) for a, b in zip(edges[:-1], edges[1:], strict=True)], axis=-1)


def distance(one, other, noise, sampling, either=False):
    """RMS over bands and channels, in dB, of the difference of two (channel, time) responses where the first is 6 dB above noise.

    either: also where the other alone is, as when an effect silences a channel.
    """
    a, b = band_powers(one, sampling), band_powers(other, sampling)
    edges = np.geomspace(LOWEST_HZ, HIGHEST_HZ, BANDS + 1)
    audible = ABOVE_NOISE * (noise**2)[:, None] * np.diff(edges) / (0.5 * sampling)
    counted = (a > audible) | (either & (b > audible))
    return float(np.sqrt(np.mean((10.0 * np.log10(a[counted] / b[counted])) ** 2)))


def excess(seen, bare, again, noise, sampling):
    """{lsd_dB, floor_dB, excess_dB, excess_over_floor, either_over_floor} of (record, channel, time) responses.

    seen against the same with nothing hidden (bare) and with the same hidden from another start (again). The last counts bands that either
    holds above noise, the others those that `seen` does, as the misfit is defined.
    """
    found = {}
    for either in (True, False):
        lsd, floor = (np.sqrt(np.mean([distance(one, two, noise, sampling, either) ** 2 for one, two in zip(seen, other, strict=True)]))
                      for other in (bare, again))
        value = np.sqrt(max(0.0, lsd**2 - floor**2))
        found["either_over_floor" if either else "excess_over_floor"] = round(float(value / floor), 2)
    return {"lsd_dB": round(float(lsd), 3), "floor_dB": round(float(floor), 3), "excess_dB": round(float(value), 3), **found}
