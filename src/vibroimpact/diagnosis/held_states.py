"""The two models of a diagnosis, as given and completed, held to the same stretches: all sensors
held, and one left free at a time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vibroimpact.integration.held_run import HeldRecords, hold
from vibroimpact.reduction.modal_model import ModalModel

from .bench import Bench, lane_of, undelayed
from .explanations import Point
from .law import Places, element_force, places_of
from .measurement.sensor_chain import Measuring


@dataclass(frozen=True, eq=False)
class HeldState:
    """Runs of one Point on the stretches of a Bench; the first runs are those with all held.

    records: of the channels, then the Places. free {(stretch, channel): run}.
    """

    bench: Bench
    model: ModalModel
    places: Places
    chain: Measuring
    records: HeldRecords
    free: dict[tuple[int, int], int]

    def holding(self) -> np.ndarray:
        """Return (stretch, channel, sample) N: the holding force with all held, as a residual of
        what was measured.
        """
        gain = self.chain.gain[:, None]
        force = self.records.force[: len(self.bench.stretches), : len(gain)]
        return force.astype(float) * gain

    def at_places(self, stretch: int) -> np.ndarray:
        """Return (2, place, sample): force in N and motion in m with all sensors held."""
        motion = self.records.motion[stretch, len(self.chain.gain) :].astype(float)
        supports = 2 * len(self.model.support_names)
        force = np.zeros_like(motion)
        force[:supports] = self.records.support_force[stretch, :supports]
        rate = self.bench.schedule.sampling_frequency
        for element in range(len(self.model.element_names)):
            moved = motion[supports + element]
            force[supports + element] = element_force(self.model.local_laws, element, moved, rate)
        return np.stack([force, motion])

    def left_free(self, stretch: int, channel: int) -> np.ndarray:
        """Return (2, sample) m: the measured motion of a channel before its delay, and that of the
        model where it was left free, as it would be measured.
        """
        schedule = self.bench.schedule
        ratio = round(schedule.steps_per_second / schedule.sampling_frequency)
        motion = undelayed(
            self.bench.stretches[stretch].motion, self.chain.delay, schedule.steps_per_second
        )
        measured = motion[1 : 1 + schedule.samples * ratio : ratio, channel]
        free = self.records.motion[self.free[stretch, channel], channel].astype(float)
        return np.stack([measured, self.chain.gain[channel] * free])


def held_state(bench: Bench, point: Point, free: Sequence[tuple[int, int]]) -> HeldState:
    """Return the HeldState of a Point; free: [(stretch, channel)] of the runs with one left free.

    Raises ConfigError or ValueError for values that no structure can have.
    """
    model, chain = bench.structure.model(point), bench.structure.measuring(point)
    places = places_of(model)
    # the places are further sensors, which measure nothing and are not held
    count = len(places.names)
    more = ((0, count), (0, 0))
    observed = replace(
        model,
        sensor_shapes=np.hstack([model.sensor_shapes, places.shapes]),
        sensor_names=(*model.sensor_names, *places.names),
        sensor_positions=np.pad(model.sensor_positions, more, mode="edge"),
        sensor_directions=np.pad(model.sensor_directions, more, mode="edge"),
    )
    through = Measuring(
        np.r_[chain.gain, np.ones(count)], np.r_[chain.delay, np.zeros(count)], chain.force_gain
    )
    stretches = [
        replace(each, motion=np.pad(each.motion, ((0, 0), (0, count)))) for each in bench.stretches
    ]
    wide = replace(bench, stretches=tuple(stretches))
    lanes = [lane_of(wide, stretch, observed, through) for stretch in stretches]
    lanes += [
        lane_of(wide, stretches[number], observed, through, [channel]) for number, channel in free
    ]
    records = hold(lanes, bench.schedule, bench.threads, bench.held_below_Hz)
    runs = {key: len(stretches) + number for number, key in enumerate(free)}
    return HeldState(bench, model, places, chain, records, runs)
