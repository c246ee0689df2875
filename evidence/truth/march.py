"""One record: the rig integrated from rest under a force, decimated to the sampling frequency."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import firwin, kaiser_beta, upfirdn

from evidence.truth import kernel

FAST_HZ = 40960  # sampled before decimation: the modes end at 15000 Hz
# Of the gap: no tube lies nearer to the axis of its holes. One that does stays in the plane that it
# is driven in.
OFF_CENTRE = 1.0e-3
SETTLE_S = 2.5  # duration of the ramp of dead loads and offsets, before the record
# "fir80" of the contract at 2048 Hz, with a margin of 6 dB
PASS_HZ, STOP_HZ, STOP_DB = 800.0, 1024.0, 86.0


CHUNK_S = 0.25  # of one propagator, where the modes drift
LEAD_S = (2.0, 10.0)  # before a record that begins in stationary motion: three times what the
LEAD = 3.0  # slowest mode decays by 1/e in, within these limits
TAIL_S = 0.05  # after a record, for the filter


@dataclass(frozen=True, eq=False)
class Record:
    """The response of one record.

    displacement (channel, time): m, and its derivatives velocity m/s and acceleration m/s².
    reaction (plate, 2, time): force on the tube, N.
    contact (plate,): share of time in contact.
    """

    displacement: np.ndarray
    velocity: np.ndarray
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


def velocities(displacement, step):
    """(…, time) central differences of fourth order of displacements over `step` [s]; zero motion
    before, and the last value after.
    """
    wide = np.pad(displacement, [(0, 0)] * (displacement.ndim - 1) + [(2, 2)], mode="edge")
    near = wide[..., 3:-1] - wide[..., 1:-3]
    far = wide[..., 4:] - wide[..., :-4]
    return (8.0 * near - far) / (12.0 * step)


def rest_state(reduced, imperfection, rng):
    """A State at rest but for a random displacement of the first in-plane modes.

    imperfection: its size, m. Without it the in-plane motion would start from round-off.
    """
    modes, plates = len(reduced.frequency), len(reduced.plates)
    state = kernel.State(
        np.zeros(modes),
        np.zeros(modes),
        *np.zeros((2, plates, kernel.NODES)),
        np.zeros((plates, kernel.NODES, kernel.PARTS)),
        *np.zeros((3, plates, kernel.NODES)),
        np.zeros(len(reduced.local.law)),
        np.zeros((plates, 4)),
        np.zeros((len(reduced.local.loose), 4)),
        np.zeros((len(reduced.local.slider), 3)),
    )
    first = slice(reduced.split, reduced.split + 4)
    state.q[first] = imperfection * rng.standard_normal(4)
    return state


@dataclass(frozen=True, eq=False)
class Drive:
    """The forces of a record, (time,) N at `sampling` Hz, periodic over the record.

    unmeasured: a second force, or None. stationary: whether the record begins in stationary motion.
    """

    force: np.ndarray
    sampling: float
    unmeasured: np.ndarray | None = None
    stationary: bool = False


def run_record(reduced, drive, gap, steps_per_second, rng, start=0.0):
    """The Record of a Drive.

    gap: (plate,) m.
    start: time of the campaign before the record, s.
    """
    factor, stride = round(steps_per_second / drive.sampling), stride_of(steps_per_second)
    plates = reduced.plates.copy()
    plates[:, kernel.GAP] = gap
    state = rest_state(reduced, 1e-6 * float(np.min(gap, initial=1e-3)), rng)
    leans = (
        reduced.dead.any()
        or plates[:, [kernel.OFFSET_X, kernel.OFFSET_Y]].any()
        or reduced.contacts.tilt_y.any()
        or reduced.contacts.tilt_x.any()
    )
    plates[:, [kernel.OFFSET_X, kernel.OFFSET_Y]] += (
        OFF_CENTRE * plates[:, [kernel.GAP]] * rng.uniform(-1.0, 1.0, 2)
    )
    march = Stretch(reduced, plates, state, 1.0 / steps_per_second)
    if leans:
        count = int(SETTLE_S * steps_per_second)
        grow = 0.5 - 0.5 * np.cos(np.pi * np.minimum(np.arange(count) / (0.8 * count), 1.0))
        march.run(np.zeros(count), np.zeros(0), start, ramp=grow)
    samples = len(drive.force)
    decay = 2.0 / reduced.rate[reduced.real].min()
    wanted = round(float(np.clip(LEAD * decay, *LEAD_S)) * drive.sampling)
    lead = min(wanted, samples) if drive.stationary else 0
    tail = round(TAIL_S * drive.sampling)
    around = np.arange(-lead, samples + tail) % samples
    force, second = (
        np.zeros(0) if series is None else around_fast(upsample(series, factor), around, factor)
        for series in (drive.force, drive.unmeasured)
    )
    march.touched[:] = 0.0
    fast, reaction = march.run(force, second, start, recorded=True)
    taps = anti_alias(steps_per_second / stride, factor // stride)
    step = stride / steps_per_second
    kept = slice(lead, lead + samples)
    fast = fast - fast[:, :1]  # displacements count from the start
    found = [
        decimate(series, factor // stride, taps)[..., kept]
        for series in (fast, velocities(fast, step), accelerations(fast, step), reaction)
    ]
    return Record(
        *found[:3], found[3].reshape(len(plates), 2, -1), march.touched / max(len(force), 1)
    )


def around_fast(fast, around, factor):
    """(sample × factor,) of a series upsampled by factor, at the samples `around`."""
    return fast.reshape(-1, factor)[around].ravel()


def stride_of(steps_per_second):
    """Steps per sample before decimation."""
    return max(1, round(steps_per_second / FAST_HZ))


class Stretch:
    """A rig and its state, integrated stretch by stretch.

    touched (plate,): steps in contact so far.
    """

    def __init__(self, reduced, plates, state, step):
        self.reduced, self.plates, self.state, self.step = reduced, plates, state, step
        self.touched, self.stride = np.zeros(len(plates)), stride_of(1.0 / step)

    def run(self, force, second, start, ramp=None, recorded=False):
        """(channel, sample) m and (2 plate, sample) N of a stretch under forces (step,) N.

        ramp (step,): factor of dead loads and offsets. recorded: False leaves samples out.
        """
        reduced, channels = self.reduced, len(self.reduced.sensors) if recorded else 0
        stride = self.stride
        sensors = np.zeros((-(-channels // kernel.ROWS) * kernel.ROWS, len(reduced.frequency)))
        sensors[:channels] = reduced.sensors[:channels]
        fast = np.zeros((-(-len(force) // stride), len(sensors)))
        reaction = np.zeros((len(fast), 2 * len(self.plates)))
        stretch = round(CHUNK_S / self.step) // stride * stride if reduced.drift else len(force)
        for first in range(0, len(force), max(stretch, 1)):
            part = slice(first, first + stretch)
            samples = slice(first // stride, -(-(first + stretch) // stride))
            elapsed = start + first * self.step
            failed = kernel.march(
                reduced.split,
                reduced.propagator(self.step, elapsed),
                reduced.contacts,
                self.plates,
                reduced.local,
                reduced.drive,
                force[part],
                reduced.other,
                second[part],
                reduced.dead,
                np.ones(1) if ramp is None else ramp[part],
                sensors,
                self.step,
                stride,
                elapsed,
                self.state,
                fast[samples],
                reaction[samples],
                self.touched,
            )
            _require_finite(failed, self.step)
        return fast[:, :channels].T, reaction.T


def _require_finite(failed, step):
    """Raise FloatingPointError where the integration diverged."""
    if failed >= 0:
        raise FloatingPointError(
            f"the march is no longer finite at t = {failed * step:.4f} s: more steps per second, or"
            " weaker parameters"
        )
