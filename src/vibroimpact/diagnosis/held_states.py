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
from .law import Places, element_force, places_of, probed
from .measurement.sensor_chain import Measuring


@dataclass(frozen=True, eq=False)
class HeldState:
    """Runs of one Point on the stretches of a Bench; the first runs are those with all held.

    model: its sensors are the channels, then the Places. free {(stretch, channel): run}.
    """

    model: ModalModel
    places: Places
    chain: Measuring
    records: HeldRecords
    free: dict[tuple[int, int], int]

    @property
    def channels(self) -> int:
        """Return the number of channels."""
        return self.records.motion.shape[1] - len(self.places.names)

    def holding(self, stretch: int) -> np.ndarray:
        """Return (channel, sample) N: the holding force with all held, as a residual of what was
        measured.
        """
        force = self.records.force[stretch, : self.channels].astype(float)
        return force * self.chain.gain[: self.channels, None]

    def at_places(self, stretch: int, rate: float) -> tuple[np.ndarray, np.ndarray]:
        """Return (force (place, sample) N, motion (place, sample) m) with all sensors held.

        rate: of the samples, Hz.
        """
        motion = self.records.motion[stretch, self.channels :].astype(float)
        supports = 2 * len(self.model.support_names)
        force = np.zeros_like(motion)
        force[:supports] = self.records.support_force[stretch, :supports]
        for element in range(len(self.model.element_names)):
            moved = motion[supports + element]
            force[supports + element] = element_force(self.model.local_laws, element, moved, rate)
        return force, motion

    def left_free(self, stretch: int, channel: int) -> np.ndarray:
        """Return (sample,) m: motion of a channel that was left free, as it would be measured."""
        motion = self.records.motion[self.free[stretch, channel], channel].astype(float)
        return self.chain.gain[channel] * motion


def held_state(bench: Bench, point: Point, free: Sequence[tuple[int, int]]) -> HeldState:
    """Return the HeldState of a Point; free: [(stretch, channel)] of the runs with one left free.

    Raises ConfigError or ValueError for values that no structure can have.
    """
    model = bench.structure.model(point)
    places, chain = places_of(model), bench.structure.measuring(point)
    count = len(places.names)
    wide = replace(
        bench, stretches=tuple(_with_places(stretch, count) for stretch in bench.stretches)
    )
    chain = replace(
        chain, gain=np.r_[chain.gain, np.ones(count)], delay=np.r_[chain.delay, np.zeros(count)]
    )
    observed = probed(model, places)
    stretches = len(bench.stretches)
    wanted: list[tuple[int, tuple[int, ...]]] = [(number, ()) for number in range(stretches)]
    wanted += [(number, (channel,)) for number, channel in free]
    lanes = [
        lane_of(wide, wide.stretches[number], observed, chain, channels)
        for number, channels in wanted
    ]
    return HeldState(
        model,
        places,
        chain,
        hold(lanes, bench.schedule, bench.threads, bench.held_below_Hz),
        {key: stretches + number for number, key in enumerate(free)},
    )


def _with_places(stretch, count):
    """Return a Stretch with so many further sensors, which measure nothing."""
    rows = np.zeros((len(stretch.motion), count))
    return replace(
        stretch,
        motion=np.hstack([stretch.motion, rows]),
        moving=np.r_[stretch.moving, np.zeros(count, bool)],
    )


def measured_motion(bench: Bench, stretch: int, delay: np.ndarray) -> np.ndarray:
    """Return (channel, sample) m: the measured motion at the samples of the runs, before delays
    (channel,) in s.
    """
    schedule = bench.schedule
    ratio = round(schedule.steps_per_second / schedule.sampling_frequency)
    motion = undelayed(bench.stretches[stretch].motion, delay, schedule.steps_per_second)
    return motion[1 : 1 + schedule.samples * ratio : ratio].T
