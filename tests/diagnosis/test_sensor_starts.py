"""A sensor that is left free tells its gain and its delay."""

from dataclasses import replace

import numpy as np
import pytest

from tests.diagnosis.played import played
from vibroimpact.diagnosis.explanations import Point
from vibroimpact.diagnosis.sensor_starts import sensor_terms

LATE_S, GAIN = 0.004, 1.4


def test_a_late_and_too_large_channel_is_told(comparison):
    bench = played(comparison.screened(), Point())
    channel = bench.structure.names.index("apex_y")
    steps = round(LATE_S * bench.schedule.steps_per_second)
    first = bench.stretches[0]
    motion = first.motion.copy()
    motion[:, channel] = GAIN * np.concatenate([np.zeros(steps), motion[:-steps, channel]])
    faulty = replace(bench, stretches=(replace(first, motion=motion), *bench.stretches[1:]))
    told = {
        (each.effect_id, each.location): each.values[0] for each in sensor_terms(faulty, Point())
    }
    sampling = bench.schedule.sampling_frequency
    assert told["sensor_delay", "apex_y"] == pytest.approx(LATE_S, abs=0.3 / sampling)
    assert told["sensor_gain", "apex_y"] == pytest.approx(GAIN, rel=0.05)
    alone = sensor_terms(bench, Point())
    delays = [each.values[0] for each in alone if each.effect_id == "sensor_delay"]
    assert len(delays) > 1 and np.abs(delays).max() < 0.3 / sampling
