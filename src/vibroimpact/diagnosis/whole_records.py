"""Whole records held to their measurement, cut in stretches that are held independently."""

from dataclasses import dataclass, replace

import numpy as np

from vibroimpact.integration.held_run import HeldRecords, hold
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.reduction.modal_model import ModalModel

from .bench import Bench, lane_of
from .constants import FORGET_S
from .explanations import Point, Structure
from .measurement.sensed_motion import orders
from .measurement.signals import Signals
from .measurement.stretches import FADE_S, held_band, rates_of, stretches_of, valid_samples

STRETCHES = LANES  # of a record: they fill the lanes of one batch
# Of the dampers, in units of the first mode, see Holder.unit_strength. Measured, correlation with
# the true force at the highest load with seven sensors: 0.98, 0.995, 0.996 at 2, 4 and 8; with two
# at the apex 0.80, 0.82, 0.82, 0.74 at 1, 2, 4 and 8, so that stronger is no safer.
STRENGTH = 4.0


@dataclass(frozen=True, eq=False)
class Held:
    """A record held to its measurement, in stretches that follow one another without a break.

    first_s: start of the first stretch. strength (channel,): of the dampers, N s/m.
    known (channel,): share of the power of the measured velocity that is signal.
    """

    record: int
    first_s: float
    strength: np.ndarray
    known: np.ndarray
    runs: HeldRecords

    @property
    def support_force(self) -> np.ndarray:
        """Return (2 support, sample) N: resultants on the structure, of all stretches in a row."""
        return np.concatenate(list(self.runs.support_force), axis=-1)


class Holder:
    """Holds records of a campaign to their measurement, under the model of one Point.

    model: of the point. rates, band (low, high) in Hz: of the motion that is held.
    """

    def __init__(self, structure: Structure, signals: Signals, point: Point):
        self.structure, self.signals, self.point = structure, signals, point
        self.model = structure.model(point)
        steps = structure.config.integration.steps_per_second
        self.rates = rates_of(signals.rate, steps, structure.decimation)
        self.band = held_band(signals, self.rates, first_mode_Hz(self.model))

    def stretch_times(self, record: int) -> tuple[float, float]:
        """Return (first_s, duration_s) of STRETCHES stretches that cover a record as far as its
        motion is known: lines are integrated with a fade at its ends, see stretches_of.
        """
        signals, rates = self.signals, self.rates
        whole = valid_samples(signals, record) / signals.rate
        fade = min(FADE_S, 0.25 * whole)
        first = 0.0 if signals.from_rest else fade + FORGET_S
        first = np.ceil(first * rates.sampling) / rates.sampling
        samples = int((whole - fade - first) / STRETCHES * rates.sampling)
        return float(first), samples / rates.sampling

    def hold(self, record: int, factor: float = STRENGTH) -> Held:
        """Return the Held of a record; factor: strength in units of unit_strength."""
        rates, structure = self.rates, self.structure
        first, duration = self.stretch_times(record)
        lead = np.ceil(FORGET_S * rates.sampling) / rates.sampling
        starts = first + duration * np.arange(STRETCHES)
        places = [(record, float(start - lead)) for start in starts]
        where = self.band, rates, structure.scale
        stretches = stretches_of(self.signals, places, lead + duration, *where)
        settled = round(lead * rates.steps_per_second)
        known = self._share_known([stretch.motion[settled:] for stretch in stretches])
        strength = factor * self.unit_strength() * known
        schedule = rates.schedule(duration, structure.config.integration.scheme, lead)
        bench = Bench(structure, tuple(stretches), schedule, self.band, 0.0)
        lanes = (
            lane_of(bench, each, self.model, structure.measuring(self.point)) for each in stretches
        )
        held = [replace(lane, strength=strength) for lane in lanes]
        runs = hold(held, schedule, highest_Hz=self.band[1])
        return Held(record, first, strength, known, runs)

    def unit_strength(self) -> float:
        """Return c in N s/m at which the modes in the band get, in the mean, a damping of rate
        omega_1 / 2 from all sensors: c mean_m(sum_s S_sm^2) = omega_1.
        """
        model = self.model
        inside = (model.frequencies > 0.1) & (model.frequencies < self.band[1])
        moved = np.mean(np.sum(model.sensor_shapes[inside] ** 2, axis=1))
        return 2.0 * np.pi * first_mode_Hz(model) / float(moved)

    def _share_known(self, motions):
        """Return (channel,) 0 to 1: the share of the measured velocity's power that is signal;
        noise is white to half the sampling frequency; motions: [(step, channel)] in m.

        The Wiener filter of a whole channel: a damper to noise would only drive the structure.
        """
        signals, steps_per_second = self.signals, self.rates.steps_per_second
        power = [np.mean(np.diff(motion, axis=0) ** 2, axis=0) for motion in motions]
        speed = steps_per_second * np.sqrt(np.mean(power, axis=0))
        frequency = np.linspace(*self.band, 2000)
        density = signals.noise**2 / (0.5 * signals.rate)
        factor = (2.0 * np.pi * frequency) ** (2.0 * (1.0 - orders(signals.kinds)[:, None]))
        noise = np.sqrt(density * np.trapezoid(factor, frequency, axis=-1)) * self.structure.scale
        share = np.divide(noise, speed, out=np.ones_like(speed), where=speed > 0.0)
        return np.maximum(1.0 - share**2, 0.0)


def first_mode_Hz(model: ModalModel) -> float:
    """Return the lowest frequency of the modes that are not rigid motion, Hz."""
    return float(model.frequencies[model.frequencies > 0.1].min())
