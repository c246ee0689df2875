"""What is checked of records by their lines before a completion is believed: rows as the verdict
holds them.
"""

import numpy as np

from vibroimpact.spectra.periodic_lines import line_power

NOISY = 0.05  # of the response: noise above it is worth a warning
FORCE_NOISE = 0.01
LOUD = (
    0.5  # of the response of a record without period, where a law that is no line adds to the noise
)


def check_periods(levels, names, band_Hz):
    """Return rows {check, level: pass | warn | refuse, record, channel, message} for LevelLines."""
    rows = []
    for level in levels:
        lines = level.excited(band_Hz)
        if level.periods == 0:
            share = np.sqrt(
                line_power(level.noise, level.frequency, lines)
                / line_power(level.response, level.frequency, lines)
            )
            rows += [
                _row(
                    "noise",
                    "warn" if value > LOUD else "pass",
                    level.name,
                    channel,
                    "The record has no period: it is taken whole, without the transient at "
                    f"its ends; noise and distortion are {value:.1%} of the response in the band.",
                )
                for channel, value in zip(names, share, strict=True)
            ]
            continue
        if level.periods < 2:
            rows.append(
                _row(
                    "periods",
                    "warn",
                    level.name,
                    None,
                    "There is one period only: noise and transient can not be told from the"
                    " response.",
                )
            )
            continue
        rows.append(
            _row(
                "periods",
                "pass",
                level.name,
                None,
                f"The force repeats; {level.periods} periods are averaged.",
            )
        )
        share = float(
            np.sqrt(np.sum(level.force_noise[lines] ** 2) / np.sum(np.abs(level.force[lines]) ** 2))
        )
        rows.append(
            _row(
                "force",
                "warn" if share > FORCE_NOISE else "pass",
                level.name,
                None,
                f"The force differs between periods by {share:.2%} of itself.",
            )
        )
        noise = np.sqrt(
            line_power(level.noise, level.frequency, lines)
            / line_power(level.response, level.frequency, lines)
        )
        for channel, value in zip(names, noise, strict=True):
            rows.append(
                _row(
                    "noise",
                    "warn" if value > NOISY else "pass",
                    level.name,
                    channel,
                    f"Noise is {value:.2%} of the averaged response in the band.",
                )
            )
    return rows


def _row(check, level, record, channel, message):
    return {
        "check": check,
        "level": level,
        "record": record,
        "channel": channel,
        "message": message,
    }
