"""The time series of a batch, written while it is integrated: memory holds a piece of them,
whatever their duration.
"""

from contextlib import ExitStack, contextmanager

import numpy as np
import xarray as xr

from vibroimpact.records import RecordFile, write_record

from .record_variables import VARIABLES, split_record
from .simulation import case_attributes, sample_times

PIECE = 8192  # samples written at a time: many small writes cost more than the samples
SERIES = ("displacement", "acceleration", "line_displacement", "support_force", "force")


def series_files(config, model, paths: dict, attributes: dict):
    """The `keep` of simulate_cases that writes the series of each case to its path {case: path},
    with attributes beside those of the case.

    Without any path the series are dropped.
    """

    @contextmanager
    def keep(schedule, batch):
        if not paths:
            yield lambda first, series: None
            return
        coordinates = {
            "time": ("time", sample_times(schedule), {"units": "s"}),
            "sensor": list(model.sensor_names),
            "line_arc_length": ("line_point", model.line_arc_length, {"units": "m"}),
            "support": list(model.support_names),
        }
        parts = {
            name: (dims, dtype, {"units": unit, "long_name": long_name})
            for name, (dims, dtype, unit, long_name) in VARIABLES.items()
            if name in SERIES
        }
        waiting = []
        with ExitStack() as open_files:
            heads = [
                xr.Dataset({}, coordinates, case_attributes(config, schedule, case) | attributes)
                for case in batch
            ]
            files = [
                open_files.enter_context(RecordFile(paths[case], head, parts, {"direction": 2}))
                for case, head in zip(batch, heads, strict=True)
            ]

            def put(first, series):
                waiting.append({name: values.copy() for name, values in series.items()})
                held = sum(piece["force"].shape[-1] for piece in waiting)
                last = first + series["force"].shape[-1]
                if held < PIECE and last < schedule.samples:
                    return
                for name in SERIES:
                    whole = np.concatenate([piece[name] for piece in waiting], axis=-1)
                    for file, values in zip(files, whole, strict=True):
                        file.put(name, np.s_[..., last - held : last], values)
                waiting.clear()

            yield put

    return keep


def write_parts(record, path, series_path=None):
    """Write a record: its statistics to a path, the time series that it holds itself, if any (see
    step_records), to another.
    """
    statistics, series = split_record(record)
    write_record(statistics, path)
    if series.data_vars:
        write_record(series, series_path)
