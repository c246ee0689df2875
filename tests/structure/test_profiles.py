"""Profiles of supports: where their lands are, their free space, and what is refused."""

import copy
from pathlib import Path

import numpy as np
import pytest

from vibroimpact.config.reading import ConfigError, check_config, load_config
from vibroimpact.config.supports import Support
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.structure.contact.outline import hole_outline
from vibroimpact.structure.contact.profiles import land_normals, lobes, plain_profile

ROOT = Path(__file__).parents[2]
DIRECTIONS = np.eye(3)[:2]  # of a tube along z
GAP = 3.0e-4


def support(profile, **keys):
    """A support with a profile."""
    return Support.model_validate(
        {
            "name": "left",
            "at_m": [-0.3, 0.0, 0.35],
            "height_m": 0.03,
            "stiffness_N_per_m": 4.0e6,
            "profile": profile,
        }
        | keys
    )


def at_angles(*degrees):
    """Unit vectors (land, 2) at angles."""
    angles = np.deg2rad(degrees)
    return np.column_stack([np.cos(angles), np.sin(angles)])


OUTLINE = {"normals_deg": [0.0, 100.0, 200.0, 290.0], "extra_gap_m": [0.0, 1e-4, 2e-4, 5e-5]}
LANDS = {
    "planes": ({"kind": "planes", "normals_deg": [0.0, 120.0]}, (0, 120)),
    "an outline": ({"kind": "planes", **OUTLINE}, (0, 100, 200, 290)),
    "bars": ({"kind": "bars", "angle_deg": 30.0}, (30, 210)),
    "one bar": ({"kind": "bars", "angle_deg": 30.0, "sides": "one"}, (30,)),
    "bars, vector": ({"kind": "bars", "normal": [0.0, 2.0, 0.0]}, (90, 270)),
    "trefoil": ({"kind": "broached", "lands": 3, "angle_deg": 10.0}, (10, 130, 250)),
    "quadrifoil": ({"kind": "broached", "lands": 4, "normal": [1, 1, 0]}, (45, 135, 225, 315)),
    "lattice": ({"kind": "lattice", "angle_deg": 20.0}, (20, 110, 200, 290)),
    "circular": ({"kind": "circular"}, ()),
    "drilled": ({"kind": "drilled"}, ()),
}


@pytest.mark.parametrize("kind", LANDS)
def test_lands_of_a_profile_by_name(kind):
    profile, degrees = LANDS[kind]
    normals = land_normals(support(profile).profile, DIRECTIONS)
    assert normals == pytest.approx(at_angles(*degrees), abs=1e-14)


def test_pairs_of_a_lattice_at_two_heights_are_perpendicular():
    profile = support({"kind": "lattice", "angle_deg": 20.0, "spacing_m": 0.1}).profile
    assert land_normals(profile, DIRECTIONS, 0) == pytest.approx(at_angles(20, 200))
    assert land_normals(profile, DIRECTIONS, 1) == pytest.approx(at_angles(110, 290))


def test_each_pair_of_a_lattice_has_the_whole_support():
    """Bars along two directions at two heights: stiffness, damping and Hertz of a pair are those of
    the support, and each pair stops its own direction.
    """
    config = load_config(ROOT / "config" / "study.yaml")
    lattice = support(
        {"kind": "lattice", "normal": [1.0, 0.0, 0.0], "spacing_m": 0.1},
        points=2,
        damping_N_s_per_m=10.0,
        hertz_N_per_m15=1.0e8,
    )
    model = build_model(config.model_copy(update={"supports": (lattice,)}), motion_only=True)
    laws = model.contact_laws
    assert model.contact_stiffness.tolist() == [2.0e6] * 4
    assert laws.damping.tolist() == [5.0] * 4 and laws.hertz.tolist() == [5.0e7] * 4
    assert laws.land_point.tolist() == [0, 0, 1, 1, 2, 2, 3, 3]
    assert laws.land_normal[:4].tolist() == [[1.0, 0.0], [-1.0, 0.0]] * 2
    assert laws.land_normal[4:].tolist() == [[0.0, 1.0], [0.0, -1.0]] * 2
    assert model.contact_position[:, 2] == pytest.approx([0.285, 0.315, 0.385, 0.415])


def test_rounded_lands_are_lobes_from_the_first_land():
    profile = support(
        {"kind": "broached", "lands": 3, "normal": [0, 1, 0], "depth_m": 1e-3}
    ).profile
    assert lobes(profile, DIRECTIONS) == pytest.approx((3, 1.0e-3, np.pi / 2))
    assert len(land_normals(profile, DIRECTIONS)) == 0


def test_a_global_normal_is_the_same_all_along_a_bend():
    """An anti-vibration bar 45 degrees round the bend stops the out-of-plane motion, whichever
    global axes its transverse directions are.
    """
    config = load_config(ROOT / "config" / "study.yaml")
    at = [-0.3 * np.sqrt(0.5), 0.0, 0.7 + 0.3 * np.sqrt(0.5)]
    for normal in ([0.0, 1.0, 0.0], [-np.sqrt(0.5), 0.0, np.sqrt(0.5)]):
        bar = support({"kind": "bars", "normal": normal, "sides": "one"}, at_m=at)
        model = build_model(config.model_copy(update={"supports": (bar,)}), motion_only=True)
        laws = model.contact_laws
        lands = np.einsum("ld,ldx->lx", laws.land_normal, model.contact_directions)
        assert lands @ np.array(normal) == pytest.approx(np.ones(5), abs=2e-3)


def penetrations(place, profile, gap):
    """Penetration of each land, or of the circle with lobes, from its definition."""
    normals = land_normals(profile, DIRECTIONS)
    if len(normals):
        return normals @ place - gap - np.array(getattr(profile, "extra_gap_m", ()) or 0.0)
    count, depth, angle = lobes(profile, DIRECTIONS)
    theta = np.arctan2(place[1], place[0])
    return np.array([np.hypot(*place) - gap - depth * (1 - np.cos(count * (theta - angle))) / 2])


def free_space(entry, reach):
    """Outline of the free space of the tube's centre: that of the hole for a tube of no radius."""
    return hole_outline(plain_profile(entry.profile, DIRECTIONS), GAP, 0.0, reach_m=reach)


@pytest.mark.parametrize("kind", [*LANDS, "rounded"])
def test_the_outline_is_where_contact_begins(kind):
    rounded = {"kind": "broached", "lands": 4, "angle_deg": 10.0, "depth_m": 2e-4}
    profile = support(LANDS[kind][0] if kind in LANDS else rounded).profile
    outline = free_space(support(profile.model_dump()), 1.0e-3)
    assert outline[0] == pytest.approx(outline[-1])
    for place in outline:
        on_the_edge = np.isclose(np.abs(place).max(), 1.0e-3, rtol=1e-9)
        largest = penetrations(place, profile, GAP).max()
        assert largest == pytest.approx(0.0, abs=1e-12) or (on_the_edge and largest < 0.0)


@pytest.fixture
def study():
    """The study with a free hand over the keys of its left support."""
    config = load_config(ROOT / "config" / "study.yaml").model_dump(mode="json")

    def with_left(**keys):
        mapping = copy.deepcopy(config)
        mapping["supports"][0] |= keys
        return mapping

    return with_left


REFUSALS = [
    ({"profile": {"kind": "bars"}}, ["profile = 'bars' has neither of normal and angle_deg"]),
    (
        {"profile": {"kind": "lattice", "normal": [1.0, 0.0, 0.0], "angle_deg": 0.0}},
        ["profile = 'lattice' has both of normal and angle_deg: give one"],
    ),
    (
        {"profile": {"kind": "bars", "normal": [0.0, 1.0, 1.0]}},
        ["profile.normal", "45.0 degrees off the plane across the tube", "[0.0, 1.0, 0.0]"],
    ),
    (
        {"profile": {"kind": "bars", "normal": [0.0, 0.0, 1.0]}},
        ["profile.normal", "90.0 degrees off", "give a direction across it"],
    ),
    ({"profile": {"kind": "bars", "normal": [0, 0, 0]}}, ["profile.normal", "not a direction"]),
    ({"preload_N": 5.0}, ["preload_N = 5.0 needs flat lands", "circular: use bars"]),
    (
        {"preload_N": 5.0, "gap_m": 1e-4, "profile": {"kind": "bars", "angle_deg": 0.0}},
        ["preload_N = 5.0 is given together with gap_m = 0.0001", "give one of them"],
    ),
    (
        {"profile": {"kind": "lattice", "angle_deg": 0.0, "spacing_m": 0.01}},
        ["spacing_m = 0.01 is less than the height of the bars", "give 0"],
    ),
    (
        {"profile": {"kind": "lattice", "angle_deg": 0.0, "spacing_m": 0.9}},
        ["spacing_m = 0.9 puts a pair of bars beyond an end", "at most 0.7 m"],
    ),
    (
        {"at_m": [-0.3, 0.0, 0.015]},
        ["at_m", "'left' reaches to the clamped end", "lower its height"],
    ),
    (
        {"at_m": [-0.3, 0.0, 0.69]},
        ["height_m = 0.03", "beyond the segment", "across the joint at 0.7 m", "at most 0.02 m"],
    ),
]


@pytest.mark.parametrize(("keys", "parts"), REFUSALS, ids=[str(keys) for keys, _ in REFUSALS])
def test_a_wrong_support_is_named_with_its_remedy(study, keys, parts):
    with pytest.raises(ConfigError) as refusal:
        check_config(study(**keys), "mine")
    lines = [line for line in refusal.value.problems if "supports[0]" in line]
    assert any(all(part in line for part in parts) for line in lines), refusal.value.problems


def test_pressing_bars_are_not_turned_into_holes(study):
    """The effects that give an obstacle another shape are tried where nothing presses."""
    values = study(preload_N=5.0, profile={"kind": "bars", "angle_deg": 0.0})
    assert EFFECTS["foliate_obstacle"].locations(values) == ["right"]
    assert EFFECTS["foliate_obstacle"].locations(study()) == ["all", "left", "right"]


def test_a_support_may_end_at_a_joint_and_touch_at_rest(study):
    check_config(study(at_m=[-0.3, 0.0, 0.685]), "mine")
    check_config(
        study(gap_m=-1e-4, profile={"kind": "broached", "lands": 3, "angle_deg": 0.0}), "m"
    )
