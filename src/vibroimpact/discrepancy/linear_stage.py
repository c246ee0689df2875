"""Modal parameters of a low-level record: frequencies, damping and participations fitted to its waveform, run from rest to its end.

The same fit reads the measured and a simulated record, so that what it can not do it does to both. Variable projection: the participations
are linear and solved for at each step (G.H. Golub, V. Pereyra, SIAM J. Numer. Anal. 10, 1973); frequencies and damping by Gauss-Newton.
"""

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from vibroimpact.discrepancy.lags import driven_modes, lags
from vibroimpact.discrepancy.pursuit import assigned, pursued

ITERATIONS = 12  # of Gauss-Newton at most
MODEL_ERROR = 3.0e-3  # of the response at a line, beside the noise: keeps the weights of strong lines finite
LEAK = 2.0e-3  # of the typical line: what the ends of a record and modes far above the band leave in every line
RESIDUAL_SHARE = 0.01  # of a channel's response that two codes may differ by, beside the noise
VISIBLE = 3.0  # times the noise in the band: below it a mode is not fitted
LARGEST_LOG_DAMPING = 3.0
IDLE = 1.0e-9  # of the change with the logarithm that changes most
STEP_LIMIT = 0.02  # of ln frequency in one iteration
UNEXPECTED = 60.0  # chi-square that a mode which the model does not excite must explain
LEAST_LAG_S = 2.0e-5
SILENT = 1.0e-4  # of a mode's largest displacement among the channels: below it a channel does not see the mode in the model
BESIDE = 0.03  # of ln frequency: modes nearer than this are ill told apart in a channel
LOST = 6.0  # times the noise: a fit that leaves more in a channel began at the wrong frequencies
SEARCH = 0.02  # of the frequency, to either side, in steps of half the bandwidth: where the fit starts


@dataclass(frozen=True)
class ModalFit:
    """What the fit of one record found.

    modes (fitted,) indices into the model's; log_frequency, log_damping (fitted,): ln of the fitted over the model's value;
    participation (channel, fitted): response per unit modal response to the force on `drive` (fitted, force_channel); covariance of
    [log_frequency, log_damping] (2 fitted, 2 fitted); delay (channel,) s by which a channel lags the others' fit, 0 where it is not to be told from none;
    residual (channel,): RMS of what is left over that of the noise and of RESIDUAL_SHARE of the response, in the band; share (channel,): residual over response, RMS.
    """

    modes: np.ndarray
    drive: np.ndarray
    log_frequency: np.ndarray
    log_damping: np.ndarray
    participation: np.ndarray
    covariance: np.ndarray
    delay: np.ndarray
    residual: np.ndarray
    share: np.ndarray


def fit_modes(record, responses, model, kinds, noise_rms, visible=None, search=True):
    """Return the ModalFit of responses (channel, sample) to the force of a LinearRecord.

    model: ModalModel attached to the campaign; kinds (channel,), all of one kind; noise_rms (channel,) in the band. visible: the modes to fit, as another fit had
    them; chosen by their predicted share where it is None; search: where the model's frequencies lead nowhere, look for resonances without it. Returns None
    where no mode is visible.
    """
    found = _fit(record, responses, model, kinds, noise_rms, visible)
    if found is None or visible is not None or not search or left(found, model) < LOST:
        return found
    return min(found, _fit(record, responses, model, kinds, noise_rms, visible, True), key=lambda fit: left(fit, model))


def _fit(record, responses, model, kinds, noise_rms, visible, elsewhere=False):
    """Return the ModalFit from the model's frequencies, or from where the resonances are found without it."""
    kind = "acceleration" if kinds[0] == "acceleration" else "displacement"
    measured = record.spectra(np.asarray(responses, float))
    near = np.flatnonzero((model.omega > 0.0) & (model.omega < 1.3 * 2.0 * np.pi * record.frequency[-1]))
    expected = record.responses(model.omega[near], model.damping[near], model.drive_shapes[near], kind)
    size = np.sqrt(np.sum(np.abs(expected) ** 2, axis=-1))
    noise = np.maximum(noise_rms, 1.0e-12)
    fixed = visible is not None
    if not fixed:
        chosen = ((np.abs(model.sensor_shapes[near]) * size[:, None]) > VISIBLE * noise).any(axis=1)
        inside = model.omega[near] < 2.0 * np.pi * record.frequency[-1] * 1.02
        visible = near[chosen & inside]
    if len(visible) == 0:
        return None
    typical = np.sqrt(np.mean(np.abs(measured) ** 2, axis=-1, keepdims=True))
    weights = 1.0 / np.sqrt(noise[:, None] ** 2 / len(record.lines) + (MODEL_ERROR * _smooth(np.abs(measured))) ** 2 + (LEAK * typical) ** 2 + 1.0e-300)
    delay, lag, start = np.zeros(len(measured)), None, np.zeros(len(visible)) if fixed else None
    for _ in range(3):  # modes that the model does not excite, and delays, are seen once the rest is taken out
        drive = model.drive_shapes[visible].copy()
        drive[~driven_modes(model, visible), 0] = 1.0
        turned = measured * np.exp(2j * np.pi * record.frequency * delay[:, None])
        rest = _rest(record, model, visible, kind)
        if not fixed and lag is None:  # a late channel would pull the fit of all: first with a phase for every participation
            start = _elsewhere(record, turned - rest, weights, model, visible, kind) if elsewhere else None
            free = _gauss_newton(record, turned - rest, weights, model, visible, drive, kind, noise, delay, start, True)
            lag, start = lags(free, model) if left(free, model) < LOST else np.zeros(len(measured)), free.log_frequency
            delay = np.where(np.abs(lag) > LEAST_LAG_S, lag, 0.0)
            turned = measured * np.exp(2j * np.pi * record.frequency * delay[:, None])
        # what breaks a symmetry lets a channel see modes that it does not in the model: looked at from the beginning, and once the modes are where they are
        known = _gauss_newton(record, turned - rest, weights, model, visible, drive, kind, noise, delay, start)
        found = min((_gauss_newton(record, turned - rest, weights, model, visible, drive, kind, noise, delay, begun, strict=False)
                     for begun in (start, (known.log_frequency, known.log_damping))), key=_implausible)  # fmt: skip
        if fixed:
            break
        nothing = np.abs(found.log_damping) > 0.98 * LARGEST_LOG_DAMPING  # modes that the model excites and the record does not hold
        if nothing.any() and not nothing.all():
            lag, start, visible = None, None, visible[~nothing]
            continue
        extra = _unexpected(record, turned, found, weights, drive, model, near, kind)
        if not len(extra):
            break
        lag, start, visible = None, None, np.sort(np.concatenate([visible, extra]))
    return found


def _elsewhere(record, measured, weights, model, visible, kind):
    """Return (visible,) ln of the frequencies at which the record has its strongest resonances over those of the model."""
    zeta = np.median(model.damping[visible] / (2.0 * model.omega[visible]))
    return assigned(*pursued(record, measured, weights, len(visible), zeta, kind), model, visible)


def left(found, model):
    """Return the largest residual over noise of a ModalFit among the channels that the force drives in the model."""
    driven = np.abs(model.sensor_shapes[found.modes].T) @ np.abs(model.drive_shapes[found.modes]).max(axis=1)
    return found.residual[driven > 1.0e-3 * driven.max()].max()


def _fitted(record, found, drive, model, kind):
    """Return (channel, line) the response that a fit gives, without what the other modes add."""
    omega = model.omega[found.modes] * np.exp(found.log_frequency)
    zeta = model.damping[found.modes] / (2.0 * model.omega[found.modes]) * np.exp(found.log_damping)
    return found.participation @ record.responses(omega, 2.0 * zeta * omega, drive, kind)


def _implausible(found):
    """Return what a ModalFit leaves, and how far its damping is from the model's: a mode fitted to nothing ends at a limit."""
    return np.sum(found.residual**2) + np.sum((found.log_damping / LARGEST_LOG_DAMPING) ** 2)


def _seen(model, modes, strict):
    """Return (channel, mode) bool: whether a channel may see a mode: where it does in the model; if not strict, also where no mode beside it is seen there.

    Of two modes side by side, one along and one across, a channel would take any mixture.
    """
    own = np.abs(model.sensor_shapes[modes].T)
    shown, logs = own > SILENT * own.max(axis=0), np.log(model.omega[modes])
    beside = np.abs(logs[:, None] - logs) < BESIDE
    return shown if strict else shown | ~(shown.astype(int) @ beside.astype(int) > 0)


def _unexpected(record, measured, found, weights, drive, model, near, kind):
    """Return the modes that the model does not excite visibly but the record holds."""
    residual = measured - _fitted(record, found, drive, model, kind) - _rest(record, model, found.modes, kind)
    extra = []
    for mode in np.setdiff1d(near, found.modes):
        if model.omega[mode] > 2.0 * np.pi * record.frequency[-1]:
            continue
        basis = record.responses(model.omega[[mode]], model.damping[[mode]], np.eye(1, model.drive_shapes.shape[1]), kind)[0]
        gain = 0.0
        for channel in np.flatnonzero(np.abs(model.sensor_shapes[mode]) > 1.0e-6 * np.abs(model.sensor_shapes).max()):
            y, b = _real(weights[channel] * residual[channel]), _real(weights[channel] * basis)
            gain += (y @ b) ** 2 / (b @ b)
        if gain > UNEXPECTED and not _covered(model, mode, found):
            extra.append(mode)
    return np.array(extra, int)


def _covered(model, mode, found):
    """True where the fitted modes have the shape and place of another one: its remainder is theirs."""
    shape = model.sensor_shapes[mode]
    for other in found.modes:
        against = model.sensor_shapes[other]
        alike = (shape @ against) ** 2 / max((shape @ shape) * (against @ against), 1.0e-300)
        if alike > 0.5 and abs(np.log(model.omega[mode] / model.omega[other])) < 0.2:
            return True
    return False


def _rest(record, model, visible, kind):
    """Return (channel, line): what the modes that are not fitted add, those far above the band as their static response."""
    others = np.setdiff1d(np.flatnonzero(model.omega > 0.0), visible)
    transfer = np.zeros((model.sensor_shapes.shape[1], model.drive_shapes.shape[1], record.omega.size), complex)
    reach = record.omega <= 2.2 * np.pi * record.frequency[-1]
    omega = record.omega[reach]
    for mode in others:
        h = 1.0 / (model.omega[mode] ** 2 - omega**2 + 1j * model.damping[mode] * omega)
        transfer[:, :, reach] += np.einsum("c,f,l->cfl", model.sensor_shapes[mode], model.drive_shapes[mode], h)
    if kind == "acceleration":
        transfer *= -(record.omega**2)
    return record.short_spectra(np.einsum("cfl,fl->cl", transfer, record.spectrum))


def _gauss_newton(record, measured, weights, model, visible, drive, kind, noise, delay, start=None, phases=False, strict=True):
    """Return the ModalFit (participations complex where `phases`), from the frequency at which each mode's own resonance fits best."""
    count = len(visible)
    omega, zeta = model.omega[visible], model.damping[visible] / (2.0 * model.omega[visible])
    logs = np.zeros(2 * count)
    if isinstance(start, tuple):
        logs = np.concatenate(start)
    else:
        logs[:count] = start if start is not None else _start(record, measured, weights, visible, drive, omega, zeta, kind)
    weighted = weights * measured

    def columns(values, chosen=slice(None)):
        w = (omega * np.exp(values[:count]))[chosen]
        return record.responses(w, 2.0 * (zeta * np.exp(values[count:]))[chosen] * w, drive[chosen], kind)

    seen = _seen(model, visible, strict)

    def solve(basis):
        shapes = np.zeros(seen.shape, complex if phases else float)
        for c in np.flatnonzero(seen.any(axis=1)):
            rows, target = (weights[c] * basis[seen[c]]).T, weights[c] * measured[c]
            shapes[c, seen[c]] = linalg.lstsq(rows, target)[0] if phases else linalg.lstsq(_real(rows.T).T, _real(target))[0]
        return shapes

    best, best_cost, damp = None, np.inf, 1.0e-3
    for _ in range(ITERATIONS):
        basis = columns(logs)
        shapes = solve(basis)
        residual = weighted - weights * (shapes @ basis)
        cost = np.sum(np.abs(residual) ** 2)
        if cost < best_cost:
            converged = best is not None and best_cost - cost < 1.0e-6 * cost
            best, best_cost, damp = (logs.copy(), shapes, basis, residual), cost, max(0.2 * damp, 1.0e-9)
            if converged:
                break
        else:
            damp *= 20.0
            if damp > 1.0e3:
                break
        jacobian = _jacobian(weights, columns, best, seen)
        length = np.linalg.norm(jacobian, axis=0)
        length = np.where(length > IDLE * length.max(), length, np.inf)  # a mode that takes no part stays where it is, and spoils no equation
        jacobian /= length
        step = linalg.solve(jacobian.T @ jacobian + damp * np.eye(2 * count), jacobian.T @ _real(best[3]).ravel(), assume_a="pos") / length
        logs = best[0] + step * min(1.0, STEP_LIMIT / max(np.abs(step[:count]).max(), 1.0e-30))
        logs[count:] = np.clip(logs[count:], -LARGEST_LOG_DAMPING, LARGEST_LOG_DAMPING)
    return _result(best, weights, visible, drive, noise, columns, measured, delay, seen)


def _jacobian(weights, columns, best, seen):
    """Return (2 channel line, 2 fitted): the weighted change of the fit with each logarithm, without what the participations would take up.

    The simplification of L. Kaufman (BIT 15, 1975): the change of the basis, projected out of the basis, channel by channel.
    """
    logs, shapes, basis, _ = best
    count, channels = len(logs) // 2, len(shapes)
    jacobian = np.zeros((channels, 2 * basis.shape[1], 2 * count))
    for number in range(2 * count):
        moved = logs.copy()
        step = 1.0e-5 if number < count else 1.0e-3
        moved[number] += step
        mode = number % count
        change = (columns(moved, [mode])[0] - basis[mode]) / step
        jacobian[:, :, number] = _real(weights * np.outer(shapes[:, mode], change))
    for channel in range(channels):
        known = weights[channel] * basis[seen[channel]]
        columns_of = [_real(known)] + [_real(1j * known)] * np.iscomplexobj(shapes)
        span, _ = np.linalg.qr(np.vstack(columns_of).T)
        jacobian[channel] -= span @ (span.T @ jacobian[channel])
    return jacobian.reshape(-1, 2 * count)


def _result(best, weights, visible, drive, noise, columns, measured, delay, seen):
    logs, shapes, _, residual = best
    count = len(visible)
    jacobian = _jacobian(weights, columns, best, seen)
    covariance = linalg.pinvh(jacobian.T @ jacobian) * max(1.0, np.mean(np.abs(residual) ** 2))
    power = np.sqrt(np.sum(np.abs(residual / weights) ** 2, axis=-1))
    total = np.sqrt(np.sum(np.abs(measured) ** 2, axis=-1))
    return ModalFit(visible, drive, logs[:count], logs[count:], shapes, covariance, delay, power / np.hypot(noise, RESIDUAL_SHARE * total), power / np.maximum(total, 1.0e-300))


def _start(record, measured, weights, visible, drive, omega, zeta, kind):
    """Return (fitted,) ln of the frequency at which the mode alone explains most near its resonance, within SEARCH."""
    out = np.zeros(len(visible))
    for number in range(len(visible)):
        near = np.abs(record.frequency - omega[number] / (2.0 * np.pi)) < SEARCH * 1.5 * omega[number] / (2.0 * np.pi) + 0.5
        if near.sum() < 10:
            continue
        grid = np.arange(-SEARCH, SEARCH + 1.0e-9, max(zeta[number], SEARCH / 40.0))
        w = omega[number] * np.exp(grid)
        basis = record.responses(w, 2.0 * zeta[number] * w, np.repeat(drive[number][None], len(w), axis=0), kind)[:, near]
        explained = np.zeros(len(grid))
        for c in range(len(measured)):
            y, b = weights[c, near] * measured[c, near], weights[c, near] * basis
            explained += np.real(b.conj() @ y) ** 2 / np.maximum(np.sum(np.abs(b) ** 2, axis=-1), 1.0e-300)
        prior = -0.5 * (grid / 0.006) ** 2 * 0.02 * explained.max()  # between equals the one near the model
        out[number] = grid[np.argmax(explained + prior)]
    return out


def _smooth(values, width=21):
    """Running mean over the last axis."""
    kernel = np.ones(width) / width
    return np.apply_along_axis(lambda row: np.convolve(np.pad(row, width // 2, mode="edge"), kernel, mode="valid"), -1, values)


def _real(values):
    """Complex (..., n) as real (..., 2 n)."""
    return np.concatenate([values.real, values.imag], axis=-1)
