"""Linear effects that the lowest record tells of, put into a Workbench."""

import numpy as np

from .candidates import candidate_named
from .modal_fit import ModalFit
from .workbench import corrected_nuisance


def adopt(bench, prepared, linear_stage=None):
    """Put the adopted linear effects into a Workbench: the model or the measuring chain has it from
    here on, nuisances are those beside it.

    linear_stage: whether the lowest record tells of the linear structure with them; looked for
    where it is None.
    """
    candidate = candidate_named(prepared.adopted["name"])
    physical = candidate.physical(prepared.adopted["unit"], prepared.scales)
    values = candidate.variant(bench.values, physical)
    if values is not bench.values:
        bench.rebase(values)
    if linear_stage is not None:
        bench.linear_stage = linear_stage
    if prepared.fit is not None:
        bench.measured_fit = ModalFit(
            **{name: np.array(value) for name, value in prepared.fit.items()}
        )
    bench.measuring = candidate.measuring(physical, bench.signals.names)
    bench.nuisance = corrected_nuisance(bench)[0] if bench.linear_stage else None
