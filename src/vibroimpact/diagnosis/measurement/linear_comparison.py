"""Measured frequency responses against those of a linear model: modes, channels, units."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from vibroimpact.campaign.base_motion import relative_to_base
from vibroimpact.campaign.checks.model_comparison import compare_with_model
from vibroimpact.campaign.file import Channel, Level, campaign_dataset, read_campaign
from vibroimpact.campaign.importing.frf import read_frfs
from vibroimpact.campaign.signals import Transfer, campaign_signals, transfer_or_reason
from vibroimpact.config.reading import load_config
from vibroimpact.config.schema import Config
from vibroimpact.identify.ods import mac
from vibroimpact.identify.stabilisation import stable_poles
from vibroimpact.io.units import SI_OF_KIND, TIME_DERIVATIVES
from vibroimpact.reduction.modal_model import ModalModel

from .attached_model import attach
from .comparable import comparison_problems

MANY = 1000  # averages of a frequency response whose number is not stated
NEGLIGIBLE = 0.01  # of the response of every channel: a pole with less is not a mode
NEAR = 0.3  # relative: a mode of the model that is further off is not a partner
COLUMNS = (
    "frequency_Hz",
    "damping_ratio",
    "model_frequency_Hz",
    "model_damping_ratio",
    "difference",
    "mac",
)


class NotComparable(ValueError):
    """Responses that allow no linear comparison; the message says why."""


def compared(path: str | Path, model: str | Path, is_campaign: bool) -> list[str]:
    """Return the comparison of measured responses with the linear model of a configuration file, as
    lines for a terminal.

    path: of a campaign, or of a universal file with frequency responses.
    Raises NotComparable, ImportProblem, RecordError, CampaignError, ConfigError.
    """
    config = load_config(model)
    if is_campaign:
        campaign = read_campaign(path)
        spectra = _lowest_responses(campaign)
    else:
        campaign, spectra = described(*read_frfs(path))
    problems = comparison_problems(config, campaign)
    if problems:
        raise NotComparable("\n".join(problems))
    return _as_text(*linear_comparison(config, campaign, spectra))


def described(
    frequency: np.ndarray, h1: np.ndarray, responses: Sequence[Channel], drive: Channel
) -> tuple[xr.Dataset, Transfer]:
    """Return (campaign without signals, Transfer) of responses to one force, as of read_frfs."""
    channels = [replace(each, units=SI_OF_KIND[each.kind]) for each in responses]
    name = f"{drive.name} force" if drive.name in {each.name for each in channels} else drive.name
    force = replace(drive, name=name, units="N")
    silent = np.zeros((1, len(channels), 2))
    campaign = campaign_dataset(
        silent[:, :1], silent, channels, [force], [Level("responses", np.nan)], 1.0
    )
    power, all_of = np.sum(np.abs(h1) ** 2, axis=-1), np.ones(h1.shape)
    spectra = Transfer(frequency, h1, all_of, power, all_of[:, 0], MANY, float(frequency[0]))
    return campaign, spectra


def _lowest_responses(campaign: xr.Dataset) -> Transfer:
    """Return the Transfer of the record of the lowest load. Raises NotComparable."""
    measured = relative_to_base(campaign_signals(campaign))
    record = measured.lowest()
    if record is None:
        raise NotComparable("no record has a force and a response without holes")
    found = transfer_or_reason(measured, record)
    if isinstance(found, str):
        raise NotComparable(found)
    return found


def linear_comparison(
    config: Config, campaign: xr.Dataset, spectra: Transfer
) -> tuple[list[dict], list[dict]]:
    """Return (modes, checks) of measured responses per force channel 0 against the linear model.

    modes: a row of COLUMNS for each mode that is measured, NaN if the model has none near.
    checks: rows of compare_with_model.
    campaign: with the places of channels and force. spectra: of its lowest record.
    """
    model = attach(config, campaign)
    kinds = [str(kind) for kind in campaign["channel_kind"].values]
    s = 2j * np.pi * spectra.frequency
    orders = np.array([TIME_DERIVATIVES.get(kind, 0) for kind in kinds])[:, None]
    receptance = 1.0 / (model.omega[:, None] ** 2 + s**2 + model.damping[:, None] * s)
    motion = (model.sensor_shapes * model.drive_shapes[:, :1]).T @ receptance * s**orders
    names = [str(name) for name in campaign["channel_name"].values]
    checks = compare_with_model(spectra, motion, names, kinds, None)
    return _modes(model, spectra, s, orders), checks


def _modes(model: ModalModel, spectra: Transfer, s: np.ndarray, orders: np.ndarray) -> list[dict]:
    """Return the modes of linear_comparison."""
    size = np.sqrt(np.mean(np.abs(spectra.h1) ** 2, axis=1, keepdims=True))
    scaled = spectra.h1 / np.maximum(size, np.finfo(float).tiny)
    places, ratios, _ = stable_poles(spectra.frequency, scaled)
    omega = 2.0 * np.pi * places[:, None]
    poles = 1.0 / (s**2 + 2.0 * ratios[:, None] * omega * s + omega**2)
    rows = []
    lines = np.vstack([poles, np.ones_like(s), s**-2]) * s ** orders[:, None]
    residues = np.array(list(map(_real_residues, lines, spectra.h1)))
    parts = np.linalg.norm(residues[:, :, None] * lines, axis=-1)
    share = parts / np.linalg.norm(spectra.h1, axis=1, keepdims=True)
    for number, (place, ratio) in enumerate(zip(places, ratios, strict=True)):
        if share[:, number].max() < NEGLIGIBLE:  # a pole of the noise
            continue
        values = _partner(model, place, residues[:, number])
        rows.append(dict(zip(COLUMNS, map(float, (place, ratio, *values)), strict=True)))
    return rows


def _partner(model: ModalModel, place: float, shape: np.ndarray) -> Sequence[float]:
    """Return (Hz, damping ratio, relative difference, MAC) of the mode of the model that is most
    like a measured one, of a frequency in Hz and a shape (channel,); NaN if none is near.
    """
    frequency = model.omega / (2.0 * np.pi)
    near = np.flatnonzero(np.abs(frequency - place) < NEAR * place)
    if not near.size:
        return (np.nan,) * 4
    macs = mac(model.sensor_shapes[near], shape)
    best = int(np.argmax(macs - np.abs(frequency[near] / place - 1.0)))
    mode = near[best]
    ratio = model.damping[mode] / (2.0 * model.omega[mode])
    return frequency[mode], ratio, frequency[mode] / place - 1.0, macs[best]


def _real_residues(lines: np.ndarray, h1: np.ndarray) -> np.ndarray:
    """Return (part,) real amplitudes of parts (part, line) that make h1 (line,)."""
    columns = np.hstack([lines.real, lines.imag]).T
    scale = np.linalg.norm(columns, axis=0)
    return np.linalg.lstsq(columns / scale, np.hstack([h1.real, h1.imag]))[0] / scale


def _as_text(modes: list[dict], checks: list[dict]) -> list[str]:
    """Return a linear comparison as lines for a terminal."""
    lines = ["measured              model                 difference   MAC"]
    for row in modes:
        measured = f"{row['frequency_Hz']:8.5g} Hz {row['damping_ratio']:6.2%}"
        if np.isnan(row["mac"]):
            lines.append(f"{measured}   no mode of the model is within {NEAR:.0%}")
            continue
        model = f"{row['model_frequency_Hz']:8.5g} Hz {row['model_damping_ratio']:6.2%}"
        lines.append(f"{measured}   {model}   {row['difference']:+8.2%}   {row['mac']:.3f}")
    if not modes:
        lines = ["No pole is stable in the measured responses."]
    return [*lines, *(row["message"].replace(" in record None", "") for row in checks)]
