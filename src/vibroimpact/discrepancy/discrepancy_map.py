"""The discrepancy map: measured against simulated band powers per record, channel and band, with z
from seeds, and clusters of bands.
"""

import numpy as np
import xarray as xr
from scipy import stats

from vibroimpact.campaign.force_kinds import base_channels, load_unit
from vibroimpact.observation.features import BLEND, compressed
from vibroimpact.units import SI_OF_KIND

from . import priors
from .covariance import feature_sd, free_directions
from .driven_channels import driven_channels
from .misfit import counted

SMOOTH = (0.25, 0.5, 0.25)  # a variance from few seeds is shared with the neighbouring bands
SPECTRUM_HZ = 0.4  # resolution of the spectra shown
SHOWN_SEEDS = 4
FREEDOM = 15  # of the t law of z, whose variance is of some 16 runs
PEAK = 0.5  # of the largest difference in dB: bands beside it that differ by as much belong to it


def z_of(bench, null, seeds, model=None):
    """Return (D, z, sd), each (record, channel, band): the measured band powers against seeds
    (record, seed, feature) of a model, in dB, in standard deviations, and these in dB.

    They are those of the covariance that the verdict is decided by; differences beyond what
    features.BLEND says are drawn in there too. null: Null of the model; model (record, feature):
    mean of one with an effect, of whose change a share is uncertain as its law.
    """
    layout = bench.layout
    difference = layout.power(bench.measured_features) - layout.power(seeds).mean(axis=1)
    sd = layout.power(standard_deviation(bench, null, seeds, model))
    drawn_in = BLEND["power"] * np.arcsinh(difference / BLEND["power"])
    return difference, drawn_in / sd, sd


def standard_deviation(bench, null, seeds, model=None):
    """Return (record, feature): one sigma of a measured record about the mean of a model; arguments
    as of z_of. A record that the verdict reads by its modes alone has that of its seeds and of what
    two codes differ by.
    """
    layout, common = bench.layout, free_directions(bench.layout, driven_channels(bench))
    variance = smoothed(seeds.var(axis=1, ddof=1), layout) * (1.0 + 1.0 / seeds.shape[1])
    variance += feature_sd(layout) ** 2 + np.sum(common**2, axis=0)
    variance[null.records] = np.diagonal(null.covariance, axis1=1, axis2=2)
    if model is not None:
        change = compressed(model[null.records] - null.mean, layout)
        variance[null.records] += (priors.LAW_SD**2 + priors.LAW_COMMON_SD**2) * change**2
    return np.sqrt(variance)


def smoothed(variance, layout):
    """Return variances (record, feature), those of band powers shared with the neighbouring bands:
    they are of few seeds.
    """
    out = variance.copy()
    out[:, layout.kind == "power"] = np.apply_along_axis(
        lambda row: np.convolve(np.pad(row, 1, mode="edge"), SMOOTH, mode="valid"),
        -1,
        layout.power(variance),
    ).reshape(len(variance), -1)
    return out


def significant(z, chosen):
    """Return (record, channel, band) bool: cells beyond chance at a false-discovery rate, the error
    rate of the verdict (Y. Benjamini, Y. Hochberg, J. R. Stat. Soc. B 57, 1995).
    """
    p = 2.0 * stats.t.sf(np.abs(z), FREEDOM)
    inside = np.sort(p[chosen])
    passed = np.flatnonzero(
        inside <= priors.SIGNIFICANT * (1 + np.arange(inside.size)) / max(inside.size, 1)
    )
    return chosen & (p <= inside[passed[-1]]) if passed.size else np.zeros_like(chosen)


def regions(bench, difference, z, chosen):
    """Return the clusters of significant neighbouring bands, as verdict.json has them, the
    strongest first.
    """
    marked, edges, signals = significant(z, chosen), bench.layout.edges, bench.signals
    found = []
    for record, channel in np.ndindex(marked.shape[:2]):
        own = difference[record, channel]
        for part in clusters(own, marked[record, channel]):
            peak = part[np.argmax(np.abs(z[record, channel, part]))]
            found.append(
                {
                    "band_Hz": [float(edges[part[0]]), float(edges[part[-1] + 1])],
                    "load_rms_N": float(signals.load[record]),
                    "gap_m": None if np.isnan(signals.gap[record]) else float(signals.gap[record]),
                    "channel": signals.names[channel],
                    "record": signals.record_names[record],
                    "discrepancy_dB": float(own[part].mean()),
                    "z": float(z[record, channel, peak]),
                    "nearest_modes_Hz": nearest(bench, edges[part[0]], edges[part[-1] + 1]),
                }
            )
    return sorted(found, key=lambda row: -abs(row["z"]))


def clusters(difference, marked):
    """Return [(band,)]: runs of marked bands of one sign within PEAK of their largest difference,
    from the largest down; difference, marked (band,).
    """
    left, out = marked.copy(), []
    while left.any():
        top = int(np.argmax(np.where(left, np.abs(difference), 0.0)))
        inside = left & (difference * np.sign(difference[top]) >= PEAK * np.abs(difference[top]))
        low, high = top, top
        while low > 0 and inside[low - 1]:
            low -= 1
        while high + 1 < len(left) and inside[high + 1]:
            high += 1
        out.append(np.arange(low, high + 1))
        left[low : high + 1] = False
    return out


def nearest(bench, low, high):
    """Return [Hz] of the modes in a band, or the one nearest to its middle."""
    frequencies = bench.bare.frequencies[bench.bare.frequencies < 3.0 * bench.layout.edges[-1]]
    inside = frequencies[(frequencies >= low) & (frequencies <= high)]
    middle = np.sqrt(low * high)
    return [
        round(float(value), 2)
        for value in (
            inside if len(inside) else [frequencies[np.argmin(np.abs(frequencies - middle))]]
        )
    ]


def _about(long_name, units="", comment=""):
    """Return the attributes of a variable; UDUNITS has no decibel, which stands in a comment."""
    given = {"units": units, "long_name": long_name, "comment": comment}
    return {name: text for name, text in given.items() if text}


PSD_UNIT = "square of the unit of the channel per Hz"
# Attributes of the variables of map_dataset.
MAP_ABOUT = {
    "measured_dB": _about("measured power of the band", comment="in dB"),
    "simulated_dB": _about("simulated power of the band, mean over seeds", comment="in dB"),
    "sd_dB": _about(
        "standard deviation of the measured power about the simulated", comment="in dB"
    ),
    "D": _about("measured over simulated power of the band", comment="in dB"),
    "z": _about("difference of the powers in standard deviations", "1"),
    "band_Hz": _about("edges of the band", "Hz"),
    "counted": _about("1 where the cell counts in the misfit", "1"),
    "record_name": _about("name of the record"),
    "load_rms": _about("RMS of the force", "N"),
    "gap": _about("radial gap of the record", "m"),
    "split": _about("use of the record: fit or holdout"),
    "channel_name": _about("name of the channel"),
    "channel_unit": _about("SI unit of the channel"),
    "channel_point": _about("place of the channel", "m"),
    "channel_direction": _about("positive sense of the channel", "1"),
    "force_channel_point": _about("place of the force", "m"),
    "force_channel_direction": _about("positive sense of the force", "1"),
    "psd_frequency": _about("frequency", "Hz"),
    "psd_measured": _about("measured power spectral density", comment=PSD_UNIT),
    "psd_simulated_mean": _about("simulated PSD, mean over seeds", comment=PSD_UNIT),
    "psd_simulated_low": _about("simulated PSD, smallest over seeds", comment=PSD_UNIT),
    "psd_simulated_high": _about("simulated PSD, largest over seeds", comment=PSD_UNIT),
}


def map_dataset(bench, compared, seeds, responses):
    """Return the map as a Dataset: compared: as z_of returns it; seeds (record, seed, feature);
    responses (record, shown seed, channel, sample) of the same model with noise.
    """
    difference, z, sd = compared
    layout, signals = bench.layout, bench.signals
    cell, line = ("record", "channel", "band"), ("record", "channel", "frequency")
    frequency, measured = _spectra(signals, signals.response)
    shown = np.stack(
        [_spectra(signals, responses[:, seed])[1] for seed in range(responses.shape[1])]
    )
    data = {
        "measured_dB": (cell, layout.power(bench.measured_features)),
        "simulated_dB": (cell, layout.power(seeds).mean(axis=1)),
        "sd_dB": (cell, sd),
        "D": (cell, difference),
        "z": (cell, z),
        "band_Hz": (("band", "edge"), np.stack([layout.edges[:-1], layout.edges[1:]], axis=1)),
        "counted": (cell, counted(bench).astype(np.int8)),
        "record_name": ("record", np.array(signals.record_names, dtype=object)),
        "load_rms": ("record", signals.load),
        "gap": ("record", signals.gap),
        "split": ("record", signals.split.astype(object)),
        "channel_name": ("channel", np.array(signals.names, dtype=object)),
        "channel_unit": (
            "channel",
            np.array([SI_OF_KIND[str(kind)] for kind in signals.kinds], dtype=object),
        ),
        "psd_frequency": ("frequency", frequency),
        "psd_measured": (line, measured),
        "psd_simulated_mean": (line, shown.mean(axis=0)),
        "psd_simulated_low": (line, shown.min(axis=0)),
        "psd_simulated_high": (line, shown.max(axis=0)),
    }
    for role in ("channel", "force_channel"):
        for part in ("point", "direction"):
            values = bench.campaign[f"{role}_{part}"].values.astype(float)
            data[f"{role}_{part}"] = ((role, "xyz"), values)
    bases = base_channels(bench.campaign)
    # the place of an acceleration of the base is of no account, and not drawn
    data["force_channel_point"][1][bases] = np.nan
    about = MAP_ABOUT | {"load_rms": MAP_ABOUT["load_rms"] | {"units": load_unit(bench.campaign)}}
    described = {name: (*variable, about[name]) for name, variable in data.items()}
    return xr.Dataset(described, attrs={"title": "vibroimpact map of the discrepancy"})


def _spectra(signals, response):
    """Return (frequency Hz, PSD (record, channel, frequency)) up to twice the excited band,
    averaged over Hann segments of 1/SPECTRUM_HZ.
    """
    length = round(signals.rate / SPECTRUM_HZ)
    window = np.hanning(length)
    frequency = np.fft.rfftfreq(length, 1.0 / signals.rate)
    kept = (frequency > 0.0) & (frequency <= min(2.0 * signals.band_Hz[1], 0.4 * signals.rate))
    out = np.zeros((*response.shape[:2], kept.sum()))
    for record in range(len(response)):
        valid = response[record][:, np.isfinite(response[record]).all(axis=0)]
        starts = range(0, max(valid.shape[-1] - length, 0) + 1, length // 2)
        for first in starts:
            piece = valid[:, first : first + length]
            out[record] += (
                np.abs(np.fft.rfft(piece * window[: piece.shape[-1]], length, axis=-1)[:, kept])
                ** 2
            )
        out[record] *= 2.0 / (signals.rate * np.sum(window**2) * len(starts))
    return frequency[kept], out
