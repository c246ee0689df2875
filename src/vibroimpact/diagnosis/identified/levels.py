"""A campaign's records by their lines, in ascending load, and which of them name a law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.campaign.signals import campaign_signals
from vibroimpact.reduction.modal_structure import IdentifiedModes
from vibroimpact.spectra.periodic_lines import LevelLines, level_lines, line_power

from .long_records import long_record_lines

SAME_LOAD = 1.05  # records within this factor repeat one level
FEWEST_FITTED = 3  # fewer fitted levels leave none to try a name on
# Share of the response that noise may have without a warning: of the mean over periods, and of a
# record without period, where distortion counts as noise.
NOISY, LOUD = 0.05, 0.5


def levels_of(
    campaign: xr.Dataset,
    modes: Mapping[str, IdentifiedModes] | None = None,
    band_Hz: tuple[float, float] = (0.0, np.inf),
) -> tuple[LevelLines, ...]:
    """Return the LevelLines of a campaign in ascending load, in SI or, where a channel is generic,
    its own units.

    modes {record: modes}, band_Hz: for the transient of records without period, see long_records.
    Records have no period where the attribute whole_records says so. Raises PeriodError for any
    other record without one.
    """
    signals, out = campaign_signals(campaign).require_units(), []
    whole = int(campaign.attrs.get("whole_records", 0))
    for record, name in enumerate(signals.records):
        split, force = signals.splits[record], signals.force[record][0]
        response, rate = signals.response[record], signals.rate
        if whole:
            own = None if modes is None else modes[name]
            out.append(long_record_lines(name, split, force, response, rate, own, band_Hz))
        else:
            period, drop = signals.stated_period, signals.transient_periods
            out.append(level_lines(name, split, force, response, rate, period, drop))
    return tuple(sorted(out, key=lambda level: level.load_rms))


def naming_split(
    levels: Sequence[LevelLines],
) -> tuple[tuple[LevelLines, ...], tuple[LevelLines, ...]]:
    """Return (fitted, tried): the levels that candidates are fitted to, and those that their names
    are tried on.

    The fitted level below the highest one, with all records of its load, is set aside for the name
    and is fitted once the name stands: held-out levels choose nothing. Where only two levels are
    fitted, the held-out ones are tried. Raises ValueError where there are too few.
    """
    fitted = tuple(level for level in levels if level.split == "fit")
    held = tuple(level for level in levels if level.split != "fit")
    loads: list[float] = []
    for level in fitted:
        if not loads or level.load_rms > SAME_LOAD * loads[-1]:
            loads.append(level.load_rms)
    if len(fitted) < 2:
        raise ValueError(
            f"{len(fitted)} levels are to be fitted: two are the least, of different load"
        )
    if len(loads) < FEWEST_FITTED and not held:
        raise ValueError(
            "two levels to fit and none held out: a name could only be tried on what it was fitted"
            " to; record a third level"
        )
    if len(loads) < FEWEST_FITTED:
        return fitted, held
    tried = tuple(level for level in fitted if loads[-2] <= level.load_rms < loads[-1])
    return tuple(level for level in fitted if level not in tried), tried


def noise_share(level: LevelLines, band_Hz: Sequence[float]) -> np.ndarray:
    """Return (channel,) noise over response in a band, both RMS; NaN for a single period."""
    lines = level.excited(band_Hz)
    return np.sqrt(
        line_power(level.noise, level.frequency, lines)
        / line_power(level.response, level.frequency, lines)
    )


def noise_rows(level: LevelLines, band_Hz: Sequence[float]) -> list[dict[str, Any]]:
    """Return the row of checks that says how noisy a record is, by its noisiest channel."""
    share = float(np.max(noise_share(level, band_Hz)))
    if not np.isfinite(share):
        text = "There is one period only: noise and transient can not be told from the response."
        return [check_row("periods", "warn", text, level.name)]
    if level.periods:
        text = f"{level.periods} periods are averaged; noise is {share:.2%} of the response."
    else:
        text = (
            "The record has no period: it is taken whole, without the transient at its ends; noise"
            f" and distortion are {share:.1%} of the response."
        )
    noisy = share > (NOISY if level.periods else LOUD)
    return [check_row("noise", "warn" if noisy else "pass", text, level.name)]
