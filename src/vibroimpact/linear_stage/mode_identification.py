"""Modal parameters of a low-level record: frequencies, damping and participations fitted to its
waveform, run from rest to its end.

The same fit reads the measured and a simulated record, so that what it can not do it does to both:
which modes, from where, and by which participations; see modal_fit for a fit itself.
"""

from dataclasses import replace

import numpy as np

from vibroimpact.observation.sensed_motion import differentiated, kind_groups, of_modes, orders
from vibroimpact.observation.strain import STRAIN, as_displacements, gauges_of

from .lags import driven_modes, from_phases, lags
from .matching_pursuit import assigned, pursued
from .modal_fit import LARGEST_LOG_DAMPING, ModalLines, combined, responses_of, without_base

MODEL_ERROR = (
    3.0e-3  # of the response at a line, beside the noise: keeps the weights of strong lines finite
)
# of the typical line: what the ends of a record and modes far above the band leave in every line
LEAK = 2.0e-3
# of the largest response, read as the same kind of motion: what a converter of 20 bits makes of a
# channel that does not move
RESOLVED = 1.0e-6
VISIBLE = 3.0  # times the noise in the band: below it a mode is not fitted
UNEXPECTED = 60.0  # chi-square that a mode which the model does not excite must explain
LEAST_LAG_S = 2.0e-5
# of a mode's largest displacement among the channels: below it a channel does not see the mode in
# the model
SILENT = 1.0e-4
BESIDE = 0.03  # of ln frequency: modes nearer than this are ill told apart in a channel
# of the mode that a base drives most: a base drives the others by what is left of a sum over the
# whole structure that all but cancels, of which no model tells the rest
HARDLY = 0.02
AT_ONCE = 32  # modes, so that their lines fit into little memory
LOST = 6.0  # times the noise: a fit that leaves more in a channel began at the wrong frequencies


def fit_modes(record, responses, model, kinds, noise_rms, visible=None, search=True):
    """Return the ModalFit of responses (channel, sample) to the force of a LinearRecord.

    model: ModalModel attached to the campaign; kinds (channel,), see sensed.SENSED; noise_rms
    (channel,) in the band. visible: the modes to fit, as another fit had them; chosen by their
    predicted share where it is None; search: where the model's frequencies lead nowhere, look for
    resonances without it. Contact forces take no part: participation, delay and
    share are 0 and the residual is 1, that of noise. Returns None where no mode is visible.
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
    """Return (channel,): the largest RMS of measured (channel, line) among all channels, read as
    motion of its kind; of a strain among the strains.
    """
    order, gauges = orders(kinds), np.asarray(kinds) == STRAIN
    omega = 2.0 * np.pi * np.maximum(record.frequency, record.frequency[record.frequency > 0].min())
    power = [
        np.sum(np.abs(measured) ** 2 * omega ** (2.0 * (own - order[:, None])), axis=-1)
        * (gauges == gauge)
        for own, gauge in zip(order, gauges, strict=True)
    ]
    return np.sqrt(np.max(power, axis=-1))


def with_sensors(model, chosen):
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
    """Return a ModalFit of the channels that measure a motion, moves (channel,), as one of all."""

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
    """Return the ModalFit from the model's frequencies, or from where the resonances are found
    without it.
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
    for _ in range(
        3
    ):  # modes that the model does not excite, and delays, are seen once the rest is taken out
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

        if (
            not fixed and lag is None
        ):  # a late channel would pull the fit of all: first with a phase for every participation
            start = (
                _elsewhere(record, lines_at(delay).measured, weights, model, visible, kinds)
                if elsewhere
                else None
            )
            lag, start = _lags(lines_at, delay, strict, noise, model, start)
            delay = _told(lag)
        lines = lines_at(delay)
        known = lines.fit(strict, noise, delay, start)
        begun = [(known.log_frequency, known.log_damping)]
        if not fixed or lines.explains_more(known, strict, more):
            # what breaks a symmetry lets a channel see modes that it does not in the model: looked
            # at from the beginning, and once the modes are where they are
            begun = [start, *begun]
        before, found = (
            found,
            min((lines.fit(more, noise, delay, one) for one in begun), key=_implausible),
        )
        if fixed:
            break
        if before is not None and left(found, model) >= LOST > left(before, model):
            # of a mode that is hardly driven, phases are not told, and make channels late
            found = before
            break
        nothing = (
            np.abs(found.log_damping) > 0.98 * LARGEST_LOG_DAMPING
        )  # modes that the model excites and the record does not hold
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
    """Return (channel, line) measured lines without delays (channel,) s; what is late is the
    absolute motion of a structure on a moving base.
    """
    turn = np.exp(2j * np.pi * record.frequency * delay[:, None])
    if record.base is None:
        return measured * turn
    return (measured + record.base) * turn - record.base


def _lags(lines_at, delay, seen, noise, model, start):
    """Return ((channel,) s by which channels lag, ln frequency (fitted,)) of a fit with a phase for
    every participation; lines_at(delay) -> ModalLines with channels turned back; delay: what is
    known so far, and is returned where the fit leads nowhere.

    Between its resonances no phase of each mode stands for milliseconds: a channel so late spoils
    the fit, and is turned back by what its lines tell first.
    """
    lines = lines_at(delay)
    first = free = lines.fit(seen, noise, delay, start, phases=True)
    if left(free, model) >= LOST:
        before, delay = delay, from_phases(lines_at(np.zeros_like(delay)), noise)
        if delay.any():
            free = lines_at(delay).fit(seen, noise, delay, start, phases=True)
        if left(free, model) >= LOST:
            return before, first.log_frequency
    # a base drives few modes, and a change of the structure turns the sense of one of them
    return delay + lags(free, model, lines.record.base is None), free.log_frequency


def _told(lag):
    """Return (channel,) s the delays that can be told from none."""
    return np.where(np.abs(lag) > LEAST_LAG_S, lag, 0.0)


def _elsewhere(record, measured, weights, model, visible, kinds):
    """Return (visible,) ln of the frequencies at which the record has its strongest resonances over
    those of the model.
    """
    zeta = np.median(model.damping[visible] / (2.0 * model.omega[visible]))
    return assigned(*pursued(record, measured, weights, len(visible), zeta, kinds), model, visible)


def left(found, model):
    """Return the largest residual over noise of a ModalFit among the channels that the force drives
    in the model.
    """
    driven = np.abs(as_displacements(model)[found.modes].T) @ np.abs(
        model.drive_shapes[found.modes]
    ).max(axis=1)
    return found.residual[driven > 1.0e-3 * driven.max()].max()


def _fitted(record, found, drive, model, kinds):
    """Return (channel, line) the response that a fit gives, without what the other modes add."""
    omega = model.omega[found.modes] * np.exp(found.log_frequency)
    zeta = model.damping[found.modes] / (2.0 * model.omega[found.modes]) * np.exp(found.log_damping)
    basis = responses_of(record, omega, 2.0 * zeta * omega, drive, kinds)
    return combined(found.participation, basis, kinds)


def modelled_lines(record, model, found, kind):
    """Return (channel, line): the response of a ModalModel whose fitted modes have the frequencies
    and damping of a ModalFit, and its own shapes; kind: of all its sensors.
    """
    own = replace(found, participation=model.sensor_shapes[found.modes].T)
    kinds = np.full(model.sensor_shapes.shape[1], kind)
    return _fitted(record, own, found.drive, model, kinds) + _rest(
        record, model, found.modes, kinds
    )


def unexplained_lines(record, responses, model, found, kinds):
    """Return (measured, rest), each (channel, line): the lines of responses (channel, sample) of
    kinds (channel,), and what a ModalFit of them leaves; NaN of what measures no motion.
    """
    kinds = np.where(of_modes(kinds), kinds, "displacement")
    measured = _turned_back(record.spectra(np.asarray(responses, float)), record, found.delay)
    fitted = _fitted(record, found, found.drive, model, kinds)
    return measured, measured - fitted - _rest(record, model, found.modes, kinds)


def _implausible(found):
    """Return what a ModalFit leaves, and how far its damping is from the model's: a mode fitted to
    nothing ends at a limit.
    """
    return np.sum(found.residual**2) + np.sum((found.log_damping / LARGEST_LOG_DAMPING) ** 2)


def _seen(model, modes, strict):
    """Return (channel, mode) bool: whether a channel may see a mode: where it does in the model; if
    not strict, also where no mode beside it is seen there.

    Of two modes side by side, one along and one across, a channel would take any mixture.
    """
    own = np.abs(as_displacements(model)[modes].T)
    shown, logs = own > SILENT * own.max(axis=0), np.log(model.omega[modes])
    beside = np.abs(logs[:, None] - logs) < BESIDE
    return shown if strict else shown | ~(shown.astype(int) @ beside.astype(int) > 0)


def _unexpected(record, measured, found, weights, drive, model, near, kinds):
    """Return the modes that the model does not excite visibly but the record holds."""
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
    """True where the fitted modes have the shape and place of another one: its remainder is
    theirs.
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
    """Return (channel, line): what the modes that are not fitted add, those far above the band as
    their static response.
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
    """Running mean over the last axis."""
    kernel = np.ones(width) / width
    return np.apply_along_axis(
        lambda row: np.convolve(np.pad(row, width // 2, mode="edge"), kernel, mode="valid"),
        -1,
        values,
    )
