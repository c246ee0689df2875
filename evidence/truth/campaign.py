"""One campaign from a plan: rig, forces, records, instruments, file and the sealed truth."""

import json
import os
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np

from evidence.truth.geometry import TUBES, Beam
from evidence.truth.hidden import IN_RIG
from evidence.truth.march import Drive, run_record
from evidence.truth.measure import INSTRUMENTS, Measured
from evidence.truth.model_file import write_model
from evidence.truth.reduction import reduce_rig
from evidence.truth.rig import Rig
from evidence.truth.strength import excess
from evidence.truth.writer import write_campaign

BAND = (5.0, 200.0)
# The kinds of channels that a beam's motion is measured by, and their units. Velocity is the one
# that drawn campaigns leave out for now: see draw.KINDS.
UNITS = {"acceleration": "m s-2", "velocity": "m s-1", "displacement": "m"}
CHANNELS = (
    ("apex", "y"),
    ("apex", "x"),
    ("bend45_right", "y"),
    ("left_leg_upper", "y"),
    ("left_leg_upper", "x"),
    ("right_leg_upper", "y"),
    ("left_leg_lower", "y"),
)
UNIT = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
LEVELS = ((0.5, 1.3, "fit"), (3.0, 1.3, "fit"), (10.0, 1.3, "fit"), (10.0, 0.9, "holdout"))
TWINS = 2  # runs with and without the hidden effects, for their strength
FORCE, SCATTER, GAINS, NOISE, START, SECOND = range(6)  # random streams of a campaign


@dataclass(frozen=True)
class Plan:
    """The definition of a campaign.

    effects: (id, {parameter: value}) each, of the rig or of the instruments.
    kind: of the acceptance table: see draw.SHARES.
    tube: a name of geometry.TUBES, or a Beam; changes: of its fields.
    channels: (place, direction) or (place, direction, kind) each; a place is a name or an arc
    length [m], a direction an axis or a vector.
    levels: (N RMS, gap in % of the diameter, "fit" or "holdout") each.
    duration: s of a record. sampling: Hz. start_up: "rest" or "stationary".
    band: Hz, of the force. drive_direction: (3,) across the beam. on_base: no force acts; all that
    holds the beam has an acceleration of the RMS of the levels, in m/s² along drive_direction, and
    accelerations and velocities of channels are absolute. What an effect adds beside the beam, such
    as a loose mass or the mass of a plate, is not driven by it.
    *_scatter: one sigma, relative; scatter_law: "normal", "uniform" or "laplace".
    force_gain: of the measured force over the true one.
    noise: RMS relative to the largest channel RMS of the lowest level, among channels of a kind.
    drive_force: campaign file to take the forces from.
    """

    seed: tuple
    effects: tuple = ()
    kind: str = "nothing"
    tube: str | Beam = "stand_in"
    changes: dict = field(default_factory=dict)
    channels: tuple = CHANNELS
    levels: tuple = LEVELS
    duration: float = 20.0
    sampling: float = 2048.0
    start_up: str = "rest"
    band: tuple = BAND
    drive_direction: tuple = UNIT["y"]
    on_base: bool = False
    steps_per_second: int = 163840
    gain_scatter: float = 0.02
    frequency_scatter: float = 0.003
    damping_scatter: float = 0.10
    scatter_law: str = "normal"
    force_gain: float = 1.0
    noise: float = 0.01
    contact_force: bool = False
    noise_floor: bool = False
    drive_force: str | None = None

    def stream(self, *which):
        """A random generator of this campaign alone."""
        return np.random.default_rng([*self.seed, *which])

    def scattered(self, deviation, count, *which):
        """(count,) factors about 1 with a relative deviation, by the plan's law."""
        rng = self.stream(*which)
        if self.scatter_law == "uniform":
            unit = np.sqrt(3.0) * rng.uniform(-1.0, 1.0, count)
        elif self.scatter_law == "laplace":
            unit = rng.laplace(0.0, np.sqrt(0.5), count)
        else:
            unit = rng.standard_normal(count)
        return 1.0 + deviation * unit

    def drive_direction_at(self, s):
        """(3,) direction at s [m] that corresponds to the force: as far in plane and out of it."""
        beam, force = self.beam, np.array(self.drive_direction)
        inward = float(force @ beam.across(beam.places["drive"]))
        along = inward * beam.across(s) + force[1] * np.array(UNIT["y"])
        return tuple(((along / np.linalg.norm(along)).round(6) + 0.0).tolist())

    @property
    def beam(self) -> Beam:
        """The beam as the user knows it."""
        given = TUBES[self.tube] if isinstance(self.tube, str) else self.tube
        return given.with_changes(**self.changes)


def band_limited(rng, samples, sampling, band=BAND):
    """(time,) Gaussian noise of unit RMS, flat within `band` Hz, periodic over the record."""
    frequency = np.fft.rfftfreq(samples, 1.0 / sampling)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    spectrum = np.zeros(len(frequency), complex)
    spectrum[inside] = rng.standard_normal(inside.sum()) + 1j * rng.standard_normal(inside.sum())
    series = np.fft.irfft(spectrum, samples)
    return series / series.std()


def forces(plan):
    """(record, time) N: drawn, or those measured in the campaign file `drive_force`."""
    if plan.drive_force is not None:
        import netCDF4

        with netCDF4.Dataset(plan.drive_force) as file:
            return np.asarray(file["force"][:, 0], float)
    samples = round(plan.duration * plan.sampling)
    return np.array(
        [
            load * band_limited(plan.stream(FORCE, number), samples, plan.sampling, plan.band)
            for number, (load, _, _) in enumerate(plan.levels)
        ]
    )


def build_rig(plan, hidden=True):
    """The Rig of a plan, with its effects where `hidden`."""
    rig = Rig.bare(plan.beam)
    rig.drive_direction, rig.on_base = plan.drive_direction, plan.on_base
    for name, parameters in plan.effects if hidden else ():
        if name not in INSTRUMENTS:
            IN_RIG[name](rig, **parameters)
    return rig


def sensors_of(plan):
    """(place, (3,) direction, kind) of the channels of the beam's motion."""
    rows = []
    for place, direction, *kind in plan.channels:
        along = UNIT[direction] if isinstance(direction, str) else tuple(direction)
        rows.append((place, along, kind[0] if kind else "acceleration"))
    return rows


def simulate_records(plan, force, hidden=True, start_stream=0, only=None):
    """Noise-free responses (record, channel, time) and shares of time in contact (record, plate).

    only: numbers of the records to simulate; None for all.
    """
    rig, sensors = build_rig(plan, hidden), sensors_of(plan)
    scatter = {
        "frequency": lambda n: plan.scattered(plan.frequency_scatter, n, SCATTER, 0),
        "damping": lambda n: np.maximum(plan.scattered(plan.damping_scatter, n, SCATTER, 1), 0.3),
    }
    longer = rig.tube.length / plan.beam.length  # where the model has another length
    reduced = reduce_rig(
        rig,
        [
            (place if isinstance(place, str) else longer * place, direction)
            for place, direction, _ in sensors
        ],
        scatter,
    )
    factors = np.array([plate.gap_factor for plate in rig.plates])
    found, contact = [], []
    for number, (load, percent, _) in enumerate(plan.levels):
        if only is not None and number not in only:
            continue
        second = rig.unmeasured and rig.unmeasured[2] * load * band_limited(
            plan.stream(SECOND, number), force.shape[1], plan.sampling, plan.band
        )
        record = run_record(
            reduced,
            Drive(force[number], plan.sampling, second, plan.start_up == "stationary"),
            factors * percent * 0.01 * plan.beam.outer_diameter,
            plan.steps_per_second,
            plan.stream(START, number, start_stream),
            number * force.shape[1] / plan.sampling,
        )
        motion = [getattr(record, kind)[row] for row, (*_, kind) in enumerate(sensors)]
        if plan.on_base:
            motion = [
                own
                + np.dot(direction, plan.drive_direction) * base_motion(plan, force[number], kind)
                for own, (_, direction, kind) in zip(motion, sensors, strict=True)
            ]
        plates = record.reaction.reshape(-1, force.shape[1]) if plan.contact_force else []
        found.append(np.array([*motion, *plates]))
        contact.append(record.contact)
    return np.array(found), np.array(contact)


def base_motion(plan, acceleration, kind):
    """(time,) what a sensor of a kind shows of an acceleration (time,) of the base from rest: none
    of it for a displacement, which is measured from the base.
    """
    if kind == "displacement":
        return np.zeros_like(acceleration)
    if kind == "acceleration":
        return acceleration
    spectrum = np.fft.rfft(acceleration)
    omega = 2.0 * np.pi * np.fft.rfftfreq(acceleration.size, 1.0 / plan.sampling)
    spectrum[1:] /= 1j * omega[1:]
    spectrum[0] = 0.0
    velocity = np.fft.irfft(spectrum, acceleration.size)
    return velocity - velocity[0]


def channels_of(plan):
    """The channels and the drive as the file describes them."""
    beam, places = plan.beam, plan.beam.places
    channels = [
        {
            "name": f"{place}_{axis}" if isinstance(place, str) else f"s{number}",
            "units": UNITS[kind],
            "kind": kind,
            "point": beam.position(places.get(place, place)),
            "direction": direction,
        }
        for number, ((place, axis, *_), (_, direction, kind)) in enumerate(
            zip(plan.channels, sensors_of(plan), strict=True), 1
        )
    ]
    if plan.contact_force:
        channels += [
            {
                "name": f"plate_{holder.name}_{axis}",
                "units": "N",
                "kind": "contact_force",
                "direction": UNIT["y"] if axis == "y" else beam.across(holder.arc),
                "point": beam.position(holder.arc),
            }
            for holder in beam.holders
            for axis in ("x", "y")
        ]
    drive = {
        "name": "shaker",
        "point": beam.position(places["drive"]),
        "direction": plan.drive_direction,
    }
    if plan.on_base:
        drive |= {"name": "table", "kind": "base_acceleration", "units": "m s-2"}
    return channels, drive


def noise_rms(plan, response):
    """(channel,) RMS of the noise, from responses (record, channel, time) of all records."""
    rms = np.sqrt(np.mean(response**2, axis=-1))
    lowest = int(np.argmin([load for load, _, _ in plan.levels]))
    kinds = np.array([channel["kind"] for channel in channels_of(plan)[0]])
    noise = np.zeros(len(kinds))
    for kind in set(kinds):
        # A force cell has one range for all levels: its noise is a share of the largest record, as
        # there may be no contact in the lowest.
        seen = rms if kind == "contact_force" else rms[lowest : lowest + 1]
        noise[kinds == kind] = plan.noise * seen[:, kinds == kind].max()
    return noise


def gains_of(plan):
    """(channel,) gains of the sensors."""
    return plan.scattered(plan.gain_scatter, len(channels_of(plan)[0]), GAINS)


def apply_instruments(plan, force, response, noise, stream=0, hidden=True):
    """(force, response) as the instruments give them.

    noise: (channel,) RMS. hidden: with the hidden faults of the instruments.
    """
    names = [channel["name"] for channel in channels_of(plan)[0]]
    gains = gains_of(plan)
    data = Measured(plan.force_gain * force, response * gains[:, None], names, plan.sampling)
    for name, parameters in plan.effects if hidden else ():
        if name in INSTRUMENTS:
            INSTRUMENTS[name](data, **parameters)
    data.response += noise[:, None] * plan.stream(NOISE, stream).standard_normal(response.shape)
    return data.force, data.response


def judged_levels(plan):
    """Numbers of the records that strength is measured on, that of the largest load last: those
    held out, or that of the largest load where none is.
    """
    rising = sorted(range(len(plan.levels)), key=lambda number: plan.levels[number][0])
    return [number for number in rising if plan.levels[number][2] == "holdout"] or rising[-1:]


def strength(plan, force, seen, noise):
    """strength.excess of the judged records over the same records with nothing hidden; of a pair
    also `beside`: the floors of each effect over the same records with the other one alone.

    seen: (record, channel, time) responses.
    """
    rows, count = sorted(judged_levels(plan)), len(plan.channels)

    def twins(plan, hidden, first):
        """The records from TWINS other initial states, as measured."""
        runs = [simulate_records(plan, force, hidden, first + k, rows)[0] for k in range(TWINS)]
        return [
            apply_instruments(plan, force[rows], run, noise, first + k, hidden)[1][:, :count]
            for k, run in enumerate(runs)
        ]

    again = twins(plan, True, 1 + TWINS)

    def over(bare):
        """strength.excess over the records of twins."""
        return excess(seen[rows][:, :count], bare, again, noise[:count], plan.sampling, plan.band)

    found = over(twins(plan, False, 1))
    if len(plan.effects) == 2:
        found["beside"] = [
            over(twins(replace(plan, effects=(other,)), True, 1 + 2 * TWINS))["floors"]
            for other in plan.effects[::-1]
        ]
    return found


def records_of(plan):
    """{name, gap m, split, repeat} of every record."""
    return [
        {
            "name": f"L{load:g}_G{percent:g}_{number}",
            "gap": percent * 0.01 * plan.beam.outer_diameter,
            "split": split,
            "repeat": sum(other == (load, percent, split) for other in plan.levels[:number]),
        }
        for number, (load, percent, split) in enumerate(plan.levels)
    ]


def make_campaign(plan, path, truth_path=None, twin=True, model_path=None):
    """Write the campaign of a plan to `path` and its truth to `truth_path`; return the truth.

    twin: also run it with nothing hidden, to state its strength.
    model_path: file of the model that a user has of the beam; None writes none.
    """
    force = forces(plan)
    response, contact = simulate_records(plan, force)
    noise = noise_rms(plan, response)
    force_seen, seen = apply_instruments(plan, force, response, noise)
    truth = {
        "file": Path(path).name,
        **asdict(plan),
        "contact_share": contact.round(4).tolist(),
        "gains": gains_of(plan).round(4).tolist(),
    }
    if twin:
        truth["strength"] = strength(plan, force, seen, noise)
    if model_path is not None:
        write_model(plan, model_path)
    write_campaign(
        path,
        force_seen,
        seen,
        *channels_of(plan),
        records_of(plan),
        {"sampling_frequency": plan.sampling, "start_up": plan.start_up},
        noise if plan.noise_floor else None,
    )
    if truth_path is not None:
        write_whole(truth_path, json.dumps(truth, indent=1, default=float) + "\n")
    return truth


def write_whole(path, text):
    """Write a text file, under a temporary name until it is complete."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.part{os.getpid()}")
    part.write_text(text, encoding="utf-8")
    os.replace(part, path)
