"""Checks of a linear record against a linear model: swapped or reversed channels, wrong units.

Band powers of the responses per force are compared. The bands are wide enough that a mode that is
1 % off stays in its band. Polarity is the sign of the phase, line by line; resonances disturb it on
few lines only.
"""

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from vibroimpact.campaign.signals import Transfer

from .linear_record import mean_coherence, mean_cosine
from .stated import warning

BANDS = 30
LEAST_COHERENCE = 0.3  # least mean coherence of a channel that is judged, and of a band of it
# Two channels are swapped if exchanging them reduces their misfit to below this share of it and by
# at least SWAP_DB.
SWAP_RATIO = 0.6
SWAP_DB = 1.0
OPPOSITE = -0.4  # mean cosine of the phase between measured and simulated
UNIT_FACTOR_DB = 6.0  # sensor gains are within a few per cent; a factor of two is a wrong unit
# A factor of a unit is the same in all bands: it is this many times their spread at least. What the
# model lacks changes some bands more than others, most where the model hardly moves.
OVER_SPREAD = 5.0
LIKE_MODEL_DB = 6.0  # largest misfit of a channel whose polarity is judged
UNIT_FACTORS = {
    9.80665: "g and m s-2",
    1e3: "mm and m (or kN and N)",
    1e6: "um and m",
    25.4: "inch and mm",
    39.37: "inch and m",
    3.2808: "ft and m",
    4.4482: "lbf and N",
    32.174: "g and ft s-2",
    386.09: "g and in s-2",
    9806.65: "g and mm s-2",
}
FACTOR_TOLERANCE = 0.06


def band_levels_dB(frequency: np.ndarray, h1: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return (channel, band) dB of the weighted mean of |h1|² in logarithmic bands.

    frequency (line,): Hz.
    h1, weights (channel, line).

    NaN if a band holds no line.
    """
    chosen = _bands(frequency)
    sums, total = (np.abs(h1) ** 2 * weights) @ chosen.T, weights @ chosen.T
    filled = (total > 0.0) & (sums > 0.0)
    return np.where(
        filled, 10.0 * np.log10(np.where(filled, sums, 1.0) / np.where(filled, total, 1.0)), np.nan
    )


def _bands(frequency: np.ndarray) -> np.ndarray:
    """Return (band, line) bool: the lines (line,) in Hz of each band."""
    edges = np.geomspace(frequency[0], frequency[-1] * (1.0 + 1e-9), BANDS + 1)
    place = np.clip(np.searchsorted(edges, frequency, side="right") - 1, 0, BANDS - 1)
    return place == np.arange(BANDS)[:, None]


def misfits_dB(measured: np.ndarray, simulated: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (misfit, offset), each (channel, channel) in dB, of band levels (channel, band).

    offset: median of measured channel i less simulated channel j; misfit: robust spread about it.
    """
    difference = measured[:, None, :] - simulated[None, :, :]
    offset = np.nanmedian(difference, axis=-1)
    return np.nanmedian(np.abs(difference - offset[..., None]), axis=-1) * 1.4826, offset


def compare_with_model(
    spectra: Transfer,
    simulated: np.ndarray,
    names: Sequence[str],
    kinds: Sequence[str],
    record: str | None = None,
) -> list[dict]:
    """Return rows {check, level, record, channel, message} of channels that contradict the model.

    spectra: campaign.signals.Transfer of a linear record.
    simulated (channel, line): complex response per force of the model at the same lines, points
    and directions, SI.
    names, kinds (channel,): texts.
    record: its name.
    """
    coherent = np.flatnonzero(
        (mean_coherence(spectra) > LEAST_COHERENCE) & np.any(np.abs(simulated) > 0.0, axis=-1)
    )
    if coherent.size == 0:
        return []
    channels = coherent.tolist()
    weights = np.maximum(spectra.coherence, 1e-3)[coherent]
    h1, model = spectra.h1[coherent], simulated[coherent]
    misfit, offset = misfits_dB(
        np.where(_seen(spectra)[coherent], band_levels_dB(spectra.frequency, h1, weights), np.nan),
        band_levels_dB(spectra.frequency, model, weights),
    )
    rows: list[dict] = []
    exchanged: dict[int, int] = {}
    for first, second in _swaps(misfit, [kinds[channel] for channel in channels]):
        pair = names[channels[first]], names[channels[second]]
        exchanged |= {first: second, second: first}
        rows += _swap_rows(pair, record, misfit[first, second], misfit[first, first])
    for index, channel in enumerate(channels):
        place = exchanged.get(index, index)
        spread = misfit[index, place]
        opposite = mean_cosine(h1[index], model[place], weights[index]) < OPPOSITE
        if opposite and spread < LIKE_MODEL_DB:
            rows.append(
                warning(
                    "swapped channels",
                    f"{names[channel]} moves against the model in record {record}: its polarity "
                    "or its channel_direction is reversed.",
                    record,
                    names[channel],
                )
            )
        gain = float(offset[index, place])
        if abs(gain) > max(UNIT_FACTOR_DB, OVER_SPREAD * spread):
            rows.append(
                warning(
                    "units",
                    f"{names[channel]} is {10 ** (gain / 20):.3g} times the model in record "
                    f"{record}{_unit_hint(gain)}: check its unit.",
                    record,
                    names[channel],
                )
            )
    return _merge_gains(rows)


def _seen(spectra):
    """Return (channel, band) bool: which bands show more than noise."""
    chosen = _bands(spectra.frequency)
    return spectra.coherence @ chosen.T / np.maximum(chosen.sum(axis=1), 1) >= LEAST_COHERENCE


def _swap_rows(pair, record, after_dB, before_dB):
    """Return the rows of two channels that fit better when exchanged."""
    return [
        warning(
            "swapped channels",
            f"{this} moves as the model does at {that}, and {that} as it does at {this}, in"
            f" record {record}: the two seem swapped (misfit {after_dB:.1f} instead of"
            f" {before_dB:.1f} dB).",
            record,
            this,
        )
        for this, that in (pair, pair[::-1])
    ]


def _merge_gains(rows: list[dict]) -> list[dict]:
    """Return the rows with "units" renamed "gains" if several channels are off.

    Then the common cause is not the unit of a channel, and none is to be left out for it.
    """
    if sum(row["check"] == "units" for row in rows) < 2:
        return rows
    why = (
        " Several channels are off: the structure is another than the model at this level, or the"
        " force has another unit."
    )
    for row in rows:
        if row["check"] == "units":
            row |= {"check": "gains", "message": row["message"].split(": check")[0] + "." + why}
    return rows


def _swaps(misfit: np.ndarray, kinds: list[str]) -> Iterator[tuple[int, int]]:
    """Yield pairs (first, second) that fit better when exchanged, best first, each channel once."""
    gains = []
    for first, second in combinations(range(len(kinds)), 2):
        now = misfit[first, first] + misfit[second, second]
        then = misfit[first, second] + misfit[second, first]
        if kinds[first] == kinds[second] and then < SWAP_RATIO * now and now - then > SWAP_DB:
            gains.append((now - then, first, second))
    taken: set[int] = set()
    for _, first, second in sorted(gains, reverse=True):
        if not {first, second} & taken:
            taken |= {first, second}
            yield first, second


def _unit_hint(gain_dB: float) -> str:
    """Return ", as between g and m s-2" if a gain is near the ratio of two units, else ""."""
    factor = 10.0 ** (abs(gain_dB) / 20.0)
    for known, text in UNIT_FACTORS.items():
        if abs(np.log(factor / known)) < FACTOR_TOLERANCE:
            return f", as between {text}"
    return ""
