"""A campaign's records by their lines, in ascending load, and the levels that choose the laws.

Records without period: at the lines of a record of finite length Y = G F + T + noise, with F and Y
the transforms of force and response, G the response per force and T the transient by the motion at
the start and the end of the record, as smooth a function of frequency as G. Both are fitted as
polynomials over a few lines on either side and T is subtracted: Y - T is the response to the force
repeated for ever, and the record is one period of it. Once modes are known T is fitted again as
their free decay over the whole band: at a sharp resonance a few lines do not determine it. Source:
Pintelon, Schoukens, System Identification, 2nd ed. 2012, section 7.2 (local polynomial method).
Departure: the transient of a nonlinear response depends on the force as well; it stays as
distortion, the smaller the longer the record is.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.campaign.signals import campaign_signals
from vibroimpact.identify.spectra.periodic_lines import LevelLines, level_lines, line_power
from vibroimpact.reduction.modal_structure import IdentifiedModes

SAME_LOAD = 1.05  # records within this factor repeat one level
FEWEST_FITTED = 3  # with fewer fitted levels none is left to choose a law on
# Share of the response that noise may have without a warning: of the mean over periods; of a record
# without period, with distortion as noise.
NOISY, LOUD = 0.05, 0.5
HALF_WIDTH, ORDER = 4, 2  # lines on either side; degree of both polynomials
END_TERMS = 3  # of the polynomial in s by the ends of a record, added to the free decay
FEWEST_SAMPLES = 8 * (2 * HALF_WIDTH + 1)  # of a record without period


def levels_of(
    campaign: xr.Dataset,
    modes: Mapping[str, IdentifiedModes] | None = None,
    band_Hz: tuple[float, float] = (0.0, np.inf),
) -> list[LevelLines]:
    """Return the LevelLines of a campaign in ascending load, in SI or a generic channel's units.

    modes {record: modes}, band_Hz: for the transient of records without period, see
    long_record_lines; records have none if the attribute whole_records is set. Raises PeriodError
    for any other record without one.
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
    return sorted(out, key=lambda level: level.load_rms)


def naming_split(
    levels: Sequence[LevelLines],
) -> tuple[tuple[LevelLines, ...], tuple[LevelLines, ...]]:
    """Return (fitted, tried): the levels that candidates are fitted to, and those that choose
    between them.

    The fitted level below the highest one, with all records of its load, is set aside for the
    choice of laws and is fitted after it: held-out levels choose nothing. If only two levels are
    fitted, the held-out ones choose. Raises ValueError if there are too few.
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
    if len(loads) >= FEWEST_FITTED:
        tried = tuple(level for level in fitted if loads[-2] <= level.load_rms < loads[-1])
        return tuple(level for level in fitted if level not in tried), tried
    if not held:
        raise ValueError(
            "two levels to fit and none held out: a name could only be tried on what it was fitted"
            " to; record a third level"
        )
    return fitted, held


def noise_share(level: LevelLines, band_Hz: Sequence[float]) -> np.ndarray:
    """Return (channel,) noise over response in a band, both RMS; NaN for a single period."""
    noise, response = (
        line_power(lines, level.frequency, level.excited(band_Hz))
        for lines in (level.noise, level.response)
    )
    return np.sqrt(noise / response)


def noise_row(level: LevelLines, band_Hz: Sequence[float]) -> dict[str, Any]:
    """Return the row of checks on the noise of a record, by its noisiest channel."""
    share = float(np.max(noise_share(level, band_Hz)))
    if not np.isfinite(share):
        text = "There is one period only: noise and transient can not be told from the response."
        return check_row("periods", "warn", text, level.name)
    if level.periods:
        text = f"{level.periods} periods are averaged; noise is {share:.2%} of the response."
    else:
        text = (
            "The record has no period: it is taken whole, without the transient at its ends; noise"
            f" and distortion are {share:.1%} of the response."
        )
    noisy = share > (NOISY if level.periods else LOUD)
    return check_row("noise", "warn" if noisy else "pass", text, level.name)


def long_record_lines(
    name: str,
    split: str,
    force: np.ndarray,
    response: np.ndarray,
    sampling_frequency: float,
    modes: IdentifiedModes | None = None,
    band_Hz: tuple[float, float] = (0.0, np.inf),
) -> LevelLines:
    """Return LevelLines of one record without period: force (time,), response (channel, time), Hz.

    modes: known ones, whose free decay is the transient over a band; None for local polynomials.
    noise is the scatter about the local polynomials: noise and distortion. periods is 0. Raises
    ValueError for a record too short.
    """
    size = force.size
    if size < FEWEST_SAMPLES:
        raise ValueError(
            f"{name}: {size} samples are too short for a record without period:"
            f" {FEWEST_SAMPLES} are the least"
        )
    driven = np.fft.rfft(force - force.mean()) / size
    lines = np.fft.rfft(response, axis=-1) / size
    transient, scatter = _local_polynomials(driven, lines)
    frequency, load = np.fft.rfftfreq(size, 1.0 / sampling_frequency), np.sqrt(np.mean(force**2))
    if modes is not None:
        inside = (frequency >= band_Hz[0]) & (frequency <= band_Hz[1])
        part = frequency[inside], driven[inside], lines[:, inside]
        transient = np.zeros_like(lines)
        transient[:, inside] = _free_decay(modes, *part)
    return LevelLines(name, split, float(load), frequency, driven, lines - transient, scatter, 0)


def _free_decay(modes, frequency, driven, lines):
    """Return (channel, line) the transient in lines (channel, line) under a force (line,).

    Least squares by channel: the response of the modes to the force with free residues, their free
    decay, (a + b s) / (s² + 2 zeta omega s + omega²) each, and a polynomial for the ends of the
    record.
    """
    laplace, receptance = 2j * np.pi * frequency, modes.receptance(frequency)
    ends = [(frequency / frequency[-1] * 1j) ** power for power in range(END_TERMS)]
    decay = np.concatenate([receptance, laplace * receptance, ends])
    out = np.empty_like(lines)
    for channel, observed in enumerate(modes.sensor_factors(frequency)):
        columns = np.concatenate([receptance * observed * driven, decay]).T
        columns /= np.linalg.norm(columns, axis=0)
        matrix = np.vstack([columns.real, columns.imag])
        wanted = np.concatenate([lines[channel].real, lines[channel].imag])
        values = np.linalg.lstsq(matrix, wanted, rcond=1.0e-10)[0]
        out[channel] = columns[:, modes.modes :] @ values[modes.modes :]
    return out


def _local_polynomials(driven, lines):
    """Return (transient (channel, line), scatter (channel, line)) of lines (channel, line) under a
    force (line,), line by line.
    """
    count, width = driven.size, 2 * HALF_WIDTH + 1
    # at the ends the stretch is not centred
    first = np.clip(np.arange(count) - HALF_WIDTH, 0, count - width)
    rows = first[:, None] + np.arange(width)
    away = (rows - np.arange(count)[:, None]) / HALF_WIDTH
    powers = away[:, :, None] ** np.arange(ORDER + 1)
    columns = np.concatenate([powers * driven[rows][:, :, None], powers.astype(complex)], axis=2)
    size = np.maximum(np.linalg.norm(columns, axis=1, keepdims=True), np.finfo(float).tiny)
    wanted = lines.T[rows]  # (line, stretch, channel)
    inverse = np.linalg.pinv(columns / size, rcond=1.0e-8)
    values = inverse @ wanted
    rest = wanted - (columns / size) @ values
    scatter = np.sqrt(np.sum(np.abs(rest) ** 2, axis=1) / (width - 2 * (ORDER + 1)))
    return (values[:, ORDER + 1] / size[:, 0, ORDER + 1][:, None]).T, scatter.T
