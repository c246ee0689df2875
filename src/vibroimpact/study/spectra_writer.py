"""Write the spectra of a batch of cases while it is integrated.

Memory holds one segment of the time series, whatever their duration.
"""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import numpy as np

from vibroimpact.integration.batch import Schedule
from vibroimpact.io.records import record_file
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.modal_model import ModalModel

from .case_spectra import SERIES, CaseSpectra
from .cases import Case
from .simulation import case_attributes


def spectra_writer(
    config: Any, model: ModalModel, paths: dict, attributes: dict, stopwatch: Stopwatch
) -> Callable:
    """Return the `writer` of simulate_cases that writes the spectra of each case.

    config: the sections that CaseSpectra reads.
    paths: {case: path}.
    attributes: of the files, in addition to those of the case.
    stopwatch: measures the CPU time of the transforms as "spectra".
    """

    @contextmanager
    def writer(schedule: Schedule, batch: list[Case]) -> Iterator[Callable]:
        with ExitStack() as open_files:
            spectra_of_batch = []
            for case in batch:
                spectra = CaseSpectra(
                    config,
                    model.sensor_names,
                    len(model.line_arc_length),
                    schedule.samples,
                    np.float32,
                )
                head = spectra.head.assign_attrs(
                    case_attributes(config, schedule, case) | spectra.head.attrs | attributes
                )
                file = record_file(paths[case], head, spectra.parts, spectra.sizes)
                spectra.write = open_files.enter_context(file)
                spectra_of_batch.append(spectra)

            def put(first: int, series: dict[str, np.ndarray]) -> None:
                with stopwatch("spectra"):
                    pieces = (series[name] for name in SERIES)
                    for spectra, *values in zip(spectra_of_batch, *pieces, strict=True):
                        spectra.put(*values)

            yield put
            for spectra in spectra_of_batch:
                spectra.finish()

    return writer
