"""Identification of the modes of the lowest record: frequencies, damping and participations fitted
to the Fourier lines of its response to the measured force, from rest to its end.

The measured and a simulated record are analysed alike, so that errors of the method are the same in
both. Here it is decided which modes are fitted, from which start and with which participations; a
fit itself is in modal_fit.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vibroimpact.observation.linear_record import LinearRecord
from vibroimpact.observation.sensed_motion import differentiated, kind_groups, of_modes, orders
from vibroimpact.observation.strain import STRAIN, as_displacements, gauges_of
from vibroimpact.reduction.modal_model import ModalModel

from .channel_responses import combined, responses_of, without_base
from .lags import driven_modes, from_phases, lags
from .matching_pursuit import assigned, pursued
from .modal_fit import ModalFit
from .modal_lines import LARGEST_LOG_DAMPING, ModalLines

# of the response at a line, besides the noise: keeps the weights of strong lines finite
MODEL_ERROR = 3.0e-3
# of the typical line: error in every line by the ends of a record and modes far above the band
LEAK = 2.0e-3
# of the largest response, converted to the same kind of motion: resolution of a converter of 20
# bits, in a channel that does not move
RESOLVED = 1.0e-6
VISIBLE = 3.0  # times the noise in the band: below it a mode is not fitted
UNEXPECTED = 60.0  # chi-square that a mode which the model does not excite must explain
LEAST_LAG_S = 2.0e-5
SURE = 4.0  # standard deviations of a delay that is taken for one
# of a mode's largest displacement among the channels: below it a channel does not see the mode in
# the model
SILENT = 1.0e-4
BESIDE = 0.03  # of ln frequency: closer modes are hardly separated in a channel
# of the mode that a base drives most: the drive of other modes is the remainder of a sum over the
# whole structure that nearly cancels, which no model predicts
HARDLY = 0.02
AT_ONCE = 32  # modes whose lines are computed at a time, to save memory
LOST = 6.0  # times the noise: a larger residual in a channel means a start at wrong frequencies


def fit_modes(
    record: LinearRecord,
    responses: np.ndarray,
    model: ModalModel,
    kinds: Sequence[str] | np.ndarray,
    noise_rms: np.ndarray,
    visible: np.ndarray | None = None,
    search: bool = True,
) -> ModalFit | None:
    """Return the ModalFit of responses (channel, sample) to the force of a LinearRecord, None where
    no mode is visible.

    model: ModalModel attached to the campaign; kinds (channel,): see sensed_motion.SENSED;
    noise_rms (channel,): in the band; visible: indices of the modes to fit, None to choose them by
    their predicted response; search: whether to look for resonances without the model where the fit
    from its frequencies is bad. Contact forces are not fitted: their participation, delay and share
    are 0 and their residual is 1, that of noise.
    """
    moves, kinds = of_modes(kinds), np.asarray(kinds)
    if not moves.any():
        return None
    if not moves.all():
        responses, noise_rms, kinds = responses[moves], noise_rms[moves], kinds[moves]
        model, record = with_sensors(model, moves), record.of(moves)
    found = _fit(record, responses, model, kinds, noise_rms, visible)
    if found is not None and visible is None and search and left(found, model) >= LOST:
        found = min(
            found,
            _fit(record, responses, model, kinds, noise_rms, visible, True),
            key=lambda fit: left(fit, model),
        )
    return found if found is None or moves.all() else _among_all(found, moves)


def _largest(record, measured, kinds):
    """Return (channel,): the largest RMS of measured (channel, line) among all channels, converted
    to its kind of motion; for a strain among the strains.
    """
    order, gauges = orders(kinds), np.asarray(kinds) == STRAIN
    omega = 2.0 * np.pi * np.maximum(record.frequency, record.frequency[record.frequency > 0].min())
    power = [
        np.sum(np.abs(measured) ** 2 * omega ** (2.0 * (own - order[:, None])), axis=-1)
        * (gauges == gauge)
        for own, gauge in zip(order, gauges, strict=True)
    ]
    return np.sqrt(np.max(power, axis=-1))


def with_sensors(model: ModalModel, chosen: np.ndarray) -> ModalModel:
    """Return the ModalModel with the sensors chosen (sensor,) bool alone."""
    gauges = gauges_of(model)
    return replace(
        model,
        **({"gauges": gauges[chosen]} if gauges.any() else {}),
        sensor_shapes=model.sensor_shapes[:, chosen],
        sensor_names=tuple(np.array(model.sensor_names, dtype=object)[chosen]),
        sensor_positions=model.sensor_positions[chosen],
        sensor_directions=model.sensor_directions[chosen],
    )


def _among_all(found, moves):
    """Return a ModalFit of the channels that show modes, moves (channel,), as one of all."""

    def placed(values, other):
        out = np.full((len(moves), *values.shape[1:]), other, values.dtype)
        out[moves] = values
        return out

    neutral = {
        "participation": 0.0,
        "shape_covariance": 0.0,
        "shape_slopes": 0.0,
        "delay": 0.0,
        "residual": 1.0,
        "share": 0.0,
    }
    return replace(
        found, **{name: placed(getattr(found, name), other) for name, other in neutral.items()}
    )


def _fit(record, responses, model, kinds, noise_rms, visible, elsewhere=False):
    """Return the ModalFit from the model's frequencies, or, elsewhere, from those of the resonances
    found without it.
    """
    measured = record.spectra(np.asarray(responses, float))
    near = np.flatnonzero(
        (model.omega > 0.0) & (model.omega < 1.3 * 2.0 * np.pi * record.frequency[-1])
    )
    if record.base is not None:
        drive = np.abs(model.drive_shapes[near]).max(axis=1)
        near = near[drive > HARDLY * drive.max(initial=0.0)]
    expected = responses_of(
        record, model.omega[near], model.damping[near], model.drive_shapes[near], kinds
    )
    sizes = {kind: np.sqrt(np.sum(np.abs(own) ** 2, axis=-1)) for kind, own in expected.items()}
    size = np.array([sizes[kind] for kind in kinds]).T
    noise = np.maximum(noise_rms, np.maximum(RESOLVED * _largest(record, measured, kinds), 1.0e-12))
    fixed = visible is not None
    if not fixed:
        chosen = ((np.abs(model.sensor_shapes[near]) * size) > VISIBLE * noise).any(axis=1)
        inside = model.omega[near] < 2.0 * np.pi * record.frequency[-1] * 1.02
        visible = near[chosen & inside]
    if len(visible) == 0:
        return None
    typical = np.sqrt(np.mean(np.abs(measured) ** 2, axis=-1, keepdims=True))
    weights = 1.0 / np.sqrt(
        noise[:, None] ** 2 / len(record.lines)
        + (MODEL_ERROR * _smooth(np.abs(measured))) ** 2
        + (LEAK * typical) ** 2
        + 1.0e-300
    )
    delay, lag, start = np.zeros(len(measured)), None, np.zeros(len(visible)) if fixed else None
    found = None
    # modes that the model does not excite, and delays, are seen once the others are fitted
    for _ in range(3):
        drive = model.drive_shapes[visible].copy()
        drive[~driven_modes(model, visible), 0] = 1.0
        rest = _rest(record, model, visible, kinds)
        strict, more = _seen(model, visible, True), _seen(model, visible, False)

        def lines_at(delay, rest=rest, visible=visible, drive=drive):
            return ModalLines(
                record,
                _turned_back(measured, record, delay) - rest,
                weights,
                model,
                visible,
                drive,
                kinds,
            )

        # a delayed channel would bias the fit of all: first with a phase for every participation
        if not fixed and lag is None:
            start = (
                _elsewhere(record, lines_at(delay).measured, weights, model, visible, kinds)
                if elsewhere
                else None
            )
            lag, start = _lags(lines_at, delay, strict, noise, model, start)
            delay = _significant(lag)
        lines = lines_at(delay)
        known = lines.fit(strict, noise, delay, start)
        begun = [(known.log_frequency, known.log_damping)]
        if not fixed or lines.explains_more(known, strict, more):
            # in a structure less symmetric than the model, channels see more modes: they are fitted
            # from the start, and from the frequencies found
            begun = [start, *begun]
        before, found = (
            found,
            min((lines.fit(more, noise, delay, one) for one in begun), key=_implausible),
        )
        if fixed:
            break
        if before is not None and left(found, model) >= LOST > left(before, model):
            # the phases of a hardly driven mode are not determined, and give false delays
            found = before
            break
        # modes that the model excites and that are not in the record
        nothing = np.abs(found.log_damping) > 0.98 * LARGEST_LOG_DAMPING
        if nothing.any() and not nothing.all():
            lag, start, visible = None, None, visible[~nothing]
            continue
        extra = _unexpected(
            record, _turned_back(measured, record, delay), found, weights, drive, model, near, kinds
        )
        if not len(extra):
            break
        lag, start, visible = None, None, np.sort(np.concatenate([visible, extra]))
    return found


def _turned_back(measured, record, delay):
    """Return (channel, line) measured lines without delays (channel,) s; on a moving base, what is
    delayed is the absolute motion.
    """
    turn = np.exp(2j * np.pi * record.frequency * delay[:, None])
    if record.base is None:
        return measured * turn
    return (measured + record.base) * turn - record.base


def _lags(lines_at, delay, seen, noise, model, start):
    """Return ((channel,) s by which channels lag, ln frequency (fitted,)) of a fit with a phase for
    every participation; lines_at(delay): ModalLines with delays compensated; delay: the one known
    so far, which is returned where the fit is bad.

    A phase for each mode does not represent a delay of milliseconds between resonances. Such a
    delay is first found from the phases of all lines, and compensated.
    """
    lines = lines_at(delay)
    first = free = lines.fit(seen, noise, delay, start, phases=True)
    if left(free, model) >= LOST:
        before, delay = delay, from_phases(lines_at(np.zeros_like(delay)), noise)
        if delay.any():
            free = lines_at(delay).fit(seen, noise, delay, start, phases=True)
        if left(free, model) >= LOST:
            return before, first.log_frequency
    # a base drives few modes, and a change of the structure may reverse the sign of one of them
    more, error = lags(free, model, lines.record.base is None)
    lag = delay + more
    return np.where(np.abs(lag) > SURE * error, lag, 0.0), free.log_frequency


def _significant(lag):
    """Return (channel,) s the delays, 0 where they are not larger than LEAST_LAG_S."""
    return np.where(np.abs(lag) > LEAST_LAG_S, lag, 0.0)


def _elsewhere(record, measured, weights, model, visible, kinds):
    """Return (visible,) ln of the frequencies at which the record has its strongest resonances over
    those of the model.
    """
    zeta = np.median(model.damping[visible] / (2.0 * model.omega[visible]))
    return assigned(*pursued(record, measured, weights, len(visible), zeta, kinds), model, visible)


def left(found: ModalFit, model: ModalModel) -> float:
    """Return the largest residual over noise of a ModalFit among the channels that the force drives
    in the model; among all where it drives none by these modes.
    """
    driven = np.abs(as_displacements(model)[found.modes].T) @ np.abs(
        model.drive_shapes[found.modes]
    ).max(axis=1)
    return found.residual[driven >= 1.0e-3 * driven.max()].max()


def _fitted(record, found, drive, model, kinds):
    """Return (channel, line) the response of the fitted modes alone."""
    omega = model.omega[found.modes] * np.exp(found.log_frequency)
    zeta = model.damping[found.modes] / (2.0 * model.omega[found.modes]) * np.exp(found.log_damping)
    basis = responses_of(record, omega, 2.0 * zeta * omega, drive, kinds)
    return combined(found.participation, basis, kinds)


def modelled_lines(
    record: LinearRecord, model: ModalModel, found: ModalFit, kind: str
) -> np.ndarray:
    """Return (channel, line): the response of a ModalModel with its own shapes and, for the fitted
    modes, the frequencies and damping of a ModalFit; kind: of all its sensors.
    """
    own = replace(found, participation=model.sensor_shapes[found.modes].T)
    kinds = np.full(model.sensor_shapes.shape[1], kind)
    return _fitted(record, own, found.drive, model, kinds) + _rest(
        record, model, found.modes, kinds
    )


def unexplained_lines(
    record: LinearRecord,
    responses: np.ndarray,
    model: ModalModel,
    found: ModalFit,
    kinds: Sequence[str] | np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return (measured, residual), each (channel, line): the lines of responses (channel, sample)
    of kinds (channel,), and the residual of a ModalFit of them; of a contact force, all of it.
    """
    kinds = np.where(of_modes(kinds), kinds, "displacement")
    measured = _turned_back(record.spectra(np.asarray(responses, float)), record, found.delay)
    fitted = _fitted(record, found, found.drive, model, kinds)
    return measured, measured - fitted - _rest(record, model, found.modes, kinds)


def _implausible(found):
    """Return a cost of a ModalFit: its residual, and the distance of its damping from the model's.
    The damping of a mode that is not in the record ends at a limit.
    """
    return np.sum(found.residual**2) + np.sum((found.log_damping / LARGEST_LOG_DAMPING) ** 2)


def _seen(model, modes, strict):
    """Return (channel, mode) bool: whether a channel may see a mode: where it does in the model; if
    not strict, also where it sees no close mode.

    Of two close modes, one along and one across a channel, the fit would take any mixture.
    """
    own = np.abs(as_displacements(model)[modes].T)
    shown, logs = own > SILENT * own.max(axis=0), np.log(model.omega[modes])
    close = np.abs(logs[:, None] - logs) < BESIDE
    return shown if strict else shown | ~(shown.astype(int) @ close.astype(int) > 0)


def _unexpected(record, measured, found, weights, drive, model, near, kinds):
    """Return the modes that the model does not excite visibly but that are in the record."""
    residual = (
        measured
        - _fitted(record, found, drive, model, kinds)
        - _rest(record, model, found.modes, kinds)
    )
    residual = without_base(residual, record, weights)
    size, extra = np.abs(as_displacements(model)), []
    for mode in np.setdiff1d(near, found.modes):
        if model.omega[mode] > 2.0 * np.pi * record.frequency[-1]:
            continue
        drive = np.eye(1, model.drive_shapes.shape[1])
        basis = responses_of(record, model.omega[[mode]], model.damping[[mode]], drive, kinds)
        gain = 0.0
        for channel in np.flatnonzero(size[mode] > 1.0e-6 * size.max()):
            y, b = weights[channel] * residual[channel], weights[channel] * basis[kinds[channel]][0]
            gain += np.vdot(b, y).real ** 2 / np.vdot(b, b).real
        if gain > UNEXPECTED and not _covered(model, mode, found):
            extra.append(mode)
    return np.array(extra, int)


def _covered(model, mode, found):
    """Return True where a fitted mode has nearly the shape and frequency of another mode: what that
    would explain is the residual of the fitted one.
    """
    shapes = as_displacements(model)
    shape = shapes[mode]
    for other in found.modes:
        against = shapes[other]
        alike = (shape @ against) ** 2 / max((shape @ shape) * (against @ against), 1.0e-300)
        if alike > 0.5 and abs(np.log(model.omega[mode] / model.omega[other])) < 0.2:
            return True
    return False


def _rest(record, model, visible, kinds):
    """Return (channel, line): the response of the modes that are not fitted, of those far above the
    band the static response.
    """
    others = np.setdiff1d(np.flatnonzero(model.omega > 0.0), visible)
    reach = record.omega <= 2.2 * np.pi * record.frequency[-1]
    omega, force = record.omega[reach], record.spectrum[:, reach]
    lines = np.zeros((model.sensor_shapes.shape[1], record.omega.size), complex)
    for first in range(0, len(others), AT_ONCE):
        part = others[first : first + AT_ONCE]
        transfer = 1.0 / (
            model.omega[part, None] ** 2 - omega**2 + 1j * model.damping[part, None] * omega
        )
        lines[:, reach] += model.sensor_shapes[part].T @ (
            transfer * (model.drive_shapes[part] @ force)
        )
    for kind, own in kind_groups(kinds).items():
        lines[own] *= differentiated(record.omega, kind)
    return record.short_spectra(lines)


def _smooth(values, width=21):
    """Return the running mean over the last axis."""
    kernel = np.ones(width) / width
    return np.apply_along_axis(
        lambda row: np.convolve(np.pad(row, width // 2, mode="edge"), kernel, mode="valid"),
        -1,
        values,
    )
