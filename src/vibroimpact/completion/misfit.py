"""Where a model and periodic records disagree: band by band in dB, and which part of the error lies
where.
"""

import numpy as np

BANDS = 24
DB_PER_RELATIVE = 10.0 / np.log(10.0)
CALIBRATION_DB = 0.1  # what gains and the records' own repeatability leave uncertain in a band
STRONG_Z, STRONG_DB = 3.0, 1.0
SHARE = 0.8  # of the squared error of a record that its region holds


def band_edges(band_Hz, bands=BANDS):
    """Return (band + 1,) Hz, evenly spaced in logarithm; a band that begins at 0 begins at a
    hundredth of its end.
    """
    return np.geomspace(max(band_Hz[0], 0.01 * band_Hz[1]), band_Hz[1], bands + 1)


def disagreement(records, predicted):
    """Return (D, floor): (level, channel, band) 10 log10 of measured over predicted band power in
    dB, and its standard deviation by noise.

    records: trial.Records; predicted: their lines, as Records.predict gives them. NaN where a band
    holds no line.
    """
    edges = band_edges(records.band_Hz)
    shape = (len(records.levels), len(records.levels[0].response), BANDS)
    difference, floor = np.full(shape, np.nan), np.full(shape, np.nan)
    for index, (level, lines) in enumerate(zip(records.levels, predicted, strict=True)):
        kept = np.flatnonzero(records.kept(level))
        kept_lines = level.frequency[kept] > 0.0
        band = np.digitize(level.frequency[kept], edges[1:-1])
        measured, noise = level.response[:, kept], np.nan_to_num(level.noise[:, kept])
        for number in range(BANDS):
            inside = (band == number) & kept_lines
            if inside.any():
                power = np.sum(np.abs(measured[:, inside]) ** 2, axis=1)
                difference[index, :, number] = 10.0 * np.log10(
                    power / np.sum(np.abs(lines[:, inside]) ** 2, axis=1)
                )
                spread = np.sqrt(
                    2.0 * np.sum(np.abs(measured[:, inside]) ** 2 * noise[:, inside] ** 2, axis=1)
                )
                floor[index, :, number] = DB_PER_RELATIVE * spread / power
    return difference, floor


def log_spectral_distance(difference):
    """Return the RMS of D in dB over all bands, channels and levels that are there."""
    return float(np.sqrt(np.nanmean(difference**2)))


def misfit_summary(before, after, floor):
    """Return {before_dB, after_dB, floor_dB, closed_fraction} from disagreements (level, channel,
    band); see shared contract.

    closed_fraction is None where the excess before is below half the floor.
    """
    low = float(np.sqrt(np.nanmean(floor**2)))
    first, last = log_spectral_distance(before), log_spectral_distance(after)
    excess = [np.sqrt(max(0.0, value**2 - low**2)) for value in (first, last)]
    closed = (
        None if excess[0] < 0.5 * low or excess[0] == 0.0 else float(1.0 - excess[1] / excess[0])
    )
    return {"before_dB": first, "after_dB": last, "floor_dB": low, "closed_fraction": closed}


def regions(records, predicted, names):
    """Return a list of regions of disagreement, the largest share of error first, as the verdict
    holds them.

    Each record and channel gives the narrowest stretch of lines that holds most of its squared
    error; D and z are those of the stretch.
    """
    found = []
    for level, lines in zip(records.levels, predicted, strict=True):
        kept = np.flatnonzero(records.kept(level))
        kept, lines = kept[level.frequency[kept] > 0.0], lines[:, level.frequency[kept] > 0.0]
        for channel, name in enumerate(names):
            missed = np.abs(lines[channel] - level.response[channel, kept]) ** 2
            first, last = _narrowest(missed, SHARE)
            part = slice(first, last + 1)
            power = np.sum(np.abs(level.response[channel, kept][part]) ** 2)
            noise = np.nan_to_num(level.noise[channel, kept][part])
            depth = 10.0 * np.log10(power / np.sum(np.abs(lines[channel, part]) ** 2))
            spread = (
                DB_PER_RELATIVE
                * np.sqrt(2.0 * np.sum(np.abs(level.response[channel, kept][part]) ** 2 * noise**2))
                / power
            )
            z = depth / np.hypot(spread, CALIBRATION_DB)
            if abs(z) >= STRONG_Z and abs(depth) >= STRONG_DB:
                relative = float(
                    np.sqrt(np.sum(missed) / np.sum(np.abs(level.response[channel, kept]) ** 2))
                )
                found.append(
                    {
                        "band_Hz": [
                            float(level.frequency[kept[first]]),
                            float(level.frequency[kept[last]]),
                        ],
                        "load_rms_N": level.load_rms,
                        "gap_m": None,
                        "channel": name,
                        "discrepancy_dB": float(depth),
                        "z": float(z),
                        "relative_error": relative,
                    }
                )
    return sorted(found, key=lambda region: -region["relative_error"])


def _narrowest(values, share):
    """(first, last) index of the shortest stretch of values (line,) that holds a share of their
    sum.
    """
    total = np.concatenate([[0.0], np.cumsum(values)])
    wanted, best = share * total[-1], (0, values.size - 1)
    for first in range(values.size):
        last = int(np.searchsorted(total, total[first] + wanted)) - 1
        if last < values.size and last - first < best[1] - best[0]:
            best = (first, max(last, first))
    return best
