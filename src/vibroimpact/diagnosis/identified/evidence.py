"""The evidence of a diagnosis without a model: spectra of the steady response, places of missing
forces, the law that the records demand, and the error of the free response.

For linear modes held runs and the forces that the sensors demand have a closed form.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.identify.spectra.periodic_lines import LevelLines
from vibroimpact.reduction.modal_structure import IdentifiedModes

from ..constants import STRENGTH
from ..evidence import (
    FINER,
    HOLDING_BANDS,
    LAW_STRETCHES,
    PLACES,
    SERIES,
    STATES,
    holding_force,
    law_against_motion,
)
from ..free_runs import SEEDS, FreeRuns
from ..measurement.signals import Signals
from .trial import LocalTerm, Records, Trial

SEED = 7  # of the noise
PERIODS_BEFORE = 4  # the period that is compared: the transient is gone
SHOWN = 200  # samples of a waveform


def steady_lines(trial: Trial, records: Records) -> list[np.ndarray]:
    """Return [(channel, line)] of the excited lines of every level.

    Raises ValueError if the model has no bounded motion at some level.
    """
    lines = records.predict(trial, PERIODS_BEFORE)
    if lines is None:
        raise ValueError(
            f"{trial.name}: the completed model has no bounded motion at some level that it was not"
            " fitted to: leave that level out."
        )
    return [own[:, int(records.mean) :] for own in lines]


def free_runs(signals: Signals, before: Trial, after: Trial, records: Records) -> FreeRuns:
    """Return the FreeRuns of two trials, at the excited lines of the lowest level.

    The measured scatter between periods is drawn for each of SEEDS runs: their distance is the
    floor. Levels with other lines are interpolated.
    """
    own = list(zip(records.levels, records.excited, strict=True))
    grids = [level.frequency[lines] for level, lines in own]
    scatter = [np.nan_to_num(level.noise[:, lines]) for level, lines in own]
    draw = np.random.default_rng(SEED)

    def psd(values: Sequence[np.ndarray]) -> np.ndarray:
        """Return (record, channel, line): one-sided PSD of complex amplitudes."""
        rows = zip(values, grids, records.levels, strict=True)
        power = [(grid, 2.0 * np.abs(own) ** 2 / level.frequency[1]) for own, grid, level in rows]
        return np.array([[np.interp(grids[0], grid, row) for row in own] for grid, own in power])

    def noisy(lines: np.ndarray, size: np.ndarray) -> np.ndarray:
        real, imaginary = draw.standard_normal((2, *lines.shape)) / np.sqrt(2.0)
        return lines + size * (real + 1j * imaginary)

    def runs(trial: Trial) -> np.ndarray:
        """Return (record, seed, channel, line) of a trial."""
        rows = list(zip(steady_lines(trial, records), scatter, strict=True))
        return np.stack([psd([noisy(*row) for row in rows]) for _ in range(SEEDS)], axis=1)

    first = runs(before)
    last = first if after is before else runs(after)
    measured = psd([level.response[:, lines] for level, lines in own])
    return FreeRuns(signals, grids[0], measured, first, last, psd(scatter).mean(axis=2))


class _Level:
    """A level at its excited lines: their numbers, frequency in Hz, s in rad/s, force of the drive,
    motions (series, channel, line) in m, measured and of both states. samples: of a period, FINER
    than the band needs.
    """

    def __init__(
        self, level: LevelLines, lines: np.ndarray, states: list[np.ndarray], modes: IdentifiedModes
    ):
        self.lines, self.frequency = lines, level.frequency[lines]
        self.s, self.force = 2j * np.pi * self.frequency, level.force[lines]
        series = np.array([level.response[:, lines], *states])
        self.motions = series / modes.sensor_factors(self.frequency)
        self.samples = 2 * FINER * int(lines[-1])

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

    free_error and waveform are of the free response: no sensor is held. If the response is not a
    motion (mechanical False), quantities with mechanical units are left out.
    """
    held = np.array([level.split == "holdout" for level in records.levels])
    rows = [(level.name, level.split, level.load_rms) for level in records.levels]
    names, splits, loads = (np.array(column, object) for column in zip(*rows, strict=True))
    out = xr.Dataset(
        {
            "channel_name": ("channel", np.array(before.modes.names, object)),
            "channel_kind": ("channel", np.array(before.modes.kinds, object)),
            "record_name": ("stretch", names),
            "split": ("stretch", splits),
            "part": ("stretch", np.where(held, "apart", "fitted").astype(object)),
            "load": ("stretch", loads.astype(float), {"units": "N"}),
        },
        coords={"state": list(STATES), "series": list(SERIES)},
        attrs={"before": before.name, "after": after.name, "held": "nothing"},
    ).assign({name: campaign[name].variable for name in PLACES if name in campaign})
    if not mechanical:
        return out.assign_attrs(left_out="the response is no motion, and forces are not in N")
    states = (steady_lines(trial, records) for trial in (before, after))
    both = zip(records.levels, records.excited, *states, strict=True)
    levels = [_Level(level, lines, own, before.modes) for level, lines, *own in both]
    out = out.assign(_free(levels, held)).assign(_holding(levels, before.modes))
    return out.assign(_law(levels, records, after))


def _holding(levels: Sequence[_Level], modes: IdentifiedModes) -> dict[str, Any]:
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
    return holding_force(found, edges)


def _law(levels: Sequence[_Level], records: Records, after: Trial) -> dict[str, Any]:
    """Return the force against the motion at each place that channels show: as the sensors demand
    it of the completed modes, and by the added laws; the modes as given have no element.
    """
    terms = {term.place: term for term in after.terms if term.participation is None}
    if not terms:
        return {}
    order = np.linspace(0, len(levels) - 1, LAW_STRETCHES).round().astype(int)
    chosen = list(dict.fromkeys(order.tolist()))
    samples = min(levels[number].samples for number in chosen)
    lowest = levels[0].motions
    miss = np.linalg.norm(lowest[1] - lowest[0], axis=1) / np.linalg.norm(lowest[0], axis=1)
    places = [term.place for term in after.terms for _ in range(term.effect.elements)]
    elements = [np.flatnonzero([place == name for place in places]) for name in terms]
    runs = {
        number: (pushed[:, lane], moved[:, lane])
        for part, _, moved, pushed in records.runs(after, PERIODS_BEFORE)
        for lane, number in enumerate(part)
    }
    demanded, model, known = [], [], []
    for level, run in ((levels[number], runs[number]) for number in chosen):
        force, motion, share = _demanded(level, after, terms, miss)
        pushed, moved = (each[:, level.lines] for each in run)
        laws = [pushed[rows].sum(axis=0) for rows in elements]
        law = np.array((laws, [moved[rows[0]] for rows in elements]))
        demanded.append(level.series(np.array((force, motion)), samples))
        model.append(level.series(law, samples))
        known.append(share)
    told, own = (np.array(rows, np.float32).swapaxes(0, 1) for rows in (demanded, model))
    states = np.stack([np.full_like(own, np.nan), own])
    out = law_against_motion([*terms], [*terms], chosen, told, states)
    return out | {"resolution": (("law_stretch", "place"), np.array(known))}


def _demanded(
    level: _Level, after: Trial, terms: dict[str, LocalTerm], miss: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (force (place, line), motion (place, line), share of the force that is known (place,))
    of a level: least squares per line, a force at a hidden place among them.

    miss (channel,): relative error of linear modes at the lowest level, without laws; the part of
    the force that it causes is not known.
    """
    modes, hidden = after.modes, [term for term in after.terms if term.place not in terms]
    columns = np.stack([own.along(modes) for own in (*terms.values(), *hidden[:1])], axis=1)
    receptance, measured = modes.receptance(level.frequency), level.motions[0]
    free = modes.shapes.T @ (modes.shapes[:, [modes.drive]] * receptance * level.force)
    inverse = np.linalg.pinv(np.einsum("mc,mp,ml->lcp", modes.shapes, columns, receptance))
    force = np.einsum("lpc,cl->pl", inverse, measured - free)
    wrong = np.einsum("lpc,c,cl->p", np.abs(inverse) ** 2, miss**2, np.abs(measured) ** 2)
    known = 1.0 - wrong / np.maximum(np.sum(np.abs(force) ** 2, axis=1), np.finfo(float).tiny)
    motion = np.array([term.row @ measured for term in terms.values()])
    return force[: len(terms)], motion, np.maximum(known[: len(terms)], 0.0)


def _free(levels: Sequence[_Level], held: np.ndarray) -> dict[str, Any]:
    """Return the errors of the free response, the highest held-out level first, and the waveform of
    the channel that improves most there, as velocities.
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
