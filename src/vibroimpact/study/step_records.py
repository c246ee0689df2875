"""Short runs kept at every step: the records of `record.every_step`, from the initial state on,
without start-up and without filter.
"""

import numpy as np

from vibroimpact.excitation.force_stream import normalised_force
from vibroimpact.integration.every_step import Traces, trace_lanes
from vibroimpact.integration.kernels import LANES
from vibroimpact.random_streams import random_generator
from vibroimpact.reduction.modal_model import ModalModel

from .cases import Case
from .record_variables import describe


def trace_cases(config, model: ModalModel, cases: list[Case]):
    """Yield (case, record dataset) for every case: contact and element displacement and force at
    every step, and the energies of the run.

    Time 0 is the initial state. Raises IntegrationError, ForceError.
    """
    rate = config.integration.steps_per_second
    steps = round(config.record.duration_s * rate)
    for first in range(0, len(cases), LANES):
        batch = cases[first : first + LANES]
        forces = np.stack(
            [case.load_rms_N * _normalised_force(config, case.seed, steps, rate) for case in batch],
            axis=-1,
        )[:, None]
        offset = np.zeros((model.support_of_point.size, 2, len(batch)))
        traces = trace_lanes(
            model,
            rate,
            steps,
            np.array([case.gap_m for case in batch]),
            offset,
            lambda at, count, forces=forces: forces[at : at + count],
            config.integration.scheme,
        )
        for lane, case in enumerate(batch):
            yield case, _dataset(config, model, traces, lane, case)


def _normalised_force(config, seed, steps, rate):
    generator = random_generator(config.seed, seed, "force")
    return normalised_force(
        config.excitation, generator, steps + 12, rate, slice(0, steps + 1), first_time_s=0.0
    )


def _dataset(config, model: ModalModel, traces: Traces, lane: int, case: Case):
    values = {
        name: getattr(traces, name)[lane]
        for name in (
            "contact_displacement",
            "contact_force",
            "element_displacement",
            "element_force",
        )
    }
    values |= {
        "run_energy": [value[lane] for value in traces.energy.values()],
        "sliding_work": traces.sliding_work[lane],
        "slip_work": traces.slip_work[lane],
    }
    coordinates = {
        "step_time": traces.time,
        "run_term": list(traces.energy),
        "support": list(model.support_names),
        "element": list(model.element_names),
    }
    attributes = {
        "study": config.study,
        "case": case.id,
        "load_rms_N": case.load_rms_N,
        "gap_m": case.gap_m,
        "seed": case.seed,
        "steps_per_second": float(config.integration.steps_per_second),
    }
    return describe(values, coordinates, attributes)
