"""The error of a right model, and what a good model of a linear structure is off by anyway."""

from dataclasses import replace

import numpy as np
import pytest

from tests.diagnosis.played import played
from vibroimpact.diagnosis.bench import counts, holding_lines, log_power, with_model_error
from vibroimpact.diagnosis.constants import MODEL_ERROR
from vibroimpact.diagnosis.explanations import Point, Term


@pytest.fixture(scope="module")
def bench(comparison):
    return with_model_error(played(comparison.fitted(), Point()))


def test_only_contact_leaves_an_error(bench):
    low, high = bench.stretches[0], bench.stretches[-1]
    assert np.all(low.error == 0.0)  # it does not touch
    assert np.all(high.error[high.moving] > 0.0)


def test_the_error_is_a_share_of_what_contact_makes(bench):
    free = Point((Term("contact_stiffness", "all", (1.0,)),))  # N/m: as good as none
    bare = replace(bench, stretches=tuple(replace(own, error=0.0) for own in bench.stretches))
    touching, apart = holding_lines(bare, [Point(), free])
    moving, own = bench.stretches[-1].moving, bench.stretches[-1].error
    made = np.exp(log_power(bare, touching - apart)[-1])
    np.testing.assert_allclose(own[moving], MODEL_ERROR**2 * made[moving], rtol=0.02)


def test_no_line_counts_less_than_the_error(bench):
    lines = 1.0e-6 * holding_lines(bench, [Point()])[0]
    moving = counts(bench, lines)[-1] > 0
    least = np.log(bench.stretches[-1].error[moving])
    np.testing.assert_allclose(log_power(bench, lines)[-1][moving], least, atol=1e-3)


@pytest.mark.parametrize(("share", "within"), [(0.004, True), (0.05, False)])
def test_a_mass_that_moves_no_mode_is_within_the_priors(comparison, share, within):
    mass = share * comparison.sizes["mass_per_length"]
    term = Term("fluid_added_mass_damping", "tube", (mass, 0.0))
    assert comparison.within_priors(term) == within


def test_a_turned_force_moves_no_mode_and_is_an_effect(comparison):
    assert not comparison.within_priors(Term("force_misalignment", "about_tube", (0.5,)))
