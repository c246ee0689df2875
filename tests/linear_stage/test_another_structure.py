"""A structure is not called another one where an effect explains its lowest record better."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.linear_stage import lowest_record, priors
from vibroimpact.linear_stage.prepared import Prepared

FLUID = {"name": "fluid_added_mass_damping@tube", "unit": [0.8, 0.2], "gain": 6000.0}


def bench():
    """Return what stands for a Workbench whose fit is not that of a linear structure."""
    fit = SimpleNamespace(residual=np.array([4.0 * priors.LINEAR_RESIDUAL]))
    return SimpleNamespace(linear_stage=True, measured_fit=fit)


@pytest.mark.parametrize(
    ("explains", "structure_as_much", "leads"),
    [(True, False, True), (True, True, False), (False, False, False)],
)
def test_an_effect_beside_contact_leads(monkeypatch, explains, structure_as_much, leads):
    """An effect that explains a record which touches is not adopted, and leads all the same."""
    for name, found in {
        "driven_channels": lambda _: np.array([True]),
        "linear_rows": lambda *_: [FLUID],
        "nameable": lambda *_: True,
        "adopt": lambda *_: None,
        "adopted_explains": lambda *_: explains,
        "structure_says_as_much": lambda *_: structure_as_much,
    }.items():
        monkeypatch.setattr(lowest_record, name, found)
    out = Prepared([], nonlinear_low=True)
    _, found_to_lead = lowest_record.read_all(bench(), bench, out, {}, ())
    assert found_to_lead == leads and out.adopted is None
