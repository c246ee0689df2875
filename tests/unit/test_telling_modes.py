"""Which lowest records tell of linear effects by themselves."""

from vibroimpact.discrepancy.prepared import Prepared, telling_modes

LINEAR = Prepared([], None, linear_stage=True)
BENT = Prepared([], None, linear_stage=True, nonlinear_low=True)
SHOWN = [0, 2, 4]


def test_a_linear_record_tells_by_the_modes_that_it_shows():
    assert telling_modes(LINEAR, SHOWN) == SHOWN
    assert telling_modes(LINEAR, SHOWN, for_all=True) is None  # a bank is for other campaigns


def test_a_record_that_something_bends_leaves_linear_effects_to_simulation():
    """A preload beside nine times the damping: the damping was no candidate, and {offset,
    square-law drag} was told.
    """
    assert telling_modes(BENT, SHOWN) is None
    assert (
        telling_modes(BENT, SHOWN, quick=True) == SHOWN
    )  # where it must be quick, the three that come nearest are simulated


def test_a_record_without_modes_tells_nothing():
    assert telling_modes(Prepared([], None, linear_stage=False), None) is None
