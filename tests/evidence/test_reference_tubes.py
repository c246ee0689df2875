"""R7 and R8: tubes against supports at their end, through the public interface, from their
configurations alone.
"""

from pathlib import Path

import numpy as np
import pytest

from evidence.validation.reference.runs import run, tube_checks
from evidence.validation.reference.tubes import cantilever_checks
from vibroimpact.config.reading import changed_config, load_config
from vibroimpact.reduction.reduced_model import build_model

FOLDER = Path(__file__).resolve().parents[2] / "config" / "reference"
FEW_MODES = {
    "basis.free_modes_to_Hz": 4000.0,
    "basis.attachment_shapes": False,
    "basis.constrained_modes_to_Hz": 1.0,
}


@pytest.fixture(scope="module")
def checks():
    """The checks of both cases, run once."""
    return tube_checks(FOLDER)


@pytest.mark.parametrize(("case", "count"), [("R7", 24), ("R8", 2)])
def test_reference_case_of_a_tube(checks, case, count):
    chosen = [check for check in checks if check.case == case]
    assert len(chosen) == count
    assert [check.row() for check in chosen if not check.passed] == []


def modes_in_the_plane(config):
    """The number of shapes that move the last support along its first direction."""
    shapes = build_model(config, motion_only=True).contact_shapes
    return int(np.sum(np.any(shapes[:, :, 0], axis=1)))


@pytest.mark.parametrize(("name", "modes"), [("r7_beam_launched", 10), ("r8_cantilever_gaps", 29)])
def test_modes_of_the_reference_tubes(name, modes):
    """R7 as published; R8 with 21 modes below 3 kHz and residual shapes."""
    assert modes_in_the_plane(load_config(FOLDER / f"{name}.yaml")) == modes


def test_a_cantilever_on_four_gaps_with_few_modes():
    """R8 with 24 modes and no residual shapes: 23 to 25 N of others with 12 to 40 modes."""
    config = changed_config(load_config(FOLDER / "r8_cantilever_gaps.yaml"), FEW_MODES)
    assert modes_in_the_plane(config) == 24
    assert 23.0 < cantilever_checks(run(config)[0])[0].ours < 25.0
