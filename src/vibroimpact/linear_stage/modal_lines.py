"""One fit of modes to the Fourier lines of a record: frequencies and damping by Gauss-Newton,
participations, which are linear, solved for at each step. mode_identification says which modes.

Variable projection: G.H. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413-432.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import linalg

from vibroimpact.observation.linear_record import LinearRecord
from vibroimpact.reduction.modal_model import ModalModel

from .channel_responses import combined, responses_of, without_base
from .modal_fit import ModalFit

ITERATIONS = 12  # of Gauss-Newton at most
RESIDUAL_SHARE = 0.01  # of a channel's response by which two codes may differ, besides the noise
LARGEST_LOG_DAMPING = 3.0
IDLE = 1.0e-9  # of the largest slope: a logarithm of less is not fitted
STEP_LIMIT = 0.02  # of ln frequency in one iteration
# of the largest mode in a channel: a mode that differs from the others by less is not separated
SINGULAR = 1.0e-9
# One standard deviation of a participation about the model's, in those of its channel: of two modes
# at one frequency the lines tell the sum alone
PARTICIPATION_SD = 3.0
SETTLED = 1.0e-6  # of the residual: a step that promises to reduce it by less is not taken
# of the frequency, to either side, in steps of half the bandwidth: where the start is searched
SEARCH = 0.02

Start = tuple[np.ndarray, np.ndarray] | np.ndarray | None  # see ModalLines.fit


class ModalLines:
    """The lines of a record to which modes are fitted.

    measured, weights: (channel, line). modes (fitted,): indices of the model's modes that are
    fitted. drive (fitted, force_channel). kinds (channel,): of motion or strain.

    Participations are known a priori to be near the model's: each is one line more, beside the
    lines of the record. expected (channel, fitted): their most probable values; inverse_sd
    (channel, 1): one over their standard deviation.

    From a channel with an error of its gain the motion of the base is subtracted with the same
    error. So besides the modes each channel may contain any amount of it (LinearRecord.base).
    """

    def __init__(
        self,
        record: LinearRecord,
        measured: np.ndarray,
        weights: np.ndarray,
        model: ModalModel,
        modes: np.ndarray,
        drive: np.ndarray,
        kinds: Sequence[str] | np.ndarray,
    ) -> None:
        self.record, self.measured, self.weights, self.modes, self.drive, self.kinds = (
            record,
            measured,
            weights,
            modes,
            drive,
            np.asarray(kinds),
        )
        self.omega, self.zeta, self.count = (
            model.omega[modes],
            model.damping[modes] / (2.0 * model.omega[modes]),
            len(modes),
        )
        self.expected = self._expected(model.sensor_shapes[modes].T)
        largest = np.abs(self.expected).max(axis=1, keepdims=True)
        # nothing is known of a channel that the model says is still
        self.inverse_sd = np.divide(
            1.0 / PARTICIPATION_SD, largest, out=np.zeros_like(largest), where=largest > 0.0
        )

    def fit(
        self,
        seen: np.ndarray,
        noise: np.ndarray,
        delay: np.ndarray,
        start: Start = None,
        phases: bool = False,
    ) -> ModalFit:
        """Return the ModalFit (participations complex where `phases`).

        seen (channel, fitted) bool: the participations that are fitted, the others are 0; noise,
        delay (channel,): see ModalFit; start: (log_frequency, log_damping) to begin from, or
        log_frequency alone, or None: the frequency at which each mode's own resonance fits best.
        """
        logs = np.zeros(2 * self.count)
        if isinstance(start, tuple):
            logs = np.concatenate(start)
        else:
            logs[: self.count] = start if start is not None else self._start()
        best, best_cost, damp = None, np.inf, 1.0e-3
        for _ in range(ITERATIONS):
            basis = self._basis(logs)
            shapes = self._participations(basis, seen, phases)
            residual = self._left(shapes, basis)
            cost = np.sum(np.abs(residual) ** 2)
            if cost < best_cost:
                converged = best is not None and best_cost - cost < SETTLED * cost
                best, best_cost, damp = (
                    (logs.copy(), shapes, basis, residual),
                    cost,
                    max(0.2 * damp, 1.0e-9),
                )
                slopes, shape_slopes = self._slopes(best, seen)
                if converged:
                    break
            else:
                damp *= 20.0
                if damp > 1.0e3:
                    break
            assert best is not None, "the first iteration sets it"
            length = np.linalg.norm(slopes, axis=0)
            # the parameters of a mode that does not respond are not changed
            length = np.where(length > IDLE * length.max(), length, np.inf)
            jacobian = slopes / length
            fall = jacobian.T @ _real(best[3]).ravel()
            step = linalg.solve(
                jacobian.T @ jacobian + damp * np.eye(2 * self.count), fall, assume_a="pos"
            )
            if damp < 1.0 and fall @ step < SETTLED * best_cost:
                break
            step /= length
            logs = best[0] + step * min(
                1.0, STEP_LIMIT / max(np.abs(step[: self.count]).max(), 1.0e-30)
            )
            logs[self.count :] = np.clip(
                logs[self.count :], -LARGEST_LOG_DAMPING, LARGEST_LOG_DAMPING
            )
        return self._result(best, slopes, shape_slopes, seen, noise, delay)

    def explains_more(self, found: ModalFit, seen: np.ndarray, more: np.ndarray) -> bool:
        """Return whether the residual of a ModalFit with the participations `seen` is smaller with
        those of `more`, both (channel, fitted) bool, frequencies and damping fixed.
        """
        basis = self._basis(np.concatenate([found.log_frequency, found.log_damping]))
        one, other = (
            np.sum(np.abs(self._left(self._participations(basis, which), basis)) ** 2)
            for which in (seen, more)
        )
        return other < (1.0 - SETTLED) * one

    def _expected(self, shapes):
        """Return the model's participations (channel, fitted), as large as the channels respond:
        the gain of one may be wrong by orders of magnitude.
        """
        model = combined(shapes, self._basis(np.zeros(2 * self.count)), self.kinds)
        size, wanted = (
            np.linalg.norm(self.weights * lines, axis=1) for lines in (model, self.measured)
        )
        return shapes * (wanted / np.maximum(size, 1.0e-300))[:, None]

    def _at(self, logs):
        """Return (omega, damping) (fitted,) in rad/s and 1/s."""
        omega = self.omega * np.exp(logs[: self.count])
        return omega, 2.0 * self.zeta * np.exp(logs[self.count :]) * omega

    def _basis(self, logs):
        """Return {kind: (fitted, line)}: the response of each mode alone."""
        return responses_of(self.record, *self._at(logs), self.drive, self.kinds)

    def _left(self, shapes, basis):
        """Return (channel, line + fitted): the weighted residual of participations (channel,
        fitted), and what they differ from the model's.
        """
        left = self.measured - combined(shapes, basis, self.kinds)
        lines = self.weights * without_base(left, self.record, self.weights)
        return np.hstack(
            [lines, self.inverse_sd * np.where(shapes != 0.0, self.expected - shapes, 0.0)]
        )

    def _rows(self, basis, seen, channel):
        """Return weighted rows (row, line + fitted) of the participations seen of a channel, each
        with its own line of what is known of it; and one more of the motion of the base where the
        channel contains it.
        """
        own = np.flatnonzero(seen[channel])
        rows = self.weights[channel] * basis[self.kinds[channel]][own]
        rows = np.hstack([rows, self.inverse_sd[channel] * np.eye(self.count)[own]])
        base = self.record.base
        if base is None or not base[channel].any():
            return rows
        moved = np.append(self.weights[channel] * base[channel], np.zeros(self.count))
        return np.concatenate([rows, moved[None]])

    def _participations(self, basis, seen, phases=False):
        """Return (channel, fitted): the participations of the least residual."""
        shapes = np.zeros(seen.shape, complex if phases else float)
        for c in np.flatnonzero(seen.any(axis=1)):
            rows = self._rows(basis, seen, c)
            near = self.inverse_sd[c] * self.expected[c]
            target = np.append(self.weights[c] * self.measured[c], near)
            found = (
                linalg.lstsq(rows.T, target)[0]
                if phases
                else linalg.lstsq(_real(rows).T, _real(target), lapack_driver="gelsy")[0]
            )
            shapes[c, seen[c]] = found[: seen[c].sum()]
        return shapes

    def _slopes(self, best, seen):
        """Return (2 channel (line + fitted), 2 fitted): the derivatives of the weighted fit by each
        logarithm, without what participations would compensate; and (channel, fitted, 2 fitted):
        the derivatives of these.

        The simplification of L. Kaufman (BIT 15, 1975): the derivative of the basis, without its
        projection onto the basis, channel by channel.
        """
        logs, shapes, basis, _ = best
        change = {
            kind: np.concatenate(self.record.changes(*self._at(logs), self.drive, kind))
            for kind in basis
        }
        lines = self.measured.shape[1] + self.count
        slopes = np.zeros((len(shapes), 2 * lines, 2 * self.count))
        taken = np.zeros((*shapes.shape, 2 * self.count))
        for channel, kind in enumerate(self.kinds):
            moved = (np.tile(shapes[channel], 2)[:, None] * self.weights[channel]) * change[kind]
            own = _real(np.pad(moved, ((0, 0), (0, self.count)))).T
            known = self._rows(basis, seen, channel)
            columns = [_real(known)] + [_real(1j * known)] * np.iscomplexobj(shapes)
            span, turn = np.linalg.qr(np.vstack(columns).T)
            inside = span.T @ own
            slopes[channel] = own - span @ inside
            count = int(seen[channel].sum())
            if count:
                # participations compensate what lies in the span of the basis
                taken[channel, seen[channel]] = -(_inverse(turn) @ inside)[:count]
        return slopes.reshape(-1, 2 * self.count), taken

    def _result(self, best, slopes, shape_slopes, seen, noise, delay):
        logs, shapes, basis, residual = best
        left = residual[:, : -self.count]
        covariance = linalg.pinvh(slopes.T @ slopes) * max(1.0, np.mean(np.abs(left) ** 2))
        power = np.sqrt(np.sum(np.abs(left / self.weights) ** 2, axis=-1))
        total = np.sqrt(np.sum(np.abs(self.measured) ** 2, axis=-1))
        return ModalFit(
            self.modes,
            self.drive,
            logs[: self.count],
            logs[self.count :],
            shapes,
            covariance,
            self._shape_covariance(basis, seen, np.mean(np.abs(left) ** 2, axis=-1)),
            shape_slopes,
            delay,
            power / np.hypot(noise, RESIDUAL_SHARE * total),
            power / np.maximum(total, 1.0e-300),
        )

    def _shape_covariance(self, basis, seen, left):
        """Return (channel, fitted, fitted): the covariance of participations; left (channel,): the
        weighted mean square of the residual.
        """
        out = np.zeros((len(seen), self.count, self.count))
        for channel in np.flatnonzero(seen.any(axis=1)):
            rows = _real(self._rows(basis, seen, channel))
            count = int(seen[channel].sum())
            root = _inverse(np.linalg.qr(rows.T, mode="r"))[:count]
            out[np.ix_([channel], seen[channel], seen[channel])] = (
                max(1.0, left[channel]) * root @ root.T
            )
        return out

    def _start(self):
        """Return (fitted,) ln of the factor of the frequency at which the mode alone explains most
        near its resonance, within SEARCH.
        """
        frequency, out = self.record.frequency, np.zeros(self.count)
        for number, omega in enumerate(self.omega):
            near = (
                np.abs(frequency - omega / (2.0 * np.pi))
                < SEARCH * 1.5 * omega / (2.0 * np.pi) + 0.5
            )
            if near.sum() < 10:
                continue
            grid = np.arange(-SEARCH, SEARCH + 1.0e-9, max(self.zeta[number], SEARCH / 40.0))
            w = omega * np.exp(grid)
            drive = np.repeat(self.drive[number][None], len(w), axis=0)
            basis = responses_of(self.record, w, 2.0 * self.zeta[number] * w, drive, self.kinds)
            explained = np.zeros(len(grid))
            for c, kind in enumerate(self.kinds):
                y = self.weights[c, near] * self.measured[c, near]
                b = self.weights[c, near] * basis[kind][:, near]
                explained += np.real(b.conj() @ y) ** 2 / np.maximum(
                    np.sum(np.abs(b) ** 2, axis=-1), 1.0e-300
                )
            # of frequencies that explain as much the one near the model is preferred
            prior = -0.5 * (grid / 0.006) ** 2 * 0.02 * explained.max()
            out[number] = grid[np.argmax(explained + prior)]
        return out


def _inverse(turn):
    """Return the inverse of an upper triangular matrix, finite where two modes coincide."""
    size = np.abs(np.diag(turn))
    ridge = np.diag(np.where(size < SINGULAR * size.max(initial=0.0), SINGULAR * size.max(), 0.0))
    return linalg.solve_triangular(turn + ridge, np.eye(len(turn)))


def _real(values):
    """Return complex (..., n) as real (..., 2 n)."""
    return np.concatenate([values.real, values.imag], axis=-1)
