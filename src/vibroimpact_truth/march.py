"""One record: the rig integrated from rest under a force, decimated to the sampling frequency."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import firwin, kaiser_beta, upfirdn

from vibroimpact_truth import kernel

STRIDE = 4  # steps per sample before decimation: 40960 Hz, where the modes end at 15000 Hz
SETTLE_S = 2.5  # duration of the ramp of dead loads and offsets, before the record
# "fir80" of the contract at 2048 Hz, with a margin of 6 dB
PASS_HZ, STOP_HZ, STOP_DB = 800.0, 1024.0, 86.0


@dataclass(frozen=True, eq=False)
class Record:
    """The response of one record.

    acceleration (channel, time): m/s².
    reaction (plate, 2, time): force on the tube, N.
    contact (plate,): share of time in contact.
    """

    acceleration: np.ndarray
    reaction: np.ndarray
    contact: np.ndarray


def upsample(force, factor):
    """(time × factor,) of a force (time,) N: band-limited interpolation by Fourier transform."""
    spectrum = np.fft.rfft(force)
    full = np.zeros(len(force) * factor // 2 + 1, complex)
    full[: len(spectrum)] = spectrum
    return np.fft.irfft(full, len(force) * factor) * factor


def anti_alias(fast, factor):
    """Taps of a linear-phase filter at `fast` Hz for decimation by `factor`; an odd number.

    The band edges scale with the sampling frequency.
    """
    scale = fast / factor / 2048.0
    width = (STOP_HZ - PASS_HZ) * scale
    taps = int(np.ceil((STOP_DB - 7.95) / (2.285 * 2.0 * np.pi * width / fast))) + 1
    # A whole number of decimated samples, so that the delay can be removed exactly.
    half = -(-taps // (2 * factor)) * factor
    return firwin(
        2 * half + 1,
        0.5 * (PASS_HZ + STOP_HZ) * scale,
        window=("kaiser", kaiser_beta(STOP_DB)),
        fs=fast,
    )


def decimate(series, factor, taps):
    """(…, time / factor) of (…, time): filtered, group delay removed, zeros before and after."""
    delay = (len(taps) - 1) // 2 // factor
    kept = series.shape[-1] // factor
    return upfirdn(taps, series, 1, factor, axis=-1)[..., delay : delay + kept]


def accelerations(displacement, step):
    """(…, time) second differences of displacements over `step` [s]; 0.02 dB low at 1 kHz.

    The modal forces at the kicks are not used: there omega² q responds to a constant force g by
    g (1 - (omega step)²/12). Sensors near a plate would show a share of the contact force at
    frequencies where they hardly move.
    """
    change = np.diff(displacement, axis=-1, prepend=displacement[..., :1])
    return np.diff(change, axis=-1, append=change[..., -1:]) / step**2


def rest_state(reduced, imperfection, rng):
    """A State at rest but for a random displacement of the first in-plane modes.

    imperfection: its size, m. Without it the in-plane motion would start from round-off.
    """
    modes, plates = len(reduced.frequency), len(reduced.plates)
    state = kernel.State(
        np.zeros(modes),
        np.zeros(modes),
        *np.zeros((3, plates, kernel.NODES)),
        np.zeros(len(reduced.local.law)),
        np.zeros((plates, 4)),
        np.zeros((len(reduced.local.loose), 4)),
    )
    first = slice(reduced.split, reduced.split + 4)
    state.q[first] = imperfection * rng.standard_normal(4)
    return state


def run_record(reduced, force, gap, sampling, steps_per_second, rng, start=0.0, unmeasured=None):
    """The Record of a force (time,) N at `sampling` Hz.

    gap: (plate,) m.
    start: time of the campaign before the record, s.
    unmeasured: (time,) N of a second force, or None.
    """
    factor = round(steps_per_second / sampling)
    step, plates = 1.0 / steps_per_second, reduced.plates.copy()
    plates[:, kernel.GAP] = gap
    state = rest_state(reduced, 1e-6 * float(np.min(gap)), rng)
    turn = reduced.propagator(1.0 / steps_per_second)
    group = (reduced.split, turn, reduced.contacts, plates, reduced.local, reduced.drive)
    touched = np.zeros(len(plates))
    if (
        reduced.dead.any()
        or plates[:, [kernel.OFFSET_X, kernel.OFFSET_Y]].any()
        or reduced.contacts.tilt_y.any()
        or reduced.contacts.tilt_x.any()
    ):
        count = int(SETTLE_S * steps_per_second)
        grow = 0.5 - 0.5 * np.cos(np.pi * np.minimum(np.arange(count) / (0.8 * count), 1.0))
        _require_finite(
            kernel.march(
                *group,
                np.zeros(count),
                reduced.other,
                np.zeros(0),
                reduced.dead,
                grow,
                reduced.sensors[:0],
                step,
                count,
                start,
                state,
                np.zeros((1, 0)),
                np.zeros((1, 2 * len(plates))),
                touched,
            ),
            step,
        )
        touched[:] = 0.0
    steps = len(force) * factor
    second = np.zeros(0) if unmeasured is None else upsample(unmeasured, factor)
    channels = len(reduced.sensors)
    sensors = np.zeros((-(-channels // kernel.ROWS) * kernel.ROWS, len(reduced.frequency)))
    sensors[:channels] = reduced.sensors
    fast = np.zeros((steps // STRIDE, len(sensors)))
    reaction = np.zeros((steps // STRIDE, 2 * len(plates)))
    _require_finite(
        kernel.march(
            *group,
            upsample(force, factor),
            reduced.other,
            second,
            reduced.dead,
            np.ones(1),
            sensors,
            step,
            STRIDE,
            start,
            state,
            fast,
            reaction,
            touched,
        ),
        step,
    )
    taps = anti_alias(steps_per_second / STRIDE, factor // STRIDE)
    slow = decimate(accelerations(fast[:, :channels].T, step * STRIDE), factor // STRIDE, taps)
    forces = decimate(reaction.T, factor // STRIDE, taps)
    return Record(slow, forces.reshape(len(plates), 2, -1), touched / steps)


def _require_finite(failed, step):
    """Raise FloatingPointError where the integration diverged."""
    if failed >= 0:
        raise FloatingPointError(
            f"the march is no longer finite at t = {failed * step:.4f} s: more steps per second, or"
            " weaker parameters"
        )
