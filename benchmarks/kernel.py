"""Time per step of our kernel against the plain numba kernel, in one run: prints nanoseconds and their ratios.

    python benchmarks/kernel.py [--seconds 1.0] [--repeats 5]

The kernel integrates kernels.LANES runs at once and also filters 35 displacement channels, the support forces and the
stresses, counts contacts and closes the energy balance; the plain loop does none of that.
"""

import argparse
import time

import numpy as np
from plain_kernel import march_plain

from vibroimpact import kernels
from vibroimpact.config import load_config
from vibroimpact.excitation import band_limited_noise
from vibroimpact.integrate import Schedule, _Run
from vibroimpact.layout import newmark_coefficients
from vibroimpact.reduction import build_model

GAP, LOAD, RATE = 2.8886e-4, 20.0, 51200


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=1.0, help="simulated seconds per run")
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    model = build_model(load_config("config/study.yaml"))
    schedule = Schedule(RATE, 2048, 0.0, options.seconds)
    noise = [LOAD * band_limited_noise(np.random.default_rng(lane), schedule.steps + 2, RATE, (5.0, 200.0)) for lane in range(kernels.LANES)]
    noise = np.stack(noise, axis=-1)
    noise *= LOAD / noise.std(axis=0)
    ours, plain = [], []
    for _ in range(options.repeats + 1):  # the first of each compiles
        ours.append(time_ours(model, schedule, noise))
        plain.append(time_plain(model, noise[:, 0]))
    ours, plain = 1e9 * np.array(ours[1:]) / schedule.steps / kernels.LANES, 1e9 * np.array(plain[1:]) / (noise.shape[0] - 1)
    ratio = plain / ours
    print(f"{model.modes} modes, {model.support_of_point.size} contact points, 2 directions, {LOAD:g} N RMS, gap {GAP * 1e3:.3f} mm")
    for name, values, unit in (("ours, batched", ours, "ns/step/run"), ("plain numba", plain, "ns/step/run"), ("plain / ours", ratio, "")):
        print(f"{name:14s} median {np.median(values):8.2f}  min {values.min():8.2f}  max {values.max():8.2f} {unit}")


def time_ours(model, schedule, noise):
    """Seconds in the kernel for LANES runs side by side."""
    lanes = kernels.LANES
    offset = np.random.default_rng(0).uniform(-1, 1, (model.support_of_point.size, 2, lanes)) * 1e-6 * GAP
    run = _Run(model, schedule, np.full(lanes, GAP), offset, lambda first, count: noise[first : first + count, None, :], lanes)
    start = time.perf_counter()
    run.finish(0.0)
    return time.perf_counter() - start


def time_plain(model, force):
    """Seconds of the plain kernel for one run."""
    dt = 1.0 / RATE
    newmark = newmark_coefficients(model.omega, model.damping, dt)
    coefficients = np.stack([value for name, value in newmark.items() if name != "loss"])
    shapes = np.ascontiguousarray(model.contact_shapes.reshape(model.modes, -1).T)
    compliance = (shapes * newmark["displacement_from_force"]) @ shapes.T
    offset = np.random.default_rng(0).uniform(-1, 1, shapes.shape[0]) * 1e-6 * GAP
    q, v = np.zeros(model.modes), np.zeros(model.modes)
    start = time.perf_counter()
    march_plain(shapes, model.drive_shapes[:, 0].copy(), coefficients, compliance, model.contact_stiffness, GAP, offset, force, q, v, 3)
    return time.perf_counter() - start


if __name__ == "__main__":
    main()
