"""The centreline: arc length, nearest points, directions and the mesh."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.geometry.directions import transverse_directions, unit_vector
from vibroimpact.geometry.mesh import mesh_arc_lengths

U_TUBE = SimpleNamespace(kind="u_tube", leg_length_m=0.7, bend_radius_m=0.3)
MESH = SimpleNamespace(elements_per_span=20, elements_per_bend=80)
QUARTER = 0.25 * np.pi * 0.3


def straight(length):
    return SimpleNamespace(kind="straight", length_m=length)


def bend(radius, angle, toward):
    return SimpleNamespace(kind="bend", radius_m=radius, angle_deg=angle, toward=toward)


def path(start, direction, segments):
    return build_centreline(
        SimpleNamespace(kind="path", start_m=start, start_direction=direction, segments=segments)
    )


def test_u_tube_passes_through_its_drawing():
    line = build_centreline(U_TUBE)
    assert line.length == pytest.approx(1.4 + 0.3 * np.pi, rel=1e-14)
    for arc_length, position in (
        (0.0, [-0.3, 0, 0]),
        (0.35, [-0.3, 0, 0.35]),
        (0.7, [-0.3, 0, 0.7]),
        (0.5 * line.length, [0, 0, 1.0]),
        (0.7 + QUARTER, [-0.3 / np.sqrt(2), 0, 0.7 + 0.3 / np.sqrt(2)]),
        (line.length, [0.3, 0, 0]),
    ):
        assert np.allclose(line.position(arc_length), position, rtol=0, atol=1e-12)


def test_tangent_has_exact_zeros_out_of_plane_and_after_the_bend():
    line = build_centreline(U_TUBE)
    assert line.direction(line.length).tolist() == [0.0, 0.0, -1.0]
    assert all(line.direction(place)[1] == 0.0 for place in np.linspace(0.0, line.length, 50))


def test_the_same_tube_as_a_path():
    by_path = path(
        [-0.3, 0, 0], [0, 0, 2.0], [straight(0.7), bend(0.3, 180.0, [1.0, 0, 0.5]), straight(0.7)]
    )
    line = build_centreline(U_TUBE)
    for place in np.linspace(0.0, line.length, 41):
        assert np.allclose(by_path.position(place), line.position(place), rtol=0, atol=1e-12)


def test_direction_is_the_derivative_of_position():
    line = path(
        [1.0, 2.0, 3.0],
        [1.0, 1.0, 0],
        [straight(0.2), bend(0.5, 70.0, [0, 0, 1.0]), bend(0.4, 30.0, [1.0, 0, 0])],
    )
    step = 1e-6
    for place in (0.1, 0.3, 0.7, 0.9):
        derivative = (line.position(place + step) - line.position(place - step)) / (2.0 * step)
        assert np.allclose(line.direction(place), derivative, rtol=0, atol=1e-9)


@pytest.mark.parametrize("arc_length", [0.0, 0.35, 0.7, 0.7 + QUARTER, 1.1, 1.9])
def test_locate_returns_arc_length_of_the_nearest_point(arc_length):
    line = build_centreline(U_TUBE)
    beside = (
        line.position(arc_length) + 0.004 * transverse_directions(line.direction(arc_length))[1]
    )
    assert line.locate(beside, "sensor") == pytest.approx(arc_length, abs=1e-9)


def test_locate_on_a_bend_of_more_than_half_a_turn():
    ring = path([1.0, 0, 0], [0, 1.0, 0], [bend(1.0, 330.0, [-1.0, 0, 0])])
    angle = np.deg2rad(300.0)
    assert ring.locate([np.cos(angle), np.sin(angle), 0.0], "sensor") == pytest.approx(
        angle, abs=1e-12
    )
    assert ring.locate([np.cos(-0.001), np.sin(-0.001), 0.0], "sensor") == 0.0


def test_a_point_off_the_tube_is_named_with_its_distance():
    line = build_centreline(U_TUBE)
    with pytest.raises(
        ValueError,
        match=(
            r"point apex at \[0.0, 0.0, 1.006\] m is 0.0060 m off the tube .* \[0.0000, 0.0000,"
            r" 1.0000\]"
        ),
    ):
        line.locate([0.0, 0.0, 1.006], "point apex")
    assert line.locate([0.0, 0.0, 1.0049], "point apex") == pytest.approx(0.5 * line.length)


def test_transverse_directions_follow_the_global_axes():
    assert transverse_directions(np.array([0.0, 0.0, -1.0])).tolist() == [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
    ]
    assert transverse_directions(np.array([1.0, 0.0, 0.0])).tolist() == [
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ]
    assert transverse_directions(unit_vector([1.0, 0.0, 1.0]))[1].tolist() == [
        0.0,
        1.0,
        0.0,
    ]  # x and z alike: z is left out
    for tangent in ([1.0, 0.0, 1.0], [1.0, 2.0, 3.0], [-1.0, 1.0, 1.0]):
        frame = np.vstack([unit_vector(tangent), transverse_directions(unit_vector(tangent))])
        assert np.allclose(frame @ frame.T, np.eye(3), rtol=0, atol=1e-14)


def test_a_direction_of_no_length_is_refused():
    with pytest.raises(ValueError, match="direction of length 0"):
        unit_vector([0.0, 0.0, 0.0])


def test_mesh_has_contact_points_as_nodes():
    line = build_centreline(U_TUBE)
    supports = [np.linspace(0.335, 0.365, 5), line.length - np.linspace(0.365, 0.335, 5)]
    nodes = mesh_arc_lengths(line, MESH, supports)
    assert len(nodes) == 2 * (20 + 4 + 20) + 80 + 1
    assert nodes[0] == 0.0 and nodes[-1] == pytest.approx(line.length)
    for points in supports:
        assert np.abs(nodes[:, None] - points).min(axis=0).max() < 1e-12
    assert np.diff(nodes)[:20] == pytest.approx(0.335 / 20)


def test_a_support_of_one_point_cuts_the_span_in_two():
    nodes = mesh_arc_lengths(build_centreline(U_TUBE), MESH, [np.array([0.35])])
    assert np.diff(nodes)[:40] == pytest.approx(0.35 / 20)


def test_a_support_on_the_bend_shares_its_elements_by_length():
    line = build_centreline(U_TUBE)
    middle = 0.5 * line.length
    nodes = mesh_arc_lengths(line, MESH, [np.array([middle - 0.015, middle, middle + 0.015])])
    on_bend = (nodes > 0.7 + 1e-9) & (nodes < line.length - 0.7 - 1e-9)
    assert (
        on_bend.sum() == 2 * 39 + 2 - 1
    )  # ceil(80 (0.15 pi - 0.015) / (0.3 pi)) = 39 on each side, 2 in the support


def test_neighbouring_supports_keep_a_span_between_them():
    line = build_centreline(
        SimpleNamespace(
            kind="path", start_m=[0, 0, 0], start_direction=[0, 0, 1], segments=[straight(1.0)]
        )
    )
    nodes = mesh_arc_lengths(line, MESH, [np.array([0.2, 0.3]), np.array([0.6, 0.7])])
    assert len(nodes) == 3 * 20 + 2 + 1


def test_a_direction_is_carried_from_any_place_to_any_other():
    """Round a bend in a plane, and back: across the plane nothing turns, in it all does."""
    line = path(
        [0, 0, 0],
        [0, 0, 1],
        [straight(0.2), bend(0.3, 90.0, [1, 0, 0]), bend(0.4, 60.0, [0, 1, 0]), straight(0.1)],
    )
    given = unit_vector([0.6, 0.8, 0.3])
    whole = line.carried(given, line.length)
    half_way = line.carried(given, 0.45)
    np.testing.assert_allclose(line.carried(half_way, line.length, 0.45), whole, atol=1e-12)
    back = line.carried(whole, 0.1, line.length)
    np.testing.assert_allclose(back, unit_vector([0.6, 0.8, 0.0]), atol=1e-12)
    for at in (0.1, 0.45, 0.8):
        assert abs(line.carried(given, at, 0.05) @ line.direction(at)) < 1e-12
