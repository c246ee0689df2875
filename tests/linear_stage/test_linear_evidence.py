"""Which lowest records tell of linear effects by themselves."""

from vibroimpact.linear_stage.linear_analysis import telling_modes
from vibroimpact.linear_stage.prepared import Prepared

LINEAR = Prepared([], None, linear_stage=True)
BENT = Prepared([], None, linear_stage=True, nonlinear_low=True)
SHOWN = [0, 2, 4]


def test_linear_record_determines_effects_by_its_modes():
    assert telling_modes(LINEAR, SHOWN) == SHOWN


def test_nonlinear_record_defers_linear_effects():
    """A preload beside nine times the damping: the damping was no candidate, and {offset,
    square-law drag} was told.
    """
    assert telling_modes(BENT, SHOWN) is None


def test_record_without_modes_determines_no_effect():
    assert telling_modes(Prepared([], None, linear_stage=False), None) is None
