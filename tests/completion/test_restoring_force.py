"""The force of an added law in its figure: of one instant with its displacement, so that it lies on
the law.
"""

import numpy as np
import pytest

from tests import two_masses
from vibroimpact.campaign.file import write_campaign
from vibroimpact.completion.levels import levels_of
from vibroimpact.completion.prepare import prepared
from vibroimpact.completion.store import modes_of
from vibroimpact.completion.structure_file import StructureFile
from vibroimpact.completion.study import study_of
from vibroimpact.completion.trial import Records, Term, Trial
from vibroimpact.figures.discrepancy.completion import restoring_force

HALF_GAP, STIFFNESS = 2.0e-4, 4.0e4  # m, N/m: five times the joint of the masses


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """{curve: (displacement m, force N)} of the figure of a stop between the masses."""
    file = tmp_path_factory.mktemp("masses") / "own.nc"
    write_campaign(two_masses.campaign("nothing", periods=4), file)
    values, campaign, linear, _ = prepared(
        "own", str(file), StructureFile(source="x.yaml"), lambda *_: None
    )
    study, (levels, _, _) = study_of(values), levels_of(campaign)
    row = tuple(study.places["upper-lower"].get(name, 0.0) for name in ("upper", "lower"))
    stop = Term("clearance", "upper-lower", row, np.array([HALF_GAP, STIFFNESS]))
    sheet = restoring_force(
        study, Trial(modes_of(linear["base"]), (stop,)), Records(tuple(levels), study.band_Hz)
    )
    return {
        curve: (table["relative_displacement"], table["restoring_force"])
        for _, curve, table in sheet.tables
    }


def test_drawn_force_of_a_clearance_lies_on_its_law(drawn):
    displacement, force = drawn["12 N"]
    law = STIFFNESS * np.sign(displacement) * np.maximum(np.abs(displacement) - HALF_GAP, 0.0)
    assert np.abs(law).max() > 5.0
    assert np.abs(force - law).max() < 1.0e-3 * np.abs(law).max()


def test_drawn_force_of_a_clearance_takes_no_energy(drawn):
    displacement, force = drawn["12 N"]
    power = np.sum(force * np.gradient(displacement))
    assert abs(power) < 1.0e-3 * np.sum(np.abs(force * np.gradient(displacement)))
