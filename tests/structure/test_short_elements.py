"""Contact points close to the end of a tube: short elements beside long ones, and rigid modes."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.support.straight_path import straight_path
from vibroimpact.config.reading import check_config
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.structure.beam_elements import section_beam
from vibroimpact.structure.rigid_motions import free_rigid_motions

LENGTH = 2.436
ROOTS = {"clamped": 1.875104069, "free": 4.730040745, "pinned": 3.926602312}  # of beta L


def tube(before_end_m, start="clamped", theory="euler_bernoulli", length=LENGTH):
    """A straight tube with a free end and one contact point a little before it."""
    return check_config(
        {
            "study": "short",
            "structure": straight_path(
                length,
                [0.0, 0.0, 1.0],
                {"outer_diameter_m": 0.0159, "wall_thickness_m": 0.00115},
                (2.07e11, 0.3, 7870.0),
                ends=(start, "free"),
                theory=theory,
            ),
            "damping": {"kind": "modal", "other_ratio": 0.01},
            "supports": [
                {
                    "name": "last",
                    "at_m": [0.0, 0.0, length - before_end_m],
                    "height_m": max(1.9 * before_end_m, 1.0e-3),
                    "points": 1,
                    "stiffness_N_per_m": 1.0e5,
                }
            ],
            "points": {"drive": [0.0, 0.0, 1.0]},
            "excitation": {
                "kind": "harmonic",
                "point": "drive",
                "direction": [1.0, 0.0, 0.0],
                "frequency_Hz": 40.0,
            },
            "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-3], "seeds": 1},
            "record": {
                "sensors": {"points": ["drive"], "directions": ["x", "y"]},
                "shape_line": {"direction": "x"},
            },
        },
        "short",
    )


@pytest.mark.parametrize("before_end_m", [0.5e-3, 1.0e-3, 1.5e-3, 2.0e-3])
@pytest.mark.parametrize(("start", "rigid"), [("clamped", 0), ("free", 6), ("pinned", 2)])
def test_a_support_near_the_free_end_keeps_every_mode(before_end_m, start, rigid):
    config = tube(before_end_m, start)
    beam = section_beam(config.structure.section, config.structure.material, "euler_bernoulli")
    wave_speed = np.sqrt(beam.planes[0].bending_stiffness / beam.mass_per_length)
    model = build_model(config, motion_only=True)
    assert np.sum(model.omega == 0.0) == rigid
    assert model.omega[rigid : rigid + 2] == pytest.approx(
        (ROOTS[start] / LENGTH) ** 2 * wave_speed, rel=2e-4
    )


@pytest.mark.parametrize(("before_end_m", "expected"), [(0.01, (0.02, 0.01)), (0.0, (0.01, 0.005))])
def test_a_support_flush_with_the_free_end_or_centred_on_it(before_end_m, expected):
    """Three points over 20 mm: the last one is the end, which then has a contact of its own."""
    config = tube(before_end_m)
    support = config.supports[0].model_copy(update={"height_m": 0.02, "points": 3})
    config = check_config(
        config.model_copy(update={"supports": (support,)}).model_dump(mode="json"), "flush"
    )
    model = build_model(config, motion_only=True)
    assert LENGTH - model.contact_position[:, 2] == pytest.approx([*expected, 0.0], abs=1e-12)
    # static flexibility L³ / 3 EI of the tip, under the contact at the end itself
    beam = section_beam(config.structure.section, config.structure.material, "euler_bernoulli")
    flexibility = np.sum((model.contact_shapes[:, 2, 0] / model.omega) ** 2)
    assert flexibility == pytest.approx(
        LENGTH**3 / (3.0 * beam.planes[0].bending_stiffness), rel=1e-5
    )


def test_stiffness_lost_in_round_off_is_refused():
    with pytest.raises(ValueError, match=r"has \d+ modes without stiffness, .* allow 0"):
        build_model(tube(1.5e-4, length=10 * LENGTH), motion_only=True)
    build_model(tube(1.5e-4, length=10 * LENGTH, theory="timoshenko"), motion_only=True)


ENDS = {
    ("clamped", "free"): 0,
    ("springs", "free"): 0,
    ("free", "free"): 6,
    ("pinned", "free"): 2,  # turns about two axes; a pin holds the twist
    ("pinned", "pinned"): 0,
}


@pytest.mark.parametrize(("start", "end"), ENDS)
def test_rigid_motions_of_a_straight_tube(start, end):
    structure = SimpleNamespace(
        kind="path",
        start_m=[0.2, 0.0, 0.0],
        start_direction=[1.0, 2.0, 2.0],
        segments=[SimpleNamespace(kind="straight", length_m=3.0)],
        start=SimpleNamespace(kind=start),
        end=SimpleNamespace(kind=end),
    )
    assert free_rigid_motions(structure, build_centreline(structure)) == ENDS[start, end]


def test_a_u_tube_on_two_pins_swings_about_their_line():
    structure = SimpleNamespace(
        kind="u_tube", leg_length_m=0.7, bend_radius_m=0.3, root=SimpleNamespace(kind="pinned")
    )
    assert free_rigid_motions(structure, build_centreline(structure)) == 1
