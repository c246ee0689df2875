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


def test_angles_are_compared_modulo_a_turn():
    np.testing.assert_allclose(
        offset(np.array([0.95, 0.95]), np.array([0.05, 0.05]), periodic=[1]), [0.90, -0.10]
    )


def test_optimum_is_clipped_to_simulated_points():
    np.testing.assert_allclose(
        within_simulated(np.array([0.47, 0.40]), PATH, BEST, ()), [0.42, 0.50]
    )


def test_optimum_between_simulated_points_is_kept():
    inside = np.array([0.35, 0.55])
    np.testing.assert_array_equal(within_simulated(inside, PATH, BEST, ()), inside)


def test_distant_points_do_not_widen_the_simulated_range():
    np.testing.assert_allclose(
        within_simulated(np.array([0.80, 0.90]), PATH, BEST, ()), [0.42, 0.62]
    )


def test_angles_are_not_clipped():
    np.testing.assert_allclose(
        within_simulated(np.array([0.47, 0.10]), PATH, BEST, [1]), [0.42, 0.10]
    )


def test_near_points_are_those_in_the_box():
    box = box_round(BEST, ())
    inside = np.all((PATH.parameters >= box[:, 0]) & (PATH.parameters <= box[:, 1]), axis=1)
    np.testing.assert_array_equal(near(PATH, BEST, ()), inside)
    assert np.ptp(box, axis=1) == pytest.approx(2.0 * NEAR)


def test_star_stays_in_range_and_angles_wrap():
    star = around(np.array([0.95, 0.95]), 0.12, [1])
    assert [1.0, 0.95] in star.tolist()
    assert any(np.allclose(point, [0.95, 0.07]) for point in star)


def test_mirror_images_are_all_other_signs():
    assert sorted(
        np.round(point, 12).tolist() for point in images(np.array([0.2, 0.3, 0.9]), (0, 2))
    ) == [[0.2, 0.3, 0.1], [0.8, 0.3, 0.1], [0.8, 0.3, 0.9]]


def test_known_points_are_not_simulated_again():
    assert unknown([np.array([0.3, 0.5001]), np.array([0.3, 0.7])], PATH, ()).tolist() == [
        [0.3, 0.7]
    ]
