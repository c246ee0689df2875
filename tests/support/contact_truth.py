"""Campaigns of the independent code with the contact forces that it really had."""

from dataclasses import dataclass

import numpy as np

from evidence.truth import march
from evidence.truth.campaign import (
    CHANNELS,
    Plan,
    apply_instruments,
    channels_of,
    forces,
    noise_rms,
    records_of,
    simulate_records,
)
from evidence.truth.march import FAST_HZ
from evidence.truth.model_file import write_model
from evidence.truth.writer import write_campaign


@dataclass(frozen=True, eq=False)
class TrueForces:
    """What the independent code had at its plates.

    force (record, plate, 2, sample), motion (record, plate, 2, sample): N on the tube and m of the
    plate's centre line, FAST_HZ samples a second, unfiltered. measured (record, 2 plate, sample):
    the force as a perfect sensor of the campaign gives it.
    """

    force: np.ndarray
    motion: np.ndarray
    measured: np.ndarray
    rate: float

    def of(self, record, plate, first_s, last_s):
        """{quantity: value} over a part of a record, by the definitions of the library."""
        part = slice(int(first_s * FAST_HZ), int(last_s * FAST_HZ))
        one, two = self.force[record, plate][:, part]
        speed_1, speed_2 = (np.gradient(self.motion[record, plate], axis=-1) * FAST_HZ)[:, part]
        size = np.hypot(one, two)
        touching = size > 0.0
        return {
            "rms_force": np.sqrt(np.mean(size**2)),
            "peak_force": size.max(),
            "contact_fraction": touching.mean(),
            "impact_rate": np.sum(touching[1:] & ~touching[:-1]) / (last_s - first_s),
            "wear_work_rate": np.mean(np.abs(one * speed_2 - two * speed_1)),
        }


def contact_campaign(folder, **plan):
    """(path of the campaign, path of its model, TrueForces) of a Plan; none of its channels is at a
    plate but those of contact forces.
    """
    beam = Plan((0,)).beam
    extra = tuple(
        (plate.arc, axis, "displacement")
        for plate in beam.holders
        for axis in (beam.across(plate.arc), "y")
    )
    made = Plan(**{"seed": (0,), "contact_force": True, **plan, "channels": CHANNELS + extra})
    force = forces(made)
    response, fast = _with_fast_series(made, force)
    noise = noise_rms(made, response)
    force_seen, seen = apply_instruments(made, force, response, noise)
    channels, drive = channels_of(made)
    first, last = len(CHANNELS), len(CHANNELS) + len(extra)
    kept = [*range(first), *range(last, len(channels))]
    path, model = folder / "campaign.nc", folder / "model.yaml"
    write_model(made, model)
    write_campaign(
        path,
        force_seen,
        seen[:, kept],
        [channels[k] for k in kept],
        drive,
        records_of(made),
        {"sampling_frequency": made.sampling, "start_up": made.start_up},
        None,
    )
    motion, reaction = (
        np.array([series.reshape(len(beam.holders), 2, -1) for series in kind])
        for kind in ([m[first:last] for m, _ in fast], [r for _, r in fast])
    )
    return path, model, TrueForces(reaction, motion, response[:, last:], made.sampling)


def _with_fast_series(plan, force):
    """(responses, [(displacements, reactions) of each record at FAST_HZ])."""
    kept, run = [], march.Stretch.run

    def kept_run(self, force, second, start, ramp=None, recorded=False):
        out = run(self, force, second, start, ramp, recorded)
        if recorded:
            kept.append(out)
        return out

    march.Stretch.run = kept_run
    try:
        return simulate_records(plan, force)[0], kept
    finally:
        march.Stretch.run = run
