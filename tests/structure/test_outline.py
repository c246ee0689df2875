"""The free space of the tube's centre in a hole, against closed forms and the energy of contact."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.integration.stored_energy import stored_energy
from vibroimpact.structure.contact.outline import (
    facing_angle,
    hole_outline,
    radial_gap,
    static_force,
    support_gap,
)

GAP = 3.0e-4


def circular():
    """A round hole."""
    return SimpleNamespace(kind="circular")


def planes(*normals):
    """Flat stops."""
    return SimpleNamespace(kind="planes", normals_deg=normals)


def lobes(count, depth_m=1.0e-3, angle_deg=0.0):
    """A lobed hole."""
    return SimpleNamespace(kind="lobes", count=count, depth_m=depth_m, angle_deg=angle_deg)


PROFILES = [
    circular(),
    planes(0.0, 90.0, 180.0, 270.0),
    planes(20.0, 140.0, 260.0),
    planes(30.0),
    lobes(4, angle_deg=45.0),
    lobes(3),
]


def area(outline):
    """The area of a closed outline, by Gauss's formula."""
    x, y = outline.T
    return 0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])


def energy(profile, displacement):
    """The energy (point,) that the integrator books for a tube at some places (point, 2)."""
    stops = len(profile.normals_deg) if profile.kind == "planes" else 1
    normals = np.deg2rad(getattr(profile, "normals_deg", (0.0,)))
    angle, one = np.deg2rad(getattr(profile, "angle_deg", 0.0)), np.ones((stops, 1))
    laws = SimpleNamespace(
        contact_point=np.zeros(stops, int),
        lobes=np.full(stops, getattr(profile, "count", 0)),
        lobe_depth=one * getattr(profile, "depth_m", 0.0),
        lobe_cosine=one * np.cos(angle),
        lobe_sine=one * np.sin(angle),
        normal_1=np.cos(normals)[:, None],
        normal_2=np.sin(normals)[:, None],
        flat=np.full(stops, int(profile.kind == "planes")),
        gap=one * GAP,
        stiffness=one * 1.0e6,
        hertz=0.0 * one,
        stick_flexibility=0.0 * one,
        slider_flexibility=np.zeros((0, 1)),
        element_row=np.zeros(0, int),
        **{
            name: np.zeros((0, 1))
            for name in (
                "saturation_limit",
                "saturation_stiffness",
                "element_stiffness",
                "quadratic",
                "cubic",
            )
        },
    )
    count = len(displacement)
    state = SimpleNamespace(
        row_displacement=displacement.T,
        row_force=np.zeros((2, count)),
        friction_force=np.zeros((stops, count)),
        slider_force=np.zeros((0, count)),
    )
    contact = SimpleNamespace(
        row_1=np.array([0]),
        row_2=np.array([1]),
        offset_1=np.zeros((1, count)),
        offset_2=np.zeros((1, count)),
        plain=np.zeros(1),
        stiffness=np.ones((1, 1)),
    )
    return stored_energy(contact, laws, state)


@pytest.mark.parametrize("profile", PROFILES, ids=lambda profile: str(vars(profile)))
def test_contact_begins_at_the_outline(profile):
    outline = hole_outline(profile, GAP, 0.0)
    if profile.kind == "planes":  # the sides that no stop closes are no contact
        normals = np.deg2rad(profile.normals_deg)
        beyond = outline @ np.array([np.cos(normals), np.sin(normals)])
        outline = outline[np.isclose(beyond, GAP).any(axis=1)]
        assert len(outline) >= 2
    assert np.all(energy(profile, 0.999 * outline) == 0.0)
    assert np.all(energy(profile, 1.001 * outline) > 0.0)


@pytest.mark.parametrize(
    ("profile", "expected"),
    [
        (circular(), np.pi * GAP**2),
        (planes(0.0, 90.0, 180.0, 270.0), 4.0 * GAP**2),
        (planes(0.0, 60.0, 120.0, 180.0, 240.0, 300.0), 6.0 * np.tan(np.pi / 6.0) * GAP**2),
        (planes(90.0, 210.0, 330.0), 3.0 * np.tan(np.pi / 3.0) * GAP**2),
        (planes(0.0), 6.0 * GAP * 4.0 * GAP),  # one stop of a square of three gaps
        (lobes(4), np.pi * ((GAP + 5.0e-4) ** 2 + 0.5 * 5.0e-4**2)),
    ],
)
def test_area_of_the_free_space_is_the_closed_form(profile, expected):
    outline = hole_outline(profile, GAP, 0.0)
    assert np.array_equal(outline[0], outline[-1])
    assert area(outline) == pytest.approx(expected, rel=1e-3)


def test_flat_stops_that_press_leave_no_space():
    assert len(hole_outline(planes(0.0, 180.0), -1e-5, 0.0, reach_m=1e-3)) == 0


def test_radial_gap_is_open_where_no_stop_lies_ahead():
    found = radial_gap(planes(0.0), GAP, np.deg2rad([0.0, 60.0, 90.0, 180.0]))
    assert found[:2] == pytest.approx([GAP, 2.0 * GAP]) and np.all(np.isinf(found[2:]))


def test_hole_is_the_free_space_moved_out_by_the_tube():
    radius, scale = 0.01, 10.0
    round_hole = hole_outline(circular(), GAP, radius, scale)
    assert np.hypot(*round_hole.T) == pytest.approx(radius + scale * GAP)
    lobed = hole_outline(lobes(4, 1.0e-3, 45.0), GAP, radius, scale)
    turn = np.arctan2(lobed[:, 1], lobed[:, 0])
    expected = GAP + 0.5e-3 * (1.0 - np.cos(4.0 * (turn - np.pi / 4.0)))
    assert np.hypot(*lobed.T) - radius == pytest.approx(scale * expected)
    assert np.ptp(hole_outline(planes(0.0, 180.0), GAP, radius)[:, 0]) == pytest.approx(
        2.0 * (radius + GAP)
    )


def support(profile, hertz=0.0, gap_m=None, gap_factor=1.0):
    """An entry of the configuration."""
    return SimpleNamespace(
        profile=profile,
        hertz_N_per_m15=hertz,
        stiffness_N_per_m=2.0e6,
        gap_m=gap_m,
        gap_factor=gap_factor,
    )


@pytest.mark.parametrize("profile", PROFILES, ids=lambda profile: str(vars(profile)))
def test_static_force_is_the_slope_of_the_energy(profile):
    angle, step = facing_angle(profile), 1e-9
    way = np.array([np.cos(angle), np.sin(angle)])
    places = np.linspace(-2.0e-3, 2.0e-3, 42)
    higher, lower = (
        energy(profile, np.outer(places + side, way)) for side in (0.5 * step, -0.5 * step)
    )
    force = static_force(support(profile), GAP, angle, places)
    assert force == pytest.approx(2.0 * (higher - lower) / step, rel=1e-4, abs=1e-3)
    assert np.any(force > 0.0)


def test_one_sided_stop_is_free_on_its_other_side():
    force = static_force(support(planes(0.0)), GAP, 0.0, np.array([-1.0, 2.0 * GAP]))
    assert force == pytest.approx([0.0, 2.0e6 * GAP])


def test_hertzian_force_rises_by_the_power_three_halves():
    force = static_force(support(circular(), hertz=1e9), GAP, 0.0, GAP + np.array([1e-5, 4e-5]))
    assert force == pytest.approx([1e9 * 1e-5**1.5, 8e9 * 1e-5**1.5])


def test_own_gap_of_a_support_goes_before_that_of_the_case():
    assert support_gap(support(circular(), gap_factor=(1.0, 1.2)), GAP) == pytest.approx(1.1 * GAP)
    assert support_gap(support(circular(), gap_m=1e-5), GAP) == 1e-5
