"""Three masses in a row with a joint between the last two, under a multisine: an integrator of its
own, for tests of the completion.
"""

import numpy as np

MASS = np.array([2.0, 1.0, 0.8])  # kg
SPRINGS = (9.0e3, 2.5e4, 1.2e4)  # N/m: ground-1, 1-2, 2-3 (the joint)
DAMPERS = (4.0, 2.0, 2.5)  # N s/m
RATE, PERIOD = 128.0, 512  # Hz, samples
BAND = (4.0, 45.0)  # Hz
SUBSTEPS = 6
LAWS = ("cubic", "friction", "clearance")
CUBIC = 1.0e9  # N/m3
STICK, SLIP = 6.0e3, 0.4  # N/m, N: a slider beside the joint's spring
STOP, HALF_GAP = 6.0e3, 2.0e-4  # N/m, m
LEVELS = (0.5, 2.0, 4.0, 6.0)  # N RMS


def matrices():
    """(M, C, K) of the three masses, (3, 3) each, the joint's linear spring and damper among
    them.
    """
    rows = np.array([[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [0.0, -1.0, 1.0]])
    return np.diag(MASS), rows.T @ np.diag(DAMPERS) @ rows, rows.T @ np.diag(SPRINGS) @ rows


def multisine(seed=3):
    """(time,) N of unit RMS: every line of BAND with a random phase, one period."""
    frequency = np.fft.rfftfreq(PERIOD, 1.0 / RATE)
    inside = (frequency >= BAND[0]) & (frequency <= BAND[1])
    lines = np.where(
        inside, np.exp(2j * np.pi * np.random.default_rng(seed).uniform(size=frequency.size)), 0.0
    )
    signal = np.fft.irfft(lines, PERIOD)
    return signal / signal.std()


def simulate(periods=4):
    """{law: (force (level, time), acceleration (level, 3, time))} over some periods from rest, by
    Runge-Kutta, all laws side by side.

    The slider is a state of its own with the rate STICK * (relative velocity), or nothing while it
    slips outwards.
    """
    mass, damping, stiffness = matrices()
    inverse = np.linalg.inv(mass)
    fine = np.fft.irfft(
        np.pad(np.fft.rfft(multisine()) * 2 * SUBSTEPS, (0, PERIOD * SUBSTEPS - PERIOD // 2)),
        PERIOD * 2 * SUBSTEPS,
    )
    loads = np.tile(LEVELS, len(LAWS))
    kind = np.repeat(np.arange(len(LAWS)), len(LEVELS))

    def law(w, slider):
        stop = STOP * np.sign(w) * np.maximum(np.abs(w) - HALF_GAP, 0.0)
        return np.where(kind == 0, CUBIC * w**3, np.where(kind == 1, slider, stop))

    def rate(state, force):
        x, v, slider = state[:3], state[3:6], state[6]
        pull = law(x[2] - x[1], slider)
        total = -damping @ v - stiffness @ x
        total[0] += force * loads
        total[1] += pull
        total[2] -= pull
        speed = STICK * (v[2] - v[1])
        slips = (np.abs(slider) >= SLIP) & (slider * speed > 0.0)
        return np.concatenate([v, inverse @ total, np.where(slips, 0.0, speed)[None]])

    step = 1.0 / (RATE * SUBSTEPS)
    state, kept = np.zeros((7, loads.size)), np.empty((periods * PERIOD, 3, loads.size))
    for sample in range(periods * PERIOD):
        kept[sample] = rate(state, fine[2 * SUBSTEPS * (sample % PERIOD)])[3:6]
        for sub in range(SUBSTEPS):
            at = 2 * (SUBSTEPS * (sample % PERIOD) + sub)
            f0, fh, f1 = fine[at], fine[at + 1], fine[(at + 2) % fine.size]
            a = rate(state, f0)
            b = rate(state + 0.5 * step * a, fh)
            c = rate(state + 0.5 * step * b, fh)
            d = rate(state + step * c, f1)
            state = state + step / 6.0 * (a + 2.0 * b + 2.0 * c + d)
            state[6] = np.clip(state[6], -SLIP, SLIP)
    force = np.tile(multisine(), periods) * np.array(LEVELS)[:, None]
    return {
        name: (force, kept[:, :, kind == number].transpose(2, 1, 0))
        for number, name in enumerate(LAWS)
    }
