"""Checks of the statements of a campaign file: units, sizes, times, period, load, length.

Each yields rows {check, level, record, channel, message}, see file_checks.
"""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from vibroimpact.campaign.file import load_of
from vibroimpact.campaign.force_kinds import BASE
from vibroimpact.campaign.signals import FEWEST_SAMPLES, CampaignSignals, is_load

WIDE_GAP_M, FAR_M = 0.05, 100.0  # larger ones may be in millimetres
FILTERS = ("fir80", "none")  # that of simulations, and none
OFFSET = 0.2  # of the RMS about the mean: a larger constant part of a force is reported
NO_PERIOD = 0.5  # of the force: a larger difference between two periods is that of another force
COLUMNS = ("check", "level", "record", "channel", "message")
Rows = Iterator[dict]


def check_row(
    check: str, level: str, message: str, record: str | None = None, channel: str | None = None
) -> dict:
    """Return a row of a check."""
    return dict(zip(COLUMNS, (check, level, record, channel, message), strict=True))


def warning(
    check: str, message: str, record: str | None = None, channel: str | None = None
) -> dict:
    """Return a row of a check of level "warn"."""
    return check_row(check, "warn", message, record, channel)


def assumed_rows(campaign: xr.Dataset) -> Rows:
    """Yield rows of the values that were filled in, and of a filter that is not simulated."""
    for sentence in filter(None, campaign.attrs.get("assumed", "").split("\n")):
        yield warning("contract", sentence[0].upper() + sentence[1:] + ".")
    antialias = campaign.attrs.get("antialias", "")
    if antialias not in (*FILTERS, "", "unknown"):
        yield warning(
            "contract",
            f"antialias = '{antialias}' is a filter that is not simulated: simulated records pass"
            f" {FILTERS[0]}, so that the highest frequencies may differ; known are"
            f" {' and '.join(FILTERS)}.",
        )


def unit_rows(measured: CampaignSignals) -> Rows:
    """Yield rows of signals whose unit can not be used."""
    for faults, names in (
        (measured.unit_faults, measured.channels),
        (measured.force_unit_faults, measured.forces),
    ):
        for index, sentence in faults.items():
            yield warning(
                "units",
                f"{sentence[0].upper()}{sentence[1:]}. It is left out.",
                channel=names[index],
            )


def size_rows(campaign: xr.Dataset, measured: CampaignSignals) -> Rows:
    """Yield rows of gaps and places that are possible in metres, but likelier in millimetres."""
    gaps = {"gap": campaign["gap"].values.astype(float)}
    if "support_gap" in campaign:
        gaps["support_gap"] = campaign["support_gap"].values.astype(float)
    for name, values in gaps.items():
        for place in np.argwhere(values > WIDE_GAP_M)[:1]:
            index = "".join(f"[{number}]" for number in place)
            yield warning(
                "sizes",
                f"{name}{index} = {values[tuple(place)]:g} m is a wide clearance: is it in"
                " millimetres? Write metres.",
            )
    places = {
        "channel_point": measured.points,
        "force_channel_point": campaign["force_channel_point"].values.astype(float),
    }
    for name, points in places.items():
        for place in np.argwhere(np.abs(points) > FAR_M)[:1]:
            yield warning(
                "sizes",
                f"{name}[{place[0]}] = {points[place[0]].tolist()} m is far out: is it in"
                " millimetres? Write metres.",
            )


def time_rows(campaign: xr.Dataset, measured: CampaignSignals) -> Rows:
    """Yield rows of uneven samples, and of a sampling frequency that is not theirs."""
    if (
        "time" not in campaign
        or campaign["time"].dtype.kind not in "fiu"
        or campaign.sizes["time"] < 2
    ):
        return
    steps = np.diff(campaign["time"].values.astype(float))
    typical = float(np.median(steps))
    off = np.flatnonzero(~(np.abs(steps - typical) < 0.01 * abs(typical)))
    if not typical > 0.0 or off.size:
        place = int(off[0]) if off.size else 0
        yield check_row(
            "time",
            "refuse",
            f"The time between samples {place} and {place + 1} is {steps[place]:.4g} s, elsewhere"
            f" {typical:.4g} s: resample all channels to even steps.",
        )
    elif abs(typical * measured.rate - 1.0) > 1e-3:
        yield check_row(
            "time",
            "refuse",
            f"sampling_frequency is {measured.rate:g} Hz but the time steps say {1.0 / typical:g}"
            " Hz: correct the one that is wrong.",
        )


def load_rows(campaign: xr.Dataset, measured: CampaignSignals) -> Rows:
    """Yield rows of loads that are not those of the force, and of forces with an offset."""
    stated = campaign["load_rms"].values.astype(float)
    for record, name in enumerate(measured.records):
        found = load_of(measured.force[record][0], measured.rate, measured.stated_band)
        yield from _offset_rows(measured, record)
        if not is_load(stated[record], found):
            yield warning(
                "load_rms",
                f"load_rms is {stated[record]:.4g} but {measured.forces[0]} has an RMS of"
                f" {found:.4g} in record {name}: the unit or the valid samples of one of them are"
                " wrong; the force itself is used.",
                name,
                measured.forces[0],
            )


def _offset_rows(measured: CampaignSignals, record: int) -> Rows:
    """Yield a row for each force of a record that reads a constant part: its median, which the
    blows of a hammer do not move.
    """
    name = measured.records[record]
    for index, force in enumerate(measured.force[record]):
        kept = force[np.isfinite(force)]
        offset, rms = (float(np.median(kept)), float(kept.std())) if kept.size else (0.0, 0.0)
        if abs(offset) > OFFSET * rms > 0.0:
            unit = "m/s²" if measured.force_kinds[index] == BASE else "N"
            yield warning(
                "load_rms",
                f"{measured.forces[index]} reads a constant {offset:.4g} {unit} in record {name},"
                f" and an RMS of {rms:.4g} {unit} about it: loads are taken about the mean."
                " If it reads that at rest too, add remove_offset: true to it in campaign.yaml.",
                name,
                measured.forces[index],
            )


def short_rows(measured: CampaignSignals) -> Rows:
    """Yield rows of records too short for any average, which leave them out."""
    for record, name in enumerate(measured.records):
        samples = measured.force[record].shape[-1]
        if samples < FEWEST_SAMPLES:
            yield warning(
                "record length",
                f"Record {name} has {samples} samples: no spectrum can be averaged over fewer than"
                f" {FEWEST_SAMPLES}. The record is left out.",
                name,
                measured.forces[0],
            )


def period_rows(measured: CampaignSignals) -> Rows:
    """Yield a row if the force does not repeat with the stated period."""
    period = measured.stated_period
    for name, force in zip(measured.records, measured.force, strict=True):
        if not 0 < 2 * period <= force.shape[-1]:
            continue
        last, before = force[0, -period:], force[0, -2 * period : -period]
        share = np.std(last - before) / max(np.std(last), np.finfo(float).tiny)
        if share > NO_PERIOD:
            yield check_row(
                "time",
                "refuse",
                f"period_samples = {period}, but {measured.forces[0]} differs by {share:.0%} from"
                f" one period to the next in record {name}: write the samples of a period, or 0"
                " if the force does not repeat.",
                name,
            )
            return
