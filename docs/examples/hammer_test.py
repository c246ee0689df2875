"""A hammer test that never was: two masses on springs, hit every two seconds, as two CSV files, the
campaign.yaml beside them and a model of the masses.

python docs/examples/hammer_test.py FOLDER. Needs NumPy alone. The cell of the hammer reads exact
zeros between the blows, as a force window leaves them, and a constant offset, as an amplifier that
was not balanced adds one. The blows of the second record are four times as hard.
"""

import sys
from pathlib import Path

import numpy as np

MASS, GROUND, BETWEEN = 2.0, 6.0e4, 3.0e4  # kg, N/m: each mass to the ground, between the masses
RATIO = 0.02  # of critical damping, both modes
RATE, SECONDS, EVERY = 1024, 40.0, 2.0  # Hz, s, s
PULSE_S, OFFSET_N, NOISE = 4.0e-3, 3.0, 2.0e-3  # s, N, m/s²
LEVELS = {"soft": 50.0, "hard": 200.0}  # N, largest force of a blow
HELD_OUT = "hard"

SIDECAR = """source: hammer test
antialias: none
start_up: rest
band_Hz: [10, 250]
forces:
  - {name: hammer, point_m: [0, 0, 0], direction: +x, remove_offset: true}
channels:
  - {name: drive, kind: acceleration, point_m: [0, 0, 0], direction: +x}
  - {name: far, kind: acceleration, point_m: [0.2, 0, 0], direction: +x}
records:
"""
MODEL = f"""study: hammered
structure:
  kind: chain
  masses: [{{name: drive, mass_kg: {MASS}}}, {{name: far, mass_kg: {MASS}}}]
  springs:
    - {{between: [ground, drive], stiffness_N_per_m: {GROUND}}}
    - {{between: [ground, far], stiffness_N_per_m: {GROUND}}}
    - {{between: [drive, far], stiffness_N_per_m: {BETWEEN}}}
damping: {{kind: modal, other_ratio: {RATIO}}}
points: {{drive: [0.0, 0.0, 0.0], far: [0.2, 0.0, 0.0]}}
excitation: {{kind: band_limited, point: drive, direction: [1.0, 0.0, 0.0], band_Hz: [10.0, 250.0]}}
grid: {{load_rms_N: [1.0], gap_m: [1.0e-3], seeds: 1}}
record: {{duration_s: 20.0, sensors: {{points: [drive, far], directions: [x]}}}}
"""


def blows(largest, draw):
    """(time,) N: half sines, each of another height, and exact zeros between them."""
    force, length = np.zeros(int(SECONDS * RATE)), int(PULSE_S * RATE) + 1
    pulse = np.sin(np.pi * np.arange(1, length) / length)
    for start in range(RATE // 2, force.size - RATE, int(EVERY * RATE)):
        shift = draw.integers(0, RATE // 4)  # no one hits like a clock
        height = largest * draw.uniform(0.7, 1.0)
        force[start + shift : start + shift + pulse.size] = height * pulse
    return force


def accelerations(force):
    """(2, time) m/s² of both masses, by their two modes: in phase, and against each other."""
    shapes = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2.0 * MASS)
    poles = np.sqrt(np.array([GROUND, GROUND + 2.0 * BETWEEN]) / MASS)[:, None]
    quiet = np.zeros(4 * RATE)  # after the end, so that nothing runs round to the start
    lines = np.fft.rfft(np.concatenate([force, quiet]))
    s = 2j * np.pi * np.fft.rfftfreq(force.size + quiet.size, 1.0 / RATE)
    modal = s**2 / (s**2 + 2.0 * RATIO * poles * s + poles**2)
    moved = np.fft.irfft(shapes @ (shapes[0][:, None] * modal) * lines, force.size + quiet.size)
    return moved[:, : force.size]


def main(folder):
    """Write the records, the sidecar and the model."""
    draw = np.random.default_rng(6)
    folder.mkdir(parents=True, exist_ok=True)
    for name, largest in LEVELS.items():
        force = blows(largest, draw)
        moved = accelerations(force) + NOISE * draw.standard_normal((2, force.size))
        np.savetxt(
            folder / f"{name}.csv",
            np.column_stack([np.arange(force.size) / RATE, force + OFFSET_N, *moved]),
            delimiter=",",
            fmt="%.8g",
            header="time [s],hammer [N],drive [m/s^2],far [m/s^2]",
        )
    lines = [
        f"  - {{file: {name}.csv, split: {'holdout' if name == HELD_OUT else 'fit'}}}\n"
        for name in LEVELS
    ]
    (folder / "campaign.yaml").write_text(SIDECAR + "".join(lines))
    (folder / "model.yaml").write_text(MODEL)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "measurements/hammer"))
