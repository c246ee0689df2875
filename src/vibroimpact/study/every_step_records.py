"""Short runs recorded at every step, as `record.every_step` asks.

They begin at the initial state, without start-up and without output filter. If a support presses
at rest, the initial state is added to static equilibrium.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.excitation.force_stream import ForceStream, force_channels
from vibroimpact.integration.batch import Schedule, rest_state
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.every_step import Traces, integrate_every_step
from vibroimpact.integration.kernels.decimation import RATIO
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.integration.output_filter import LEAST_STAGES
from vibroimpact.integration.preload import seated
from vibroimpact.reduction.modal_model import ModalModel

from .cases import Case
from .record_variables import describe, place_attributes


def trace_cases(
    config: Any, model: ModalModel, cases: list[Case]
) -> Iterator[tuple[Case, xr.Dataset]]:
    """Yield (case, record) for every case, with values at every step; time 0 is the initial state.

    The records hold displacement and force of contacts and elements, and the energies of the run.
    Raises IntegrationError, ForceError.
    """
    rate = config.integration.steps_per_second
    steps = round(config.record.duration_s * rate)
    channels = model.drive_shapes.shape[1]
    for first in range(0, len(cases), LANES):
        batch = cases[first : first + LANES]
        forces = np.stack(
            [
                case.load_rms_N * _normalised_forces(config, case.seed, channels, steps, rate)
                for case in batch
            ],
            axis=-1,
        )
        offset = np.zeros((model.support_of_point.size, 2, len(batch)))

        def drive(at: int, count: int, forces: np.ndarray = forces) -> np.ndarray:
            return forces[at : at + count]

        gap = np.array([case.gap_m for case in batch])
        scheme = config.integration.scheme
        rest = None
        if model.presses_at_rest:  # at zero, pressing supports would hit the structure at the start
            schedule = Schedule(rate, rate / (LEAST_STAGES * RATIO), 0.0, 1.0, scheme)
            offset, rest = seated(model, schedule, gap, offset)
            rest = rest_state(model, schedule, gap, offset, rest)
        try:
            traces = integrate_every_step(model, rate, steps, gap, offset, drive, scheme, rest)
        except IntegrationError as error:
            raise error.of(batch) from error
        for lane, case in enumerate(batch):
            yield case, _dataset(config, model, traces, lane, case)


def _normalised_forces(
    config: Any, seed: int, channels: int, steps: int, rate: float
) -> np.ndarray:
    """Return (sample, force_channel) the force of a seed per newton of the load."""

    def values(excitation: Any, generator: np.random.Generator) -> np.ndarray:
        stream = ForceStream(excitation, generator, steps + 12, rate, slice(0, steps + 1))
        return stream.values(0, steps + 12)

    return np.stack(force_channels(config, seed, channels, values), axis=-1)


def _dataset(config: Any, model: ModalModel, traces: Traces, lane: int, case: Case) -> xr.Dataset:
    of_lanes = ("contact_displacement", "contact_force", "element_displacement", "element_force")
    values: dict[str, Any] = {
        name: getattr(traces, name)[lane] for name in (*of_lanes, "sliding_work", "slip_work")
    }
    values["run_energy"] = [value[lane] for value in traces.energy.values()]
    coordinates = {
        "step_time": traces.time,
        "run_term": list(traces.energy),
        "support": list(model.support_names),
        "element": list(model.element_names),
    }
    rate = {"steps_per_second": float(config.integration.steps_per_second)}
    return describe(values, coordinates, place_attributes(config, case) | rate)
