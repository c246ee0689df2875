"""Where contact points are, and what share of its support each carries."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.geometry.support_spans import contact_places
from vibroimpact.structure.contact.supports import place_contact_points

LINE = build_centreline(SimpleNamespace(kind="u_tube", leg_length_m=0.7, bend_radius_m=0.3))


def support(**changes):
    """Return a support of the stand-in tube, with some keys changed."""
    keys = {
        "name": "left",
        "at_m": [-0.3, 0.0, 0.35],
        "height_m": 0.03,
        "points": 5,
        "stiffness_N_per_m": 4.0e6,
        "gap_factor": 1.0,
        "centre_offset_m": [0.0, 0.0],
    }
    return SimpleNamespace(**{**keys, **changes})


def test_points_are_evenly_spaced_with_both_edges():
    assert contact_places(LINE, support()) == pytest.approx([0.335, 0.3425, 0.35, 0.3575, 0.365])
    assert contact_places(LINE, support(points=1)) == pytest.approx([0.35])


@pytest.mark.parametrize(
    ("z", "points", "expected"),
    [
        (0.015, 3, [0.0, 0.015, 0.03]),  # flush with the end
        (0.01502, 3, [0.0, 0.01501, 0.03002]),  # as good as flush: the edge lies on the end
        (0.0, 3, [0.0, 0.0075, 0.015]),  # centred on the end: cut there
        (0.0, 1, [0.0]),
        (0.7 - 0.015, 2, [0.67, 0.7]),  # flush with the joint of leg and bend
    ],
)
def test_a_support_at_an_end_ends_there(z, points, expected):
    places = contact_places(LINE, support(at_m=[-0.3, 0.0, z], points=points))
    assert places == pytest.approx(expected, abs=1e-12)
    assert set(places.tolist()) >= {0.0, 0.7} & set(expected)  # exactly, or a short element is left


def test_bars_of_a_lattice_have_all_points_at_two_heights():
    lattice = SimpleNamespace(kind="lattice", normal=None, angle_deg=0.0, spacing_m=0.1)
    contact = place_contact_points(
        LINE,
        [support(profile=lattice, points=2, gap_factor=(1.0, 1.2)), support(at_m=[0.3, 0, 0.3])],
    )
    assert contact.arc_length[:4] == pytest.approx([0.285, 0.315, 0.385, 0.415])
    assert contact.pair.tolist() == [0, 0, 1, 1] + [0] * 5
    assert contact.support.tolist() == [0] * 4 + [1] * 5
    assert contact.stiffness[:4].tolist() == [2.0e6] * 4  # each pair has the whole stiffness
    assert contact.weight[:4].tolist() == [0.25] * 4
    assert contact.gap_factor[:4].tolist() == [1.0, 1.2] * 2


def test_directions_do_not_swap_along_a_support_on_a_bend():
    """Halfway round the bend, x and z are equally aligned with the tube."""
    at = [-0.3 * np.sqrt(0.5), 0.0, 0.7 + 0.3 * np.sqrt(0.5)]
    contact = place_contact_points(LINE, [support(at_m=at, points=9)])
    tangents = np.array([LINE.direction(place) for place in contact.arc_length])
    assert np.abs(np.einsum("pdx,px->pd", contact.directions, tangents)).max() < 1e-12
    first = contact.directions[:, 0]
    assert (np.sum(first[:-1] * first[1:], axis=1) > 0.99).all()


def test_a_number_is_the_total_and_a_list_is_per_point():
    contact = place_contact_points(
        LINE,
        [
            support(centre_offset_m=(1e-5, -2e-5)),
            support(
                name="right",
                at_m=[0.3, 0, 0.35],
                points=2,
                stiffness_N_per_m=(1.0e6, 3.0e6),
                gap_factor=(1.0, 0.5),
                centre_offset_m=((1e-5, 0.0), (0.0, 2e-5)),
            ),
        ],
    )
    assert contact.stiffness.tolist() == [8.0e5] * 5 + [1.0e6, 3.0e6]
    assert contact.weight.tolist() == [0.2] * 5 + [0.25, 0.75]
    assert contact.gap_factor.tolist() == [1.0] * 6 + [0.5]
    assert contact.centre_offset[[0, 5, 6]].tolist() == [[1e-5, -2e-5], [1e-5, 0.0], [0.0, 2e-5]]
    assert contact.support.tolist() == [0] * 5 + [1] * 2


def test_positions_and_directions_on_the_right_leg():
    contact = place_contact_points(LINE, [support(at_m=[0.3, 0, 0.35])])
    assert np.allclose(
        contact.position,
        [[0.3, 0.0, z] for z in (0.365, 0.3575, 0.35, 0.3425, 0.335)],
        rtol=0,
        atol=1e-12,
    )
    assert contact.directions.tolist() == [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]] * 5


def test_no_support_gives_no_contact_points():
    contact = place_contact_points(LINE, [])
    assert (
        contact.position.shape == (0, 3)
        and contact.directions.shape == (0, 2, 3)
        and contact.centre_offset.shape == (0, 2)
    )


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"at_m": [-0.3, 0.02, 0.35]}, "support left at .* is 0.0200 m off the tube"),
        (
            {"stiffness_N_per_m": [1.0e6, 1.0e6]},
            "support left: stiffness_N_per_m has 2 values for 5 points",
        ),
        ({"gap_factor": [1.0] * 4}, "support left: gap_factor has 4 values for 5 points"),
        (
            {"centre_offset_m": [[0.0, 0.0]] * 3},
            "support left: centre_offset_m has 3 values for 5 points",
        ),
    ],
)
def test_mistakes_are_named(changes, message):
    with pytest.raises(ValueError, match=message):
        place_contact_points(LINE, [support(**changes)])


def test_overlapping_supports_are_refused():
    with pytest.raises(ValueError, match="supports left and upper overlap"):
        place_contact_points(LINE, [support(name="upper", at_m=[-0.3, 0, 0.37]), support()])
