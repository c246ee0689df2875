"""The part of a campaign that can be compared with a model: checks, and the channels and records
that are left.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import xarray as xr

from vibroimpact.campaign.base_motion import relative_to_base
from vibroimpact.campaign.checks import file_checks
from vibroimpact.campaign.checks.model_comparison import compare_with_model
from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.campaign.file import CampaignError, fill_missing
from vibroimpact.campaign.force_kinds import base_channels
from vibroimpact.campaign.signals import campaign_signals, transfer
from vibroimpact.config.schema import Config
from vibroimpact.effects.registry import EFFECTS

from . import comparable
from .attached_model import attach
from .sensed_motion import of_modes, orders

CONTRADICTED = ("swapped channels", "directions")  # checks whose channels are left out
AGAINST_MODEL = "against the model"  # key of rows that compare a channel with the model as given
FEWEST_RECORDS = 2


class Refused(Exception):
    """A campaign that can not be compared with a model; checks: all rows, one of level refuse."""

    def __init__(self, sentence: str, checks: Sequence[dict[str, Any]]):
        super().__init__(sentence)
        self.checks = list(checks)


def usable(
    campaign: xr.Dataset | str | Path, config: Config
) -> tuple[xr.Dataset, list[dict[str, Any]]]:
    """Return (the comparable part of a campaign or of its file, rows of all checks). Raises
    Refused, with the reason.
    """
    whole, checks = checked_campaign(campaign)
    if whole is not None and not file_checks.refused(checks):
        checks += comparable.channel_rows(whole) + comparable.record_rows(whole)
        problems = comparable.comparison_problems(config, whole)
        checks += [check_row("model", "refuse", f"{problem}.") for problem in problems]
    found = _left(whole, checks)
    for rows_of in (comparable.model_rows, _against_model):
        try:
            more = rows_of(config, found)
        except CampaignError as error:
            more = [check_row("places", "refuse", str(error))]
        if more:
            checks += more
            found = _left(whole, checks)
    return found, checks


def checks_of_completed(
    checks: Sequence[dict[str, Any]], campaign: xr.Dataset | str | Path, completed: Config
) -> list[dict[str, Any]]:
    """Return the rows of checks of `usable`, in which channels pass that contradict the model as
    given and not the completed one: the model was at fault, not the channel.
    """
    if not any(row.get(AGAINST_MODEL) for row in checks):
        return list(checks)
    whole, _ = checked_campaign(campaign)
    others = [row for row in checks if row["level"] == "warn" and not row.get(AGAINST_MODEL)]
    rows = _against_model(completed, _left(whole, others))
    still = {row["channel"] for row in rows if row.get(AGAINST_MODEL)}
    out = []
    for row in checks:
        if row.get(AGAINST_MODEL) and (channel := row["channel"]) not in still:
            told = f"{channel} contradicts the model as given, and not the completed one."
            row = check_row(row["check"], "pass", told, row["record"], channel)
        out.append(row)
    return out


def not_testable(campaign: xr.Dataset) -> list[str]:
    """Return the ids of the effects that need quantities missing in a campaign."""
    held = {name for name in ("voltage",) if name in campaign}
    if not base_channels(campaign).any():
        held.add("force")
    return [effect.reported for effect in EFFECTS.values() if not set(effect.needs) <= held]


def checked_campaign(
    campaign: xr.Dataset | str | Path,
) -> tuple[xr.Dataset | None, list[dict[str, Any]]]:
    """Return (Dataset or None, rows) of a Dataset or a file."""
    if not isinstance(campaign, xr.Dataset):
        return file_checks.check_file(campaign)
    rows = file_checks.check_campaign(campaign)
    return (None if file_checks.refused(rows) else fill_missing(campaign)), rows


def _left(whole: xr.Dataset | None, checks: list[dict[str, Any]]) -> xr.Dataset:
    """Return the part of a campaign that the checks leave. Raises Refused if that is too little."""
    if file_checks.refused(checks) or whole is None:
        raise Refused(next(row["message"] for row in checks if row["level"] == "refuse"), checks)
    force, response = file_checks.usable_signals(whole, checks)
    out = comparable.left_out(checks) | {
        row["channel"]
        for row in checks
        if row["check"] in CONTRADICTED and row["level"] == "warn" and row["record"] is not None
    }
    short = [row["record"] for row in checks if row["check"] == comparable.SHORT]
    force = force & ~np.isin(whole["record_name"].values, short)
    kept = ~np.isin(whole["channel_name"].values, [*filter(None, out)])
    moving = of_modes(whole["channel_kind"].values)
    if not (kept & moving).any():
        told = [row["message"] for row in checks if row["check"] == comparable.LEFT_OUT]
        none = "No channel that measures a motion or a strain is left after the checks."
        refuse([*told, none][0], checks)
    channels = np.flatnonzero(kept)
    records = np.flatnonzero(force)
    whole_channels = channels[response[np.ix_(records, channels)].all(axis=0)]
    if len(records) >= FEWEST_RECORDS and moving[whole_channels].any():
        channels = whole_channels
    else:  # a channel that fails in some record costs that record
        records = np.flatnonzero(force & response[:, channels].all(axis=1))
    if len(records) < FEWEST_RECORDS:
        refuse("Fewer than two records are left after the checks: repair what they name.", checks)
    return whole.isel(record=records, channel=channels)


def refuse(sentence: str, checks: Sequence[dict[str, Any]]) -> NoReturn:
    """Raise Refused with a row of checks that says why."""
    raise Refused(sentence, [*checks, check_row("content", "refuse", sentence)])


def _against_model(config: Config, campaign: xr.Dataset) -> list[dict[str, Any]]:
    """Return rows for what does not match the model attached to the campaign: a sampling frequency
    too low for its modes, contact forces that it lacks, and channels that contradict the linear
    model at the lowest level: swapped, reversed, or in another unit.
    """
    model, measured = attach(config, campaign), relative_to_base(campaign_signals(campaign))
    rows = comparable.contact_force_rows(model, campaign)
    rows += comparable.sampling_rows(model, campaign)
    record = measured.lowest()
    spectra = None if record is None else transfer(measured, record)
    if record is None or spectra is None:
        return rows
    s = 2j * np.pi * spectra.frequency
    forces = np.ones((1, s.size))  # each over the first one
    if measured.force[record].shape[0] > 1:
        others = replace(measured, response=[force[1:] for force in measured.force])
        beside = transfer(others, record)
        if beside is None:
            return rows
        forces = np.concatenate([forces, beside.h1])
    receptance = 1.0 / (model.omega[:, None] ** 2 + s**2 + model.damping[:, None] * s)
    driven = model.drive_shapes @ forces
    motion = np.einsum("mc,ml,ml->cl", model.sensor_shapes, driven, receptance)
    motion *= s ** orders(measured.kinds)[:, None] * of_modes(measured.kinds)[:, None]
    channels = measured.channels, measured.kinds, measured.records[record]
    against = compare_with_model(spectra, motion, *channels)
    return rows + [row | {AGAINST_MODEL: True} for row in against]
