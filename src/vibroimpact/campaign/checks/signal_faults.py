"""Faults of a single signal: missing samples, clipping, drop-outs, drifting levels."""

from itertools import pairwise

import numpy as np

TOP_SHARES = (0.01, 0.02, 0.04)  # widths of the bins at the extreme, as shares of it
FEWEST_AT_TOP = 8  # samples in the outermost bin
FEWEST_CRESTS = 5  # that hold them: samples of one crest are not independent
# Samples in the outermost bin over those in the next one: 3 for a sine, below 1 for random
# vibration, more than this for a clipped signal.
PILE_UP = 8.0
# The extreme value occurs SAME_VALUE times as often as any of its NEIGHBOURS next values.
SAME_VALUE, NEIGHBOURS = 3, 20
# A side of a signal that is smaller than this share of the other is not the range of an amplifier:
# without contact a contact force is noise of a few steps of the converter.
ONE_SIDED = 0.1
DROP_OUT_S, DROP_OUT_SAMPLES = 0.01, 8  # a constant value for longer than both is a drop-out
# So is a stretch of QUIET_S in which the RMS of the signal and of its differences falls to
# QUIET_SHARE of the median.
QUIET_S, QUIET_SHARE = 0.1, 0.01
LIVELY_SHARE = 0.1  # least RMS just before a drop-out, over the median RMS
TREND_SEGMENT_S, TREND_SEGMENTS, TREND_BANDS = 2.0, 8, 6
TREND_T, TREND_DB = 5.0, 1.5  # least |t| and change; |t| of 140 stationary signals is below 3.2
START_UP_SHARE, START_UP_S = 0.1, 5.0  # start from rest: share of the record, at most so many s


def clipped_share(signal: np.ndarray) -> float | None:
    """Return the share of samples (0 to 1) at a flat top of a signal (time,), or None.

    A top is flat if the extreme value occurs three times although the values next to it are
    hardly repeated, or if far more samples lie within 1, 2 or 4 % of the extreme than in the
    next 1, 2 or 4 %. The signal has no missing samples.
    """
    flat, sides = 0, (signal - np.median(signal), np.median(signal) - signal)
    largest = max(float(side.max()) for side in sides)
    for side in sides:
        top = float(side.max())
        if top <= ONE_SIDED * largest:
            continue
        near = side[side > (1.0 - 2.0 * TOP_SHARES[-1]) * top]
        if np.all(near == top):  # the converter has no finer step: noise of a silent channel
            continue
        most = _repeated_top(near, top)
        for share in TOP_SHARES:
            inner = int(np.count_nonzero(near > (1.0 - share) * top))
            both = int(np.count_nonzero(near > (1.0 - 2.0 * share) * top))
            piled = inner >= FEWEST_AT_TOP and inner > PILE_UP * max(both - inner, 1)
            if piled and _runs(side > (1.0 - share) * top)[0].size >= FEWEST_CRESTS:
                most = max(most, inner)
        flat += most
    return flat / signal.size if flat else None


def _repeated_top(near: np.ndarray, top: float) -> int:
    """Return how often the extreme value of one side of a signal is repeated; 0 without clipping.

    near: samples near the top.
    top: the extreme value.

    Repetition may also be due to the resolution of the converter, or to the round top of a slow
    wave, which holds ten times as many samples within 1e-5 of the extreme as within 1e-7.
    """
    values, counts = np.unique(near, return_counts=True)
    same = np.count_nonzero(near >= top * (1.0 - 1e-7))
    beneath = counts[values < top * (1.0 - 1e-7)][-NEIGHBOURS:]
    flat = same > 0.5 * np.count_nonzero(near >= top * (1.0 - 1e-5))
    return int(same) if flat and same >= SAME_VALUE * max(int(beneath.max(initial=0)), 1) else 0


def _runs(flags: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (starts, lengths) of the runs of True."""
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0))
    return edges[::2], edges[1::2] - edges[::2]


def drop_out(signal: np.ndarray, rate: float, starts_at_rest: bool) -> tuple[float, float] | None:
    """Return (start, duration) in s of the longest drop-out of a signal (time,), or None.

    rate: Hz.
    starts_at_rest: the record may begin with a constant value.

    A drop-out is a stretch of one constant value, or one in which the motion and its differences
    nearly vanish. The signal has no missing samples.
    """
    starts, lengths = _runs(np.diff(signal) == 0.0)
    lengths = lengths + 1  # values, not steps between them
    counted = ~((starts == 0) & starts_at_rest)
    if counted.any():
        longest = int(np.argmax(np.where(counted, lengths, 0)))
        others = np.sort(np.delete(lengths, longest))
        # equal values are usual if the resolution of the converter is coarse
        usual = others.size > 10 and lengths[longest] < 5 * others[int(0.99 * others.size)]
        if lengths[longest] > max(DROP_OUT_SAMPLES, DROP_OUT_S * rate) and not usual:
            return starts[longest] / rate, lengths[longest] / rate
    size = max(int(QUIET_S * rate), 16)
    blocks = signal[: signal.size // size * size].reshape(-1, size)
    if len(blocks) < 8:
        return None
    moving, changing = blocks.std(axis=1), np.diff(blocks, axis=1).std(axis=1)
    quiet = np.all([each < QUIET_SHARE * np.median(each) for each in (moving, changing)], axis=0)
    # A drop-out begins abruptly: motion that has not begun, or that decays, is not one.
    lively = moving > LIVELY_SHARE * np.median(moving)
    abrupt = [
        (first, length)
        for first, length in zip(*_runs(quiet), strict=True)
        if lively[max(first - 2, 0) : first].any()
    ]
    if not abrupt:
        return None
    return abrupt[0][0] * size / rate, max(length for _, length in abrupt) * size / rate


def level_trend(
    signal: np.ndarray, rate: float, band_Hz: tuple[float, float], starts_at_rest: bool
) -> tuple[float, float] | None:
    """Return (change in dB over the record, its t statistic) of the level of a signal, or None.

    signal (time,).
    rate: Hz.
    band_Hz: lowest and highest frequency; the lowest is raised if a segment of four of its
    periods is too long for the record.
    starts_at_rest: the start-up is left out.

    The level is the mean in dB over 6 bands within band_Hz, in segments of 2 s. A straight line is
    fitted; its standard error allows for the correlation of neighbouring segments. None if the
    record is too short.
    """
    begin = int(min(START_UP_SHARE * signal.size, START_UP_S * rate)) if starts_at_rest else 0
    kept = signal[begin:]
    low_Hz = max(band_Hz[0], 4.0 * 0.5 * (TREND_SEGMENTS + 1) * rate / max(kept.size, 1))
    size = int(max(TREND_SEGMENT_S, 4.0 / low_Hz) * rate)
    count = (2 * kept.size) // size - 1
    if count < TREND_SEGMENTS or low_Hz >= band_Hz[1]:
        return None
    window, step = np.hanning(size), size // 2
    power = np.array(
        [
            np.abs(np.fft.rfft(window * kept[index * step : index * step + size])) ** 2
            for index in range(count)
        ]
    )
    frequency = np.fft.rfftfreq(size, 1.0 / rate)
    edges = np.geomspace(low_Hz, band_Hz[1], TREND_BANDS + 1)
    bands = ((frequency >= low) & (frequency <= high) for low, high in pairwise(edges))
    sums = np.array([power[:, band].sum(axis=1) for band in bands if band.any()])
    levels = np.mean(10.0 * np.log10(np.maximum(sums, np.finfo(float).tiny)), axis=0)
    place = np.linspace(-0.5, 0.5, count)
    centred = levels - levels.mean()
    change = place @ centred / (place @ place)
    rest = centred - change * place
    neighbours = float(np.clip(rest[1:] @ rest[:-1] / max(rest @ rest, 1e-300), 0.0, 0.9))
    error = np.sqrt(
        rest @ rest / (count - 2) / (place @ place) * (1.0 + neighbours) / (1.0 - neighbours)
    )
    return float(change), float(change / max(error, 1e-300))
