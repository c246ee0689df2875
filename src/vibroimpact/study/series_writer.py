"""Write the time series of a batch of cases while it is integrated.

Memory holds a piece of them, whatever their duration.
"""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import numpy as np

from vibroimpact.integration.batch import Schedule
from vibroimpact.io.records import record_file
from vibroimpact.reduction.modal_model import ModalModel

from .cases import Case
from .record_variables import VARIABLES, describe
from .simulation import case_attributes, sample_times

PIECE = 8192  # samples written at a time: many small writes cost more than the samples
SERIES = ("displacement", "acceleration", "line_displacement", "support_force", "force")


def series_writer(config: Any, model: ModalModel, paths: dict, attributes: dict) -> Callable:
    """Return the `writer` of simulate_cases that writes the time series of each case.

    config: its key study is read.
    paths: {case: path}; if it is empty the series are dropped.
    attributes: of the files, in addition to those of the case.
    """

    @contextmanager
    def writer(schedule: Schedule, batch: list[Case]) -> Iterator[Callable]:
        if not paths:
            yield lambda first, series: None
            return
        coordinates = {
            "time": sample_times(schedule),
            "sensor": list(model.sensor_names),
            "line_arc_length": model.line_arc_length,
            "support": list(model.support_names),
        }
        head = describe({}, coordinates, {})
        parts = {name: VARIABLES[name] for name in SERIES}
        waiting: list[dict[str, np.ndarray]] = []
        with ExitStack() as open_files:
            puts = []
            for case in batch:
                own = head.assign_attrs(case_attributes(config, schedule, case) | attributes)
                file = record_file(paths[case], own, parts, {"direction": 2})
                puts.append(open_files.enter_context(file))

            def put(first: int, series: dict[str, np.ndarray]) -> None:
                waiting.append({name: values.copy() for name, values in series.items()})
                held = sum(piece["force"].shape[-1] for piece in waiting)
                last = first + series["force"].shape[-1]
                if held < PIECE and last < schedule.samples:
                    return
                for name in SERIES:
                    whole = np.concatenate([piece[name] for piece in waiting], axis=-1)
                    for write, values in zip(puts, whole, strict=True):
                        write(name, np.s_[..., last - held : last], values)
                waiting.clear()

            yield put

    return writer
