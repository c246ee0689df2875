"""The spectra of a batch, made and written while it is integrated: memory holds one segment of the
time series, whatever their duration.
"""

from contextlib import ExitStack, contextmanager

import numpy as np

from vibroimpact.records import RecordFile

from .case_spectra import SpectraOfCase
from .simulation import case_attributes

READ = ("displacement", "acceleration", "line_displacement")


def spectra_files(config, model, paths: dict, attributes: dict, stopwatch):
    """The `keep` of simulate_cases that writes the spectra of each case to its path {case: path},
    with attributes beside those of the case.
    """

    @contextmanager
    def keep(schedule, batch):
        with ExitStack() as open_files:
            made = []
            for case in batch:
                spectra = SpectraOfCase(
                    config,
                    model.sensor_names,
                    len(model.line_arc_length),
                    schedule.samples,
                    np.float32,
                )
                head = spectra.head.assign_attrs(
                    case_attributes(config, schedule, case) | spectra.head.attrs | attributes
                )
                spectra.keep = open_files.enter_context(
                    RecordFile(paths[case], head, spectra.parts, spectra.sizes)
                ).put
                made.append(spectra)

            def put(first, series):
                with stopwatch("spectra"):
                    for spectra, *values in zip(
                        made, *(series[name] for name in READ), strict=True
                    ):
                        spectra.put(*values)

            yield put
            for spectra in made:
                spectra.finish()

    return keep
