"""Effects that act across a tube do so however the tube lies."""

import numpy as np
import pytest

from evidence.truth.campaign import Plan
from evidence.truth.geometry import Holder, Straight, Tube
from evidence.truth.model_file import model_of
from vibroimpact.effects.registry import EFFECTS

FORCE_N = (2.0, 1.5)


def values_of(axis, force):
    """Plain values of a straight tube along an axis under a force along a direction."""
    tube = Straight(
        outer_diameter=0.02,
        wall=0.0015,
        length=1.2,
        axis=axis,
        drive=0.4,
        holders=(Holder(name="stop", arc=0.8),),
    )
    config = model_of(Plan(seed=(1,), tube=tube, drive_direction=force))
    return config | {"excitation": config["excitation"] | {"constant": []}}


def with_point(values):
    """The values with the keys of supports that the checks add."""
    return values | {"supports": [{"point": None} | one for one in values["supports"]]}


@pytest.mark.parametrize(("axis", "wanted"), [("x", [0.0, *FORCE_N]), ("z", [*FORCE_N, 0.0])])
def test_preload_presses_across_the_tube(axis, wanted):
    values = with_point(values_of(axis, (0.0, 1.0, 0.0)))
    found = EFFECTS["preload"].apply(
        values, dict(zip(("force_x", "force_y"), FORCE_N, strict=True)), "all"
    )
    loads = found["excitation"]["constant"]
    total = sum(one["force_N"] * np.array(one["direction"]) for one in loads)
    assert total == pytest.approx(wanted)
    assert {one["point"] for one in loads} == {"at_stop"}
    assert found["points"]["at_stop"] == values["supports"][0]["at_m"]


def test_preload_presses_a_structure_of_points_at_its_point():
    values = {
        "structure": {"kind": "matrices"},
        "points": {},
        "supports": [{"name": "stop", "point": "tip", "at_m": None}],
        "excitation": {"constant": []},
    }
    found = EFFECTS["preload"].apply(values, {"force_x": 2.0, "force_y": 1.5}, "all")
    assert [one["point"] for one in found["excitation"]["constant"]] == ["tip", "tip"]
    assert found["points"] == {}


@pytest.mark.parametrize(("axis", "wanted"), [("x", "yz"), ("z", "xy")])
def test_rod_holds_a_tube_across_it(axis, wanted):
    values = values_of(axis, (0.0, 1.0, 0.0))
    assert EFFECTS["lateral_stinger"].locations(values) == [f"along_{one}" for one in wanted]


def test_rod_holds_a_u_tube_across_its_legs():
    """A force on the bend moves it sideways, not along the legs: there a rod would hold nothing."""
    tube = Tube(outer_diameter=0.022, wall=0.0013, leg=0.7, bend_radius=0.3, plate_height=0.35)
    values = model_of(Plan(seed=(1,), tube=tube))
    assert EFFECTS["lateral_stinger"].locations(values) == ["along_x", "along_y"]


def test_rod_holds_a_tube_along_an_oblique_force():
    """No global axis is along it, and a spring along one moves the tube across the force too."""
    values = {"elements": [], **values_of("x", (0.0, 0.6, 0.8))}
    rod = EFFECTS["lateral_stinger"]
    assert rod.locations(values) == ["along_force", "along_y", "along_z"]
    found = rod.apply(values, {"stiffness": 1000.0, "damping": 2.0}, "along_force")
    (element,) = found["elements"][-1:]
    assert element["direction"] == pytest.approx([0.0, 0.6, 0.8])
