"""Simulation of the cases of a study: forces in, one record per case out."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.excitation.force_stream import ForceStream, force_channels
from vibroimpact.excitation.random_streams import random_generator
from vibroimpact.integration.batch import (
    ENERGY_TERMS,
    BatchResult,
    Schedule,
    integrate_batch,
    rest_state,
)
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.integration.preload import seated
from vibroimpact.integration.run_statistics import statistics
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.modal_model import ModalModel

from .cases import Case
from .every_step_records import trace_cases
from .record_variables import describe, place_attributes


def simulate_cases(
    config: Any,
    model: ModalModel,
    cases: list[Case],
    writer: Callable | None = None,
    stopwatch: Stopwatch | None = None,
) -> Iterator[tuple[Case, xr.Dataset]]:
    """Yield (case, record) for every case, integrating LANES of them at a time.

    If a support presses at rest, a run starts from static equilibrium; any other starts from
    zero. The initial state of the configuration is added. A record does not depend on the other
    cases of the list. Its variables, dimensions and units
    are those of record_variables.VARIABLES.

    config: the stage's settings, with study, seed, record, excitation, integration and
    structure.section.
    writer: if given, the records hold no time series. writer(schedule, batch) is a context
    manager, entered once per batch of cases; it yields put(first sample, {variable: (case, ...,
    sample)}), which receives the series piece by piece. See series_writer and spectra_writer.
    stopwatch: measures the CPU time of kernel, output filter and force.

    With record.every_step the records are those of every_step_records; writer is not used.
    Raises IntegrationError with load, gap and seed of a case that diverges, ForceError.
    """
    stopwatch = Stopwatch() if stopwatch is None else stopwatch
    if config.record.every_step:
        yield from trace_cases(config, model, cases)
        return
    schedule = schedule_of(config)
    with stopwatch("force"):
        channels = model.drive_shapes.shape[1]
        forces = {
            seed: seed_forces(config, schedule, seed, channels)
            for seed in sorted({case.seed for case in cases})
        }
    for first in range(0, len(cases), LANES):
        batch = cases[first : first + LANES]
        drive = drive_of_lanes([(forces[case.seed], case.load_rms_N) for case in batch])
        timed = partial(stopwatch.time, "force", drive)
        lanes = _integrated(config, model, schedule, batch, timed, writer)
        stopwatch.add(lanes.stopwatch)
        for lane, case in enumerate(batch):
            yield case, record_dataset(config, model, schedule, lanes, lane, case)


def schedule_of(config: Any) -> Schedule:
    """Return the Schedule that a configuration's integration and record state."""
    step, record = config.integration, config.record
    rates = step.steps_per_second, record.sampling_frequency_Hz
    return Schedule(*rates, step.start_up_s, record.duration_s, step.scheme)


def _integrated(config, model, schedule, batch, drive, writer) -> BatchResult:
    """Return the result of a batch of cases, from rest or static equilibrium on."""
    gap = np.array([case.gap_m for case in batch])
    offset = np.stack([imperfection(config, model, case) for case in batch], axis=-1)
    offset, rest = seated(model, schedule, gap, offset)
    if model.presses_at_rest:  # at zero, pressing supports would hit the structure at the start
        rest = rest_state(model, schedule, gap, offset, rest)
    with nullcontext() if writer is None else writer(schedule, batch) as put:
        try:
            return integrate_batch(
                model,
                schedule,
                gap=gap,
                imperfection=offset,
                drive=drive,
                receive=(
                    None
                    if put is None
                    else lambda at, *pieces, put=put: put(at, time_series(model, *pieces))
                ),
                initial=rest,
            )
        except IntegrationError as error:
            raise error.of(batch) from error


def seed_forces(config: Any, schedule: Schedule, seed: int, channels: int) -> list[ForceStream]:
    """Return the force of a seed in each channel at every step of the run, per newton of the load.

    It has RMS 1 over the recorded window, or on average over seeds if the excitation says so.
    All loads scale this force and all gaps share it. Scaling load and gap by a power of two
    therefore scales a record bit for bit.
    """
    rate = schedule.steps_per_second
    first = round(schedule.start_up * rate) + 1
    recorded = slice(first, first + round(schedule.duration * rate))
    first_time = -schedule.start_up - 1.0 / rate

    def stream(excitation: Any, generator: np.random.Generator) -> ForceStream:
        return ForceStream(excitation, generator, schedule.steps + 2, rate, recorded, first_time)

    return force_channels(config, seed, channels, stream)


def imperfection(config: Any, model: ModalModel, case: Case) -> np.ndarray:
    """Return offsets (contact_point, 2) in m of the centres of the obstacles.

    They are drawn once per seed, as a fraction of the gap. Without them an exactly out-of-plane
    force would leave the in-plane motion to round-off.
    """
    draw = random_generator(config.seed, case.seed, "imperfection").uniform(
        -1.0, 1.0, (model.support_of_point.size, 2)
    )
    return draw * (config.integration.imperfection * case.gap_m)


def drive_of_lanes(lanes: Sequence[tuple[list[ForceStream], float]]) -> Callable:
    """Return the Drive of runs side by side, each with the channels of its force and its load."""

    def drive(first: int, count: int) -> np.ndarray:
        out = np.empty((count, len(lanes[0][0]), len(lanes)))
        made: dict[int, list[np.ndarray]] = {}
        for lane, (streams, load) in enumerate(lanes):
            if id(streams) not in made:
                made[id(streams)] = [stream.values(first, count) for stream in streams]
            for channel, values in enumerate(made[id(streams)]):
                np.multiply(values, load, out=out[:, channel, lane])
        return out

    return drive


def time_series(
    model: ModalModel, displacement: np.ndarray, acceleration: np.ndarray, force: np.ndarray
) -> dict[str, np.ndarray]:
    """Return the time series of a record by variable, (..., sample) each.

    displacement, acceleration, force (..., channel, sample): as in batch.BatchResult.
    """
    sensors, supports = model.sensor_shapes.shape[1], len(model.support_names)
    on_structure = force[..., : 2 * supports, :]
    return {
        "displacement": displacement[..., :sensors, :],
        "acceleration": acceleration,
        "line_displacement": displacement[..., sensors:, :],
        "support_force": -on_structure.reshape(*force.shape[:-2], supports, 2, force.shape[-1]),
        "force": force[..., 2 * supports, :],
    }


def record_dataset(
    config: Any, model: ModalModel, schedule: Schedule, lanes: BatchResult, lane: int, case: Case
) -> xr.Dataset:
    """Return the record of one lane of a batch, without time series if the lanes hold none."""
    series: dict[str, np.ndarray] = {}
    if lanes.displacement is not None:
        assert lanes.acceleration is not None and lanes.force is not None
        series = time_series(
            model, lanes.displacement[lane], lanes.acceleration[lane], lanes.force[lane]
        )
    coordinates = {
        **({"time": sample_times(schedule)} if series else {}),
        "sensor": list(model.sensor_names),
        "line_arc_length": model.line_arc_length,
        "support": list(model.support_names),
        "section": list(model.section_names),
        "element": list(model.element_names),
        "energy_term": list(ENERGY_TERMS),
        "energy_time": lanes.energy_time,
    }
    tallies = statistics(lanes, lane, schedule.steps_per_second)
    over_limit = tallies["stress_peak"].max(initial=0.0) > config.record.stress_limit_Pa
    values = series | tallies | energy_balance(lanes, lane, model.conservative)
    if len(model.fluid_laws.velocity):
        record_s = lanes.steps / schedule.steps_per_second
        values["fluid_power"] = lanes.tally["fluid_work"][0, lane] / record_s
    values["stress_flag"] = np.asarray(over_limit, np.int8)
    return describe(values, coordinates, case_attributes(config, schedule, case))


def sample_times(schedule: Schedule) -> np.ndarray:
    """Return the times (time,) in s of the samples of a record."""
    return np.arange(schedule.samples) / schedule.sampling_frequency


def case_attributes(config: Any, schedule: Schedule, case: Case) -> dict:
    """Return the attributes that every file of a case carries."""
    return place_attributes(config, case) | {
        "sampling_frequency": float(schedule.sampling_frequency),
        "steps_per_second": float(schedule.steps_per_second),
        "start_up_s": float(schedule.start_up),
    }


def energy_balance(lanes: BatchResult, lane: int, conservative: bool) -> dict[str, np.ndarray]:
    """Return the energies of one lane and the residuals of its energy balance.

    Residuals are relative to the largest energy supplied, by work or at the start.

    energy_residual: the contact work is the trapezoidal sum of f du. This is an identity of the
    scheme; it holds to round-off.
    potential_energy_residual: the potential energy of contacts and elements takes the place of
    their work. It measures the time step; NaN unless they are conservative.
    contact_dissipation: J, work on contacts and elements less the energy stored in their springs.
    """
    energy = lanes.energy[lane]
    terms = dict(zip(ENERGY_TERMS, energy, strict=True))
    mechanical = terms["kinetic"] + terms["elastic"]
    start = mechanical[0]
    supplied = terms["input_work"] - terms["dissipated"] + start
    scale = max(abs(terms["input_work"][-1]), start)
    exact = mechanical - supplied - terms["contact_work"]
    stored = terms["contact_potential"] - terms["contact_potential"][0]
    return {
        "energy": energy,
        "energy_residual": np.max(np.abs(exact)) / scale,
        "potential_energy_residual": (
            np.max(np.abs(mechanical + stored - supplied)) / scale if conservative else np.nan
        ),
        "contact_dissipation": (-terms["contact_work"] - stored)[-1],
        "fixed_point_residual": lanes.fixed_point_residual[lane] * lanes.contraction,
    }
