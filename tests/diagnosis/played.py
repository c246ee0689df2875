"""Measurements that the model itself plays: free runs of a variant as motion to hold another to."""

from dataclasses import replace

import numpy as np
from scipy import signal

from vibroimpact.diagnosis.bench import Bench
from vibroimpact.diagnosis.explanations import Point
from vibroimpact.integration.held_run import HeldLane, hold


def played(bench: Bench, point: Point) -> Bench:
    """A Bench whose measured motion is that of a Point, run free from rest under the same force."""
    model = bench.structure.held_model(point)
    free = np.zeros(model.sensor_shapes.shape[1])
    runs = [
        HeldLane(model, each.gap, each.force, np.zeros_like(each.motion), free)
        for each in bench.stretches
    ]
    motion = hold(runs, bench.schedule).motion
    up = round(bench.schedule.steps_per_second / bench.schedule.sampling_frequency)
    stretches = []
    for each, own in zip(bench.stretches, motion, strict=True):
        fine = signal.resample_poly(own, up, 1, axis=-1, window=("kaiser", 9.0), padtype="edge")
        count = len(each.motion)
        dense = np.pad(fine, ((0, 0), (1, count)), mode="edge")[:, :count]
        moving = own.std(axis=-1) > 0.02 * own.std(axis=-1).max()
        stretches.append(replace(each, motion=dense.T, moving=moving))
    return replace(bench, stretches=tuple(stretches))
