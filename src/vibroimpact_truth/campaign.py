"""One campaign from a plan: rig, forces, records, instruments, file and the sealed truth."""

import json
import os
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

from vibroimpact_truth.geometry import TUBES, named_places
from vibroimpact_truth.hidden import EFFECTS, STRANGERS
from vibroimpact_truth.march import run_record
from vibroimpact_truth.measure import INSTRUMENTS, Measured
from vibroimpact_truth.reduction import reduce_rig
from vibroimpact_truth.rig import Rig
from vibroimpact_truth.strength import excess
from vibroimpact_truth.writer import write_campaign

SAMPLING = 2048.0
BAND = (5.0, 200.0)
CHANNELS = (
    ("apex", "y"),
    ("apex", "x"),
    ("bend45_right", "y"),
    ("left_leg_upper", "y"),
    ("left_leg_upper", "x"),
    ("right_leg_upper", "y"),
    ("left_leg_lower", "y"),
)
UNIT = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0)}
LEVELS = ((0.5, 1.3, "fit"), (3.0, 1.3, "fit"), (10.0, 1.3, "fit"), (10.0, 0.9, "holdout"))
TWINS = 3  # runs with and without the hidden effects, for their strength
FORCE, SCATTER, GAINS, NOISE, START, SECOND = range(6)  # random streams of a campaign


@dataclass(frozen=True)
class Plan:
    """The definition of a campaign.

    effects: (id, {parameter: value}) each, of the rig or of the instruments.
    levels: (N RMS, gap in % of the diameter, "fit" or "holdout") each.
    duration: s of a record.
    *_scatter: one sigma, relative.
    noise: RMS relative to the largest channel RMS of the lowest level.
    drive_force: campaign file to take the forces from.
    """

    seed: tuple
    effects: tuple = ()
    arm: str = "null"
    tube: str = "stand_in"
    changes: dict = field(default_factory=dict)
    levels: tuple = LEVELS
    duration: float = 20.0
    steps_per_second: int = 163840
    gain_scatter: float = 0.02
    frequency_scatter: float = 0.003
    damping_scatter: float = 0.10
    noise: float = 0.01
    contact_force: bool = False
    noise_floor: bool = False
    drive_force: str | None = None

    def stream(self, *which):
        """A random generator of this campaign alone."""
        return np.random.default_rng([*self.seed, *which])


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
    samples = round(plan.duration * SAMPLING)
    return np.array(
        [
            load * band_limited(plan.stream(FORCE, number), samples, SAMPLING)
            for number, (load, _, _) in enumerate(plan.levels)
        ]
    )


def build_rig(plan, hidden=True):
    """The Rig of a plan, with its effects where `hidden`."""
    rig = Rig.bare(TUBES[plan.tube].with_changes(**plan.changes))
    for name, parameters in plan.effects if hidden else ():
        if name not in INSTRUMENTS:
            {**EFFECTS, **STRANGERS}[name](rig, **parameters)
    return rig


def simulate_records(plan, force, hidden=True, start_stream=0, only=None):
    """Noise-free responses (record, channel, time) and shares of time in contact (record, plate).

    only: split of the records to simulate; None for all.
    """
    rig = build_rig(plan, hidden)
    scatter = {
        "frequency": (
            lambda n: 1.0 + plan.frequency_scatter * plan.stream(SCATTER, 0).standard_normal(n)
        ),
        "damping": lambda n: np.maximum(
            1.0 + plan.damping_scatter * plan.stream(SCATTER, 1).standard_normal(n), 0.3
        ),
    }
    reduced = reduce_rig(rig, [(place, UNIT[axis]) for place, axis in CHANNELS], scatter)
    factors = np.array([plate.gap_factor for plate in rig.plates])
    found, contact = [], []
    for number, (load, percent, split) in enumerate(plan.levels):
        if only not in (None, split):
            continue
        second = rig.unmeasured and rig.unmeasured[2] * load * band_limited(
            plan.stream(SECOND, number), force.shape[1], SAMPLING
        )
        record = run_record(
            reduced,
            force[number],
            factors * percent * 0.01 * rig.tube.outer_diameter,
            SAMPLING,
            plan.steps_per_second,
            plan.stream(START, number, start_stream),
            number * force.shape[1] / SAMPLING,
            second,
        )
        plates = (
            record.reaction.reshape(-1, force.shape[1])
            if plan.contact_force
            else np.zeros((0, force.shape[1]))
        )
        found.append(np.concatenate([record.acceleration, plates]))
        contact.append(record.contact)
    return np.array(found), np.array(contact)


def channels_of(plan):
    """The channels and the drive as the file describes them."""
    tube = TUBES[plan.tube].with_changes(**plan.changes)
    arcs = named_places(tube)
    channels = [
        {
            "name": f"{place}_{axis}",
            "units": "m s-2",
            "kind": "acceleration",
            "point": tube.position(arcs[place]),
            "direction": UNIT[axis],
        }
        for place, axis in CHANNELS
    ]
    if plan.contact_force:
        channels += [
            {
                "name": f"plate_{side}_{axis}",
                "units": "N",
                "kind": "contact_force",
                "direction": UNIT[axis],
                "point": tube.position(tube.leg_height(side, tube.plate_height)),
            }
            for side in ("left", "right")
            for axis in ("x", "y")
        ]
    drive = {"name": "shaker", "point": tube.position(arcs["drive"]), "direction": (0.0, 1.0, 0.0)}
    return channels, drive


def noise_rms(plan, response):
    """(channel,) RMS of the noise, from responses (record, channel, time) of all records."""
    rms = np.sqrt(np.mean(response**2, axis=-1))
    lowest = int(np.argmin([load for load, _, _ in plan.levels]))
    accelerations = np.arange(response.shape[1]) < len(CHANNELS)
    # A force cell has one range for all levels: its noise is a share of the largest record, as
    # there may be no contact in the lowest.
    return plan.noise * np.where(
        accelerations, rms[lowest, accelerations].max(), rms[:, ~accelerations].max(initial=0.0)
    )


def apply_instruments(plan, force, response, noise, stream=0, hidden=True):
    """(force, response) as the instruments give them.

    noise: (channel,) RMS. hidden: with the hidden faults of the instruments.
    """
    names = [channel["name"] for channel in channels_of(plan)[0]]
    gains = 1.0 + plan.gain_scatter * plan.stream(GAINS).standard_normal(len(names))
    data = Measured(force.copy(), response * gains[:, None], names, SAMPLING)
    for name, parameters in plan.effects if hidden else ():
        if name in INSTRUMENTS:
            INSTRUMENTS[name](data, **parameters)
    data.response += noise[:, None] * plan.stream(NOISE, stream).standard_normal(response.shape)
    return data.force, data.response


def strength(plan, force, seen, noise):
    """strength.excess of the hold-out records over the same records with nothing hidden.

    seen: (record, channel, time) responses.
    """
    rows = [number for number, (*_, split) in enumerate(plan.levels) if split == "holdout"]
    count = len(CHANNELS)

    def twins(hidden, first):
        """Hold-out records from TWINS other initial states, as measured."""
        runs = [
            simulate_records(plan, force, hidden, first + k, "holdout")[0] for k in range(TWINS)
        ]
        return [
            apply_instruments(plan, force[rows], run, noise, first + k, hidden)[1][:, :count]
            for k, run in enumerate(runs)
        ]

    return excess(
        seen[rows][:, :count], twins(False, 1), twins(True, 1 + TWINS), noise[:count], SAMPLING
    )


def make_campaign(plan, path, truth_path=None, twin=True):
    """Write the campaign of a plan to `path` and its truth to `truth_path`; return the truth.

    twin: also run it with nothing hidden, to state its strength.
    """
    force = forces(plan)
    response, contact = simulate_records(plan, force)
    noise = noise_rms(plan, response)
    force_seen, seen = apply_instruments(plan, force, response, noise)
    tube = TUBES[plan.tube].with_changes(**plan.changes)
    records = [
        {
            "name": f"L{load:g}_G{percent:g}_{number}",
            "gap": percent * 0.01 * tube.outer_diameter,
            "split": split,
            "repeat": sum(other == (load, percent, split) for other in plan.levels[:number]),
        }
        for number, (load, percent, split) in enumerate(plan.levels)
    ]
    channels, drive = channels_of(plan)
    truth = {"file": Path(path).name, **asdict(plan), "contact_share": contact.round(4).tolist()}
    if twin:
        truth["strength"] = strength(plan, force, seen, noise)
    write_campaign(
        path,
        force_seen,
        seen,
        channels,
        drive,
        records,
        SAMPLING,
        noise if plan.noise_floor else None,
    )
    if truth_path is not None:
        truth_path = Path(truth_path)
        truth_path.parent.mkdir(parents=True, exist_ok=True)
        part = truth_path.with_name(f"{truth_path.name}.part{os.getpid()}")
        part.write_text(json.dumps(truth, indent=1, default=float) + "\n")
        os.replace(part, truth_path)
    return truth
