"""Last step of the linear stage: linear effects identified from the lowest record, put into the
model or the measuring chain of a Workbench.
"""

import numpy as np

from .candidates import candidate_named
from .modal_fit import ModalFit
from .prepared import Prepared
from .workbench import Workbench, corrected_nuisance


def adopt(bench: Workbench, prepared: Prepared, linear_stage: bool | None = None) -> None:
    """Put the adopted linear effects of a Prepared into a Workbench: its model or its measuring
    chain contains them from here on, and its nuisances are computed with them.

    linear_stage: whether the lowest record identifies the linear structure with them; computed
    where None.
    """
    assert prepared.adopted is not None, "there is an effect to adopt"
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
