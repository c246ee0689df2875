"""Points of a normalised parameter space: what is near, what was simulated, and what differs by a
sign or by a turn.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.discrepancy.neighbourhood import (
    NEAR,
    around,
    box_round,
    images,
    near,
    offset,
    unknown,
    within_simulated,
)

PATH = SimpleNamespace(
    parameters=np.array([[0.30, 0.50], [0.42, 0.50], [0.30, 0.62], [0.90, 0.95]])
)
BEST = PATH.parameters[0]


def test_an_angle_is_near_the_short_way_round():
    np.testing.assert_allclose(
        offset(np.array([0.95, 0.95]), np.array([0.05, 0.05]), periodic=[1]), [0.90, -0.10]
    )


def test_what_is_judged_lies_within_the_points_near_the_best():
    np.testing.assert_allclose(
        within_simulated(np.array([0.47, 0.40]), PATH, BEST, ()), [0.42, 0.50]
    )


def test_what_lies_between_simulated_points_stays():
    inside = np.array([0.35, 0.55])
    np.testing.assert_array_equal(within_simulated(inside, PATH, BEST, ()), inside)


def test_points_far_from_the_best_do_not_widen_what_was_simulated():
    np.testing.assert_allclose(
        within_simulated(np.array([0.80, 0.90]), PATH, BEST, ()), [0.42, 0.62]
    )


def test_an_angle_has_no_end_to_be_held_at():
    np.testing.assert_allclose(
        within_simulated(np.array([0.47, 0.10]), PATH, BEST, [1]), [0.42, 0.10]
    )


def test_near_and_the_box_round_agree():
    box = box_round(BEST, ())
    inside = np.all((PATH.parameters >= box[:, 0]) & (PATH.parameters <= box[:, 1]), axis=1)
    np.testing.assert_array_equal(near(PATH, BEST, ()), inside)
    assert np.ptp(box, axis=1) == pytest.approx(2.0 * NEAR)


def test_a_star_stays_in_the_range_and_an_angle_wraps():
    star = around(np.array([0.95, 0.95]), 0.12, [1])
    assert [1.0, 0.95] in star.tolist()
    assert any(np.allclose(point, [0.95, 0.07]) for point in star)


def test_images_are_all_other_signs():
    assert sorted(
        np.round(point, 12).tolist() for point in images(np.array([0.2, 0.3, 0.9]), (0, 2))
    ) == [[0.2, 0.3, 0.1], [0.8, 0.3, 0.1], [0.8, 0.3, 0.9]]


def test_what_is_known_is_not_simulated_again():
    assert unknown([np.array([0.3, 0.5001]), np.array([0.3, 0.7])], PATH, ()).tolist() == [
        [0.3, 0.7]
    ]
