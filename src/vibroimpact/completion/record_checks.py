"""What is checked of records by their lines before a completion is believed: rows as the verdict
holds them.
"""

import numpy as np

from vibroimpact.campaign.checks.stated import check_row
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
                check_row(
                    "noise",
                    "warn" if value > LOUD else "pass",
                    "The record has no period: it is taken whole, without the transient at "
                    f"its ends; noise and distortion are {value:.1%} of the response in the band.",
                    level.name,
                    channel,
                )
                for channel, value in zip(names, share, strict=True)
            ]
            continue
        if level.periods < 2:
            rows.append(
                check_row(
                    "periods",
                    "warn",
                    "There is one period only: noise and transient can not be told from the"
                    " response.",
                    level.name,
                )
            )
            continue
        rows.append(
            check_row(
                "periods",
                "pass",
                f"The force repeats; {level.periods} periods are averaged.",
                level.name,
            )
        )
        share = float(
            np.sqrt(np.sum(level.force_noise[lines] ** 2) / np.sum(np.abs(level.force[lines]) ** 2))
        )
        rows.append(
            check_row(
                "force",
                "warn" if share > FORCE_NOISE else "pass",
                f"The force differs between periods by {share:.2%} of itself.",
                level.name,
            )
        )
        noise = np.sqrt(
            line_power(level.noise, level.frequency, lines)
            / line_power(level.response, level.frequency, lines)
        )
        for channel, value in zip(names, noise, strict=True):
            rows.append(
                check_row(
                    "noise",
                    "warn" if value > NOISY else "pass",
                    f"Noise is {value:.2%} of the averaged response in the band.",
                    level.name,
                    channel,
                )
            )
    return rows
