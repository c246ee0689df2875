"""A bench test that never was: two masses with a stop behind a clearance between them, as five CSV
files and a campaign.yaml beside them.

python docs/examples/two_masses.py FOLDER. Needs NumPy alone. The upper mass hangs on a spring and
is driven by a multisine; an accelerometer sits on each mass; between the masses a spring, and a
stop that the lower mass hits when it is 0.6 mm away from its rest.
"""

import sys
from pathlib import Path

import numpy as np

UPPER, LOWER = 2.0, 1.0  # kg
STIFFNESS, DAMPING = (1.2e4, 8.0e3), (8.0, 6.0)  # N/m, N s/m: to the ground, between the masses
STOP, CLEARANCE = 1.5e4, 6.0e-4  # N/m, m
RATE, PERIOD, PERIODS, SUBSTEPS = 128, 1024, 4, 10  # Hz, samples, periods, steps per sample
BAND = 3.0, 45.0  # Hz
LEVELS = {"level_1": 0.5, "level_2": 2.0, "level_3": 4.0, "level_4": 8.0, "level_5": 12.0}  # N RMS
HELD_OUT = "level_4"
NOISE = 2.0e-3  # m/s²
G = 9.80665

SIDECAR = """source: two masses on a bench
antialias: none
start_up: rest
forces:
  - {name: shaker, point_m: [0, 0, 0], direction: +z}
channels:
  - {name: upper, kind: acceleration, point_m: [0, 0, 0], direction: +z}
  - {name: lower, kind: acceleration, point_m: [0, 0, -0.4], direction: +z}
records:
"""


def multisine():
    """Force at 2 * SUBSTEPS points per sample over one period, 1 N RMS."""
    frequency = np.fft.rfftfreq(PERIOD, 1.0 / RATE)
    lines = np.where(
        (frequency >= BAND[0]) & (frequency <= BAND[1]),
        np.exp(2j * np.pi * np.random.default_rng(4).uniform(size=frequency.size)),
        0.0,
    )
    force = np.fft.irfft(np.pad(lines, (0, PERIOD * SUBSTEPS - PERIOD // 2)), PERIOD * 2 * SUBSTEPS)
    return force / force.std()


def rate(state, force):
    """Time derivative of (positions, velocities) of both masses, all levels side by side."""
    x, v = state[:2], state[2:]
    away, speed = x[1] - x[0], v[1] - v[0]
    between = (
        STIFFNESS[1] * away
        + DAMPING[1] * speed
        + STOP * np.sign(away) * np.maximum(np.abs(away) - CLEARANCE, 0.0)
    )
    return np.concatenate(
        [v, [(force - STIFFNESS[0] * x[0] - DAMPING[0] * v[0] + between) / UPPER, -between / LOWER]]
    )


def main(folder):
    """Write the records, by Runge-Kutta from rest, and the sidecar."""
    shape, loads, step = multisine(), np.array([*LEVELS.values()]), 1.0 / (RATE * SUBSTEPS)
    state, rows = np.zeros((4, loads.size)), []
    for sample in range(PERIODS * PERIOD):
        for sub in range(SUBSTEPS):
            at = 2 * (SUBSTEPS * (sample % PERIOD) + sub)
            now, half, end = (shape[(at + shift) % shape.size] * loads for shift in range(3))
            a = rate(state, now)
            if sub == 0:
                rows.append([now, *a[2:]])
            b = rate(state + 0.5 * step * a, half)
            c = rate(state + 0.5 * step * b, half)
            state = state + step / 6.0 * (a + 2.0 * b + 2.0 * c + rate(state + step * c, end))
    rows = np.array(rows)  # (time, channel, level)
    rows[:, 1:] += NOISE * np.random.default_rng(9).standard_normal(rows[:, 1:].shape)
    folder.mkdir(parents=True, exist_ok=True)
    for index, name in enumerate(LEVELS):
        table = np.column_stack(
            [np.arange(len(rows)) / RATE, rows[:, 0, index], rows[:, 1:, index] / G]
        )
        np.savetxt(
            folder / f"{name}.csv",
            table,
            delimiter=",",
            fmt="%.8g",
            header="time,shaker [N],upper [g],lower [g]",
            comments="",
        )
    lines = [
        f"  - {{name: {name.replace('_', ' ')}, file: {name}.csv, split:"
        f" {'holdout' if name == HELD_OUT else 'fit'}}}\n"
        for name in LEVELS
    ]
    (folder / "campaign.yaml").write_text(SIDECAR + "".join(lines))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "measurements/two_masses"))
