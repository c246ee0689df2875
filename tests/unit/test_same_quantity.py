"""Pairs by another law of one of their quantities: which they are, and where they are searched from."""

from types import SimpleNamespace

import numpy as np

from vibroimpact.discrepancy import conclusion
from vibroimpact.discrepancy.candidates import candidate_named
from vibroimpact.discrepancy.same_quantity import exchanged, starts

PAIR = candidate_named("hertz@all+foliate_obstacle@all")


def test_a_law_is_exchanged_for_another_of_its_quantity_alone():
    assert [(pair.name, number) for pair, number in exchanged(PAIR)] == [("contact_stiffness@all+foliate_obstacle@all", 0)]
    assert exchanged(candidate_named("gap@all+foliate_obstacle@all")) == []
    assert exchanged(candidate_named("hertz@all+contact_stiffness@all")) == []


def test_it_is_searched_from_where_the_other_effect_is_at_every_value_of_its_own():
    (pair, number), = exchanged(PAIR)
    points = starts(pair, number, SimpleNamespace(candidate=PAIR, unit=np.array([0.3, 0.7, 0.5])))
    np.testing.assert_allclose(points[:, 1:], np.tile([0.7, 0.5], (len(points), 1)))
    np.testing.assert_allclose(points[:, :1], pair.first.design())


def test_the_job_that_concludes_counts_its_own_seconds(tmp_path):
    assert 0.0 < conclusion.elapsed(tmp_path) < 3600.0
