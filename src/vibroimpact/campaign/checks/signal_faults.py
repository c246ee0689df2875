"""Faults of single signals of a record: numbers that are missing, clipped tops, drop-outs, drifting
levels.
"""

from __future__ import annotations

import numpy as np

TOP_SHARES = (0.01, 0.02, 0.04)  # widths of the bins at the extreme, as shares of it
FEWEST_AT_TOP = 8  # samples in the outermost bin
PILE_UP = (
    8.0  # times as many samples as in the bin beneath: 3 for a sine, below 1 for random vibration
)
SAME_VALUE, NEIGHBOURS = (
    3,
    20,
)  # times that the extreme value is met, for each time that one of the next values is
DROP_OUT_S, DROP_OUT_SAMPLES = 0.01, 8  # a value that is held for longer than both
QUIET_S, QUIET_SHARE = (
    0.1,
    0.01,
)  # a stretch whose RMS and whose differences' RMS fall to this share of the median
LIVELY_SHARE = 0.1  # of the median RMS, just before a drop-out
TREND_SEGMENT_S, TREND_SEGMENTS, TREND_BANDS = 2.0, 8, 6
TREND_T, TREND_DB = (
    5.0,
    1.5,
)  # 3.2 is the largest |t| of the 140 signals of the development campaigns
START_UP_SHARE = 0.1  # of the record, 5 s at most, that a start from rest takes
START_UP_S = 5.0


def missing(signal):
    """Return (number of samples that are no number, index of the first) of a signal (time,), or
    None.
    """
    holes = np.flatnonzero(~np.isfinite(signal))
    return (holes.size, int(holes[0])) if holes.size else None


def clipped(signal):
    """Return the share of samples (0 to 1) at a flat top of a signal (time,) without holes, or None
    where the tops are round.

    Flat: the same extreme value three times, when the values next to it are hardly repeated; or far
    more samples within 1, 2 or 4 % of it than in the next 1, 2 or 4 %.
    """
    found = 0
    for side in (signal - np.median(signal), np.median(signal) - signal):
        top = side.max()
        if top <= 0.0:
            continue
        near = side[side > (1.0 - 2.0 * TOP_SHARES[-1]) * top]
        counts = [
            (
                np.count_nonzero(near > (1.0 - share) * top),
                np.count_nonzero(near > (1.0 - 2.0 * share) * top),
            )
            for share in TOP_SHARES
        ]
        piles = [
            inner
            for inner, both in counts
            if inner >= FEWEST_AT_TOP and inner > PILE_UP * max(both - inner, 1)
        ]
        same = _repeated_top(near, top)
        if piles or same:
            found += max([*piles, same])
    return found / signal.size if found else None


def _repeated_top(near, top):
    """Return how often the extreme value of a side (its samples near the top) is repeated, 0 where
    that may be the converter's step or the round top of a slow wave, which holds ten times as many
    samples within 1e-5 as within 1e-7.
    """
    values, counts = np.unique(near, return_counts=True)
    same = np.count_nonzero(near >= top * (1.0 - 1e-7))
    beneath = counts[values < top * (1.0 - 1e-7)][-NEIGHBOURS:]
    flat = same > 0.5 * np.count_nonzero(near >= top * (1.0 - 1e-5))
    return int(same) if flat and same >= SAME_VALUE * max(int(beneath.max(initial=0)), 1) else 0


def _longest(flags):
    """Return the length of the longest run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(np.int8), [0]])))
    return int(np.max(edges[1::2] - edges[::2], initial=0))


def dropped_out(signal, rate, starts_at_rest):
    """Return (start, duration) in s of the longest drop-out of a signal (time,) without holes, or
    None.

    A drop-out is a value that is held, or a stretch in which motion and its differences nearly
    vanish. A record from rest may begin with one.
    """
    starts, lengths = _held_runs(signal)
    counted = ~((starts == 0) & starts_at_rest)
    if counted.any():
        longest = int(np.argmax(np.where(counted, lengths, 0)))
        if lengths[longest] > max(DROP_OUT_SAMPLES, DROP_OUT_S * rate) and not _usual(
            lengths, longest
        ):
            return starts[longest] / rate, lengths[longest] / rate
    size = max(int(QUIET_S * rate), 16)
    blocks = signal[: signal.size // size * size].reshape(-1, size)
    if len(blocks) < 8:
        return None
    moving, changing = blocks.std(axis=1), np.diff(blocks, axis=1).std(axis=1)
    quiet = (moving < QUIET_SHARE * np.median(moving)) & (
        changing < QUIET_SHARE * np.median(changing)
    )
    # It sets in at once: motion that has not begun, or dies away, is none.
    lively = moving > LIVELY_SHARE * np.median(moving)
    for first in _firsts(quiet):
        if not lively[max(first - 2, 0) : first].any():
            quiet[first : first + int(np.argmin(np.append(quiet[first:], False)))] = False
    if not quiet.any():
        return None
    return int(np.argmax(quiet)) * size / rate, _longest(quiet) * size / rate


def _firsts(flags):
    """Return the indices at which runs of True begin."""
    return np.flatnonzero(np.diff(flags.astype(int), prepend=0) == 1)


def _held_runs(signal):
    """Return (starts, lengths) in samples of all runs of two and more equal values."""
    edges = np.flatnonzero(
        np.diff(np.concatenate([[0], (np.diff(signal) == 0.0).astype(np.int8), [0]]))
    )
    return edges[::2], edges[1::2] - edges[::2] + 1


def _usual(lengths, longest):
    """Whether runs of equal values are usual: the longest one then is no drop-out but the
    converter's step.
    """
    others = np.sort(np.delete(lengths, longest))
    return others.size > 10 and lengths[longest] < 5 * others[int(0.99 * others.size)]


def level_trend(signal, rate, band_Hz, starts_at_rest):
    """Return (change in dB over the record, its t statistic) of the mean band level of a signal
    (time,), or None if too short.

    The levels of 6 bands over band_Hz in segments of 2 s, averaged in dB; a straight line through
    them, its error widened for the correlation of neighbours.
    """
    begin = int(min(START_UP_SHARE * signal.size, START_UP_S * rate)) if starts_at_rest else 0
    kept = signal[begin:]
    size = int(max(TREND_SEGMENT_S, 4.0 / band_Hz[0]) * rate)
    count = (2 * kept.size) // size - 1
    if count < TREND_SEGMENTS:
        return None
    window, step = np.hanning(size), size // 2
    power = np.array(
        [
            np.abs(np.fft.rfft(window * kept[index * step : index * step + size])) ** 2
            for index in range(count)
        ]
    )
    frequency, edges = np.fft.rfftfreq(size, 1.0 / rate), np.geomspace(*band_Hz, TREND_BANDS + 1)
    inside = [
        (frequency >= low) & (frequency <= high)
        for low, high in zip(edges[:-1], edges[1:], strict=True)
    ]
    levels = np.array(
        [
            10.0 * np.log10(np.maximum(power[:, band].sum(axis=1), np.finfo(float).tiny))
            for band in inside
            if band.any()
        ]
    ).mean(axis=0)
    place = np.linspace(-0.5, 0.5, count)
    centred = levels - levels.mean()
    change = place @ centred / (place @ place)
    rest = centred - change * place
    neighbours = float(np.clip(rest[1:] @ rest[:-1] / max(rest @ rest, 1e-300), 0.0, 0.9))
    error = np.sqrt(
        rest @ rest / (count - 2) / (place @ place) * (1.0 + neighbours) / (1.0 - neighbours)
    )
    return float(change), float(change / max(error, 1e-300))


def drifting(trend):
    """Whether a level_trend is more than chance and matters."""
    return trend is not None and abs(trend[1]) > TREND_T and abs(trend[0]) > TREND_DB
