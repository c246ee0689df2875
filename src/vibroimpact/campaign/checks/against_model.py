"""Checks of a linear record against a linear model: channels that fit another place better,
reversed ones, and factors that look like units.

Band powers of the responses per force are compared, in bands wide enough that modes 1 % off stay in
theirs; signs are those of the phases, line by line, which resonances disturb on few lines.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from .linear_record import mean_coherence

BANDS = 30
HEARD = 0.3  # least mean coherence of a channel that is judged
# a pair is swapped where exchanging them takes the misfit below this share of it and by this much
SWAP_RATIO = 0.6
SWAP_DB = 1.0
OPPOSITE = -0.4  # mean cosine of the phase between measured and simulated
UNIT_FACTOR_DB = 6.0  # gains are within a few per cent; a factor of two and more is a unit
KNOWN_FACTORS = {
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
NEAR_FACTOR = 0.06


def band_levels_dB(frequency, h1, weights):
    """Return (channel, band) dB of the weighted mean of |h1|² in logarithmic bands; NaN where a
    band holds no line.
    """
    edges = np.geomspace(frequency[0], frequency[-1] * (1.0 + 1e-9), BANDS + 1)
    place = np.clip(np.searchsorted(edges, frequency, side="right") - 1, 0, BANDS - 1)
    power = np.abs(h1) ** 2 * weights
    sums = np.array([[np.sum(values[place == band]) for band in range(BANDS)] for values in power])
    total = np.array(
        [[np.sum(values[place == band]) for band in range(BANDS)] for values in weights]
    )
    filled = (total > 0.0) & (sums > 0.0)
    return np.where(
        filled, 10.0 * np.log10(np.where(filled, sums, 1.0) / np.where(filled, total, 1.0)), np.nan
    )


def misfits_dB(measured, simulated):
    """Return (misfit (channel, channel), offset (channel, channel)) in dB between band levels
    (channel, band): the robust spread of measured i less simulated j, and its median.
    """
    difference = measured[:, None, :] - simulated[None, :, :]
    offset = np.nanmedian(difference, axis=-1)
    return np.nanmedian(np.abs(difference - offset[..., None]), axis=-1) * 1.4826, offset


def compare_with_model(spectra, simulated, names, kinds, record=None):
    """Return rows {check, level, record, channel, message} of channels that the linear model
    contradicts; none where all fit.

    spectra: campaign_signals.Transfer of a linear record; simulated (channel, line): the model's
    response per force at the same lines, places and directions, complex, SI; names, kinds: of the
    channels; record: its name.
    """
    heard = np.flatnonzero(
        (mean_coherence(spectra) > HEARD) & np.any(np.abs(simulated) > 0.0, axis=-1)
    )
    if heard.size == 0:
        return []
    weights = np.maximum(spectra.coherence, 1e-3)[heard]
    h1, model = spectra.h1[heard], simulated[heard]
    misfit, offset = misfits_dB(
        band_levels_dB(spectra.frequency, h1, weights),
        band_levels_dB(spectra.frequency, model, weights),
    )
    rows, moved = [], {}
    for first, second in _swaps(misfit, [kinds[index] for index in heard]):
        one, other = names[heard[first]], names[heard[second]]
        moved |= {first: second, second: first}
        rows += [
            _row(
                "swapped channels",
                record,
                this,
                f"{this} moves as the model does at {that}, and {that} as it does at {this}, in"
                f" record {record}: the two seem swapped (misfit {misfit[first, second]:.1f}"
                f" instead of {misfit[first, first]:.1f} dB).",
            )
            for this, that in ((one, other), (other, one))
        ]
    for index, channel in enumerate(heard):
        place = moved.get(index, index)
        cosine = np.real(h1[index] * model[place].conj()) / np.maximum(
            np.abs(h1[index] * model[place]), np.finfo(float).tiny
        )
        if np.average(cosine, weights=weights[index]) < OPPOSITE:
            rows.append(
                _row(
                    "swapped channels",
                    record,
                    names[channel],
                    f"{names[channel]} moves against the model in record {record}: its polarity "
                    "or its channel_direction is reversed.",
                )
            )
        gain = float(offset[index, place])
        if abs(gain) > UNIT_FACTOR_DB:
            rows.append(
                _row(
                    "units",
                    record,
                    names[channel],
                    f"{names[channel]} is {10 ** (gain / 20):.3g} times the model in record "
                    f"{record}{_known(gain)}: check its unit.",
                )
            )
    return _together(rows)


def _together(rows):
    """Return the rows with those of units as rows of "gains" where several channels are off: then
    no channel is to be left out for it.
    """
    if sum(row["check"] == "units" for row in rows) < 2:
        return rows
    why = (
        " Several channels are off: the structure is another than the model at this level, or the"
        " force has another unit."
    )
    return [
        (
            row | {"check": "gains", "message": row["message"].split(": check")[0] + "." + why}
            if row["check"] == "units"
            else row
        )
        for row in rows
    ]


def _swaps(misfit, kinds):
    """Yield pairs (first, second) that fit better when exchanged, the best first, each channel
    once.
    """
    gains = []
    for first, second in combinations(range(len(kinds)), 2):
        now = misfit[first, first] + misfit[second, second]
        then = misfit[first, second] + misfit[second, first]
        if kinds[first] == kinds[second] and then < SWAP_RATIO * now and now - then > SWAP_DB:
            gains.append((now - then, first, second))
    taken = set()
    for _, first, second in sorted(gains, reverse=True):
        if not {first, second} & taken:
            taken |= {first, second}
            yield first, second


def _known(gain_dB):
    """Return ", as between g and m s-2" where a gain is near the factor of two units, else
    nothing.
    """
    factor = 10.0 ** (abs(gain_dB) / 20.0)
    near = [
        text for known, text in KNOWN_FACTORS.items() if abs(np.log(factor / known)) < NEAR_FACTOR
    ]
    return f", as between {near[0]}" if near else ""


def _row(check, record, channel, message):
    return {
        "check": check,
        "level": "warn",
        "record": record,
        "channel": channel,
        "message": message,
    }
