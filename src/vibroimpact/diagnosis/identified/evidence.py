"""The evidence of a diagnosis without a model: where forces are missing, the law that the records
demand, and the error of the free response.

Of linear modes a held run has a closed form, and so have the forces that the sensors demand.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from vibroimpact.integration.steady_response import steady_elements
from vibroimpact.reduction.modal_structure import IdentifiedModes

from ..constants import STRENGTH
from ..evidence import HOLDING_BANDS, LAW_STRETCHES, PLACES, SERIES, STATES
from .spectra import PERIODS_BEFORE, steady_lines
from .trial import LocalTerm, Records, Trial

FINER = 4  # times the sampling of the band, as a waveform is drawn
SHOWN = 200  # samples of a waveform


@dataclass(frozen=True, eq=False)
class _Level:
    """A level at its excited lines: their numbers, frequency in Hz, s in rad/s, force of the drive,
    motions (series, channel, line) in m, measured and of both states.
    """

    lines: np.ndarray
    frequency: np.ndarray
    s: np.ndarray
    force: np.ndarray
    motions: np.ndarray

    @property
    def samples(self) -> int:
        """Return the samples of a period, FINER than the band needs."""
        return 2 * FINER * int(self.lines[-1])

    def series(self, values: np.ndarray, samples: int) -> np.ndarray:
        """Return (.., sample) of complex amplitudes (.., line) over a period."""
        spectrum = np.zeros((*values.shape[:-1], samples // 2 + 1), complex)
        spectrum[..., self.lines] = values * samples
        return np.fft.irfft(spectrum, samples, axis=-1)


def evidence_of(
    campaign: xr.Dataset, records: Records, before: Trial, after: Trial, mechanical: bool
) -> xr.Dataset:
    """Return the evidence for two Trials, the modes of the lowest level and the completed model;
    variables as those of diagnosis.evidence.evidence_of.

    free_error and waveform are of the free response: no sensor is held. Where the response is no
    motion (mechanical False), what has units of mechanics is left out.
    """
    names = before.modes.names, before.modes.kinds
    held = np.array([level.split == "holdout" for level in records.levels])
    texts = {
        "channel_name": ("channel", names[0]),
        "channel_kind": ("channel", names[1]),
        "record_name": ("stretch", [level.name for level in records.levels]),
        "split": ("stretch", [level.split for level in records.levels]),
        "part": ("stretch", np.where(held, "apart", "fitted")),
    }
    out = xr.Dataset(
        {name: (dim, np.array(values, object)) for name, (dim, values) in texts.items()},
        coords={"state": list(STATES), "series": list(SERIES)},
        attrs={"before": before.name, "after": after.name, "held": "nothing"},
    )
    loads = [level.load_rms for level in records.levels]
    out = out.assign(load=("stretch", loads, {"units": "N"}))
    out = out.assign({name: campaign[name].variable for name in PLACES if name in campaign})
    if not mechanical:
        return out.assign_attrs(left_out="the response is no motion, and forces are not in N")
    levels = _levels(records, before, after)
    out = out.assign(_free(levels, held)).assign(_holding(levels, before.modes))
    return out.assign(_law(levels, records, after))


def _levels(records: Records, before: Trial, after: Trial) -> list[_Level]:
    """Return the _Level of every level."""
    out = []
    states = [steady_lines(trial, records) for trial in (before, after)]
    for number, level in enumerate(records.levels):
        lines = np.flatnonzero(level.excited(records.band_Hz))
        frequency = level.frequency[lines]
        series = [level.response[:, lines], *(state[number] for state in states)]
        motions = np.array(series) / before.modes.sensor_factors(frequency)
        s = 2j * np.pi * frequency
        out.append(_Level(lines, frequency, s, level.force[lines], motions))
    return out


def _holding(levels: Sequence[_Level], modes: IdentifiedModes) -> dict:
    """Return the RMS of the holding force by band: (1/c + Y) u = v_s - v of linear modes with the
    mobility Y between the sensors, v_s measured and v of the free response.
    """
    strength = STRENGTH * modes.omega[~modes.residual].min() / np.max(modes.shapes**2)
    edges = np.geomspace(levels[0].frequency[0], levels[0].frequency[-1], HOLDING_BANDS + 1)
    channels = len(modes.names)
    found = np.zeros((len(STATES), len(levels), channels, HOLDING_BANDS))
    for number, level in enumerate(levels):
        receptance = level.s * modes.receptance(level.frequency)
        mobility = np.einsum("mc,md,ml->lcd", modes.shapes, modes.shapes, receptance)
        away = level.s * (level.motions[0] - level.motions[1:])
        matrix = np.eye(channels) / strength + mobility
        force = np.linalg.solve(matrix, away.transpose(0, 2, 1)[..., None])[..., 0]
        band = np.clip(np.digitize(level.frequency, edges) - 1, 0, HOLDING_BANDS - 1)
        for own in range(HOLDING_BANDS):
            power = 2.0 * np.sum(np.abs(force[:, band == own]) ** 2, axis=1)
            found[:, number, :, own] = np.sqrt(power)
    return {
        "holding_force": (("state", "stretch", "channel", "band"), found, {"units": "N"}),
        "band_low": ("band", edges[:-1], {"units": "Hz"}),
        "band_high": ("band", edges[1:], {"units": "Hz"}),
    }


def _law(levels: Sequence[_Level], records: Records, after: Trial) -> dict:
    """Return the force against the motion at each place that channels show, as the sensors demand
    it of the completed modes and as the added laws have it; the modes as given have no element.
    """
    terms = {term.place: term for term in after.terms if term.participation is None}
    if not terms:
        return {}
    order = np.linspace(0, len(levels) - 1, LAW_STRETCHES).round().astype(int)
    chosen = list(dict.fromkeys(order.tolist()))
    samples = min(levels[number].samples for number in chosen)
    shape = (2, len(chosen), len(terms), samples)  # force and motion
    demanded, model, known = np.zeros(shape), np.zeros(shape), np.zeros(shape[1:3])
    lowest = levels[0].motions
    miss = np.linalg.norm(lowest[1] - lowest[0], axis=1) / np.linalg.norm(lowest[0], axis=1)
    for row, number in enumerate(chosen):
        *both, known[row] = _demanded(levels[number], after, terms, miss)
        demanded[:, row] = levels[number].series(np.array(both), samples)
        own = np.array(_modelled(levels[number], records, number, after, terms))
        model[:, row] = levels[number].series(own, samples)
    dims = ("law_stretch", "place", "sample")
    out: dict = {
        "place_name": ("place", np.array(list(terms), object)),
        "owner_name": ("place", np.array(list(terms), object)),
        "law_of_stretch": ("law_stretch", np.array(chosen)),
        "resolution": (dims[:2], known),
    }
    for part, (name, unit) in enumerate((("force", "N"), ("motion", "m"))):
        states = np.stack([np.full_like(model[part], np.nan), model[part]])
        out[f"demanded_{name}"] = dims, demanded[part].astype(np.float32), {"units": unit}
        out[f"model_{name}"] = ("state", *dims), states.astype(np.float32), {"units": unit}
    return out


def _demanded(
    level: _Level, after: Trial, terms: dict[str, LocalTerm], miss: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (force (place, line), motion (place, line), share of the force that is known (place,))
    of a level: least squares per line, a force at a hidden place among them.

    miss (channel,): relative error of linear modes where no law acts, at the lowest level; what it
    makes of the force is not known.
    """
    modes, hidden = after.modes, [term for term in after.terms if term.place not in terms]
    columns = np.stack([own.along(modes) for own in (*terms.values(), *hidden[:1])], axis=1)
    receptance = modes.receptance(level.frequency)
    free = modes.shapes.T @ (modes.shapes[:, [modes.drive]] * receptance * level.force)
    measured = level.motions[0]
    inverse = np.linalg.pinv(np.einsum("mc,mp,ml->lcp", modes.shapes, columns, receptance))
    force = np.einsum("lpc,cl->pl", inverse, measured - free)
    wrong = np.einsum("lpc,c,cl->p", np.abs(inverse) ** 2, miss**2, np.abs(measured) ** 2)
    known = 1.0 - wrong / np.maximum(np.sum(np.abs(force) ** 2, axis=1), np.finfo(float).tiny)
    motion = np.array([term.row @ measured for term in terms.values()])
    return force[: len(terms)], motion, np.maximum(known[: len(terms)], 0.0)


def _modelled(level: _Level, records: Records, number: int, after: Trial, terms) -> tuple:
    """Return (force, motion) (place, line) of the added laws, of all of a place together."""
    model, _ = after.model()
    part, drive, samples = next(group for group in records.groups if number in group[0])
    drive, samples = records.with_offsets(after, part, drive, samples)
    motion, force = (
        values[:, part.index(number)][:, level.lines]
        for values in steady_elements(model, drive, samples, PERIODS_BEFORE)
    )
    places = [term.place for term in after.terms for _ in range(term.effect.elements)]
    own = [[row for row, place in enumerate(places) if place == name] for name in terms]
    return [force[rows].sum(axis=0) for rows in own], [motion[rows[0]] for rows in own]


def _free(levels: Sequence[_Level], held: np.ndarray) -> dict:
    """Return the errors of the free response, the highest held-out level first, and the waveform of
    the channel that gains most there, as velocities.
    """
    order = sorted(range(len(levels)), key=lambda at: (not held[at], -at))
    error = np.array(
        [
            np.linalg.norm(level.s * (level.motions[1:] - level.motions[0]), axis=-1)
            / np.linalg.norm(level.s * level.motions[0], axis=-1)
            for level in (levels[at] for at in order)
        ]
    ).swapaxes(0, 1)
    first = levels[order[0]]
    channel = int(np.argmax(error[0, 0] - error[1, 0]))
    series = first.series(first.s * first.motions[:, channel], first.samples)
    loudest = int(np.argmax(np.abs(series[0])))
    inside = (loudest + np.arange(-SHOWN // 2, SHOWN // 2)) % first.samples
    time = np.arange(SHOWN) * first.lines[0] / (first.frequency[0] * first.samples)
    return {
        "free_error": (("state", "free_stretch", "channel"), error, {"units": "1"}),
        "free_of_stretch": ("free_stretch", np.array(order)),
        "waveform": (("series", "moment"), series[:, inside], {"units": "m/s"}),
        "moment_time": ("moment", time, {"units": "s"}),
        "waveform_stretch": ((), order[0]),
        "waveform_channel": ((), channel),
    }
