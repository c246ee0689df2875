"""The discrepancy map: measured over simulated band powers per record, channel and band, their z
scores, and clusters of bands.
"""

from typing import Any

import numpy as np
import xarray as xr
from scipy import stats

from vibroimpact.campaign.force_kinds import base_channels, load_unit
from vibroimpact.linear_stage import priors
from vibroimpact.linear_stage.counted_cells import counted
from vibroimpact.linear_stage.driven_channels import driven_channels
from vibroimpact.linear_stage.workbench import Workbench
from vibroimpact.observation.features import BLEND, FeatureLayout, compressed
from vibroimpact.units import SI_OF_KIND

from .covariance import feature_sd, free_directions
from .null_like import NullLike

SMOOTH = (0.25, 0.5, 0.25)  # weights of neighbouring bands in a variance from few seeds
SPECTRUM_HZ = 0.4  # resolution of the spectra shown
SHOWN_SEEDS = 4
FREEDOM = 15  # degrees of freedom of the t law of z: a variance has about 16 runs
PEAK = 0.5  # share of the largest difference in dB from which neighbouring bands join its cluster

Compared = tuple[np.ndarray, np.ndarray, np.ndarray]  # (D, z, sd) of z_of


def z_of(
    bench: Workbench, null: NullLike, seeds: np.ndarray, model: np.ndarray | None = None
) -> Compared:
    """Return (D, z, sd), each (record, channel, band): measured less simulated band powers in dB,
    in standard deviations, and the standard deviations in dB.

    seeds (record, seed, feature): of the simulation. null, model: see standard_deviation. The
    covariance is that of the verdict. As there, differences beyond features.BLEND are compressed in
    z.
    """
    layout = bench.layout
    difference = layout.power(bench.measured_features) - layout.power(seeds).mean(axis=1)
    sd = layout.power(standard_deviation(bench, null, seeds, model))
    drawn_in = BLEND["power"] * np.arcsinh(difference / BLEND["power"])
    return difference, drawn_in / sd, sd


def standard_deviation(
    bench: Workbench, null: NullLike, seeds: np.ndarray, model: np.ndarray | None = None
) -> np.ndarray:
    """Return (record, feature): one sigma of a measured record about the mean of a model.

    seeds (record, seed, feature): of the model. null: Null of the model without an effect. model
    (record, feature): mean of the model with an effect, whose law adds an uncertainty in proportion
    to the change of the features; None without. Records outside null.records have the variance of
    their seeds and that of two codes.
    """
    layout, common = bench.layout, free_directions(bench.layout, driven_channels(bench))
    variance = smoothed(seeds.var(axis=1, ddof=1), layout) * (1.0 + 1.0 / seeds.shape[1])
    variance += feature_sd(layout) ** 2 + np.sum(common**2, axis=0)
    variance[null.records] = np.diagonal(null.covariance, axis1=1, axis2=2)
    if model is not None:
        change = compressed(model[null.records] - null.mean, layout)
        variance[null.records] += (priors.LAW_SD**2 + priors.LAW_COMMON_SD**2) * change**2
    return np.sqrt(variance)


def smoothed(variance: np.ndarray, layout: FeatureLayout) -> np.ndarray:
    """Return variances (record, feature), those of band powers averaged over neighbouring bands
    with the weights SMOOTH.
    """
    out = variance.copy()
    out[:, layout.kind == "power"] = np.apply_along_axis(
        lambda row: np.convolve(np.pad(row, 1, mode="edge"), SMOOTH, mode="valid"),
        -1,
        layout.power(variance),
    ).reshape(len(variance), -1)
    return out


def significant(z: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Return (record, channel, band) bool: the significant cells among the chosen ones.

    The false-discovery rate is priors.SIGNIFICANT, the error rate of the verdict (Y. Benjamini, Y.
    Hochberg, J. R. Stat. Soc. B 57, 1995).
    """
    p = 2.0 * stats.t.sf(np.abs(z), FREEDOM)
    inside = np.sort(p[chosen])
    passed = np.flatnonzero(
        inside <= priors.SIGNIFICANT * (1 + np.arange(inside.size)) / max(inside.size, 1)
    )
    return chosen & (p <= inside[passed[-1]]) if passed.size else np.zeros_like(chosen)


def regions(
    bench: Workbench, difference: np.ndarray, z: np.ndarray, chosen: np.ndarray
) -> list[dict[str, Any]]:
    """Return the rows of `regions` of verdict.json: clusters of significant bands, the largest |z|
    first.

    difference, z, chosen: (record, channel, band), as of z_of and significant.
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


def clusters(difference: np.ndarray, marked: np.ndarray) -> list[np.ndarray]:
    """Return [(band,)]: indices of neighbouring marked bands of one sign, the largest first.

    difference, marked: (band,). A cluster extends to PEAK of its largest difference.
    """
    remaining, out = marked.copy(), []
    while remaining.any():
        top = int(np.argmax(np.where(remaining, np.abs(difference), 0.0)))
        inside = remaining & (
            difference * np.sign(difference[top]) >= PEAK * np.abs(difference[top])
        )
        low, high = top, top
        while low > 0 and inside[low - 1]:
            low -= 1
        while high + 1 < len(remaining) and inside[high + 1]:
            high += 1
        out.append(np.arange(low, high + 1))
        remaining[low : high + 1] = False
    return out


def nearest(bench: Workbench, low: float, high: float) -> list[float]:
    """Return the frequencies in Hz of the modes in a band, or of the one nearest to its middle."""
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
    """Return the attributes of a variable. Decibels are a comment: UDUNITS does not have them."""
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


def map_dataset(
    bench: Workbench, compared: Compared, seeds: np.ndarray, responses: np.ndarray
) -> xr.Dataset:
    """Return the map as a Dataset.

    compared: as z_of returns it. seeds (record, seed, feature). responses (record, shown seed,
    channel, sample): of the same model, with noise.
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
    # an acceleration of the base has no place
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
