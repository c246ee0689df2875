"""Springs and dampers to ground in the formats of other programs, read back by small readers."""

import argparse
import dataclasses
import math

import numpy as np
import pytest

from tests.support.exported_springs import READERS
from tests.support.straight_path import straight_path
from vibroimpact import EquivalentError, build_model, check_config, point_springs, springs_text
from vibroimpact.equivalent_support import command
from vibroimpact.equivalent_support.answer import NOT_MOVED, Answer, GroupAnswer, Span
from vibroimpact.equivalent_support.export_formats.frames import FIRST_NUMBER

K, C = 8.0e4, 210.0
TANGENT = np.array([1.0, 1.0, 0.0]) / math.sqrt(2.0)


def answer(supports, direction="y", k=K, c=C):
    """An answer with one group; None for what is not resolved."""
    spans = [Span() if value is None else Span(value, 0.9 * value, 1.2 * value) for value in (k, c)]
    reasons = {"reason_k": "" if k else "too weak", "reason_c": "" if c else "too short"}
    group = GroupAnswer("all", supports, direction, *spans, **reasons)
    return Answer("mine", "study", 5.0, 2.5e-4, (group,))


@pytest.fixture(scope="module")
def slanted_model():
    """A straight tube at 45 degrees in the plane z = 0, with one plate of unequal stiffnesses."""
    pipe = {"outer_diameter_m": 0.02, "wall_thickness_m": 0.001}
    ends, mesh = ("clamped", "clamped"), {"elements_per_span": 6}
    plate = {"name": "plate", "at_m": list(0.5 * TANGENT), "height_m": 0.03, "points": 3}
    force = {"kind": "band_limited", "point": "middle", "direction": [0.0, 0.0, 1.0]}
    sensors = {"points": ["middle"], "directions": ["z"]}
    values = {
        "study": "slanted",
        "structure": straight_path(
            1.2, [1.0, 1.0, 0.0], pipe, (2.0e11, 0.3, 8000.0), ends, mesh=mesh
        ),
        "supports": [plate | {"stiffness_N_per_m": [1.0e6, 2.0e6, 1.0e6]}],
        "points": {"middle": list(0.6 * TANGENT)},
        "excitation": force | {"band_Hz": [5.0, 200.0]},
        "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-4]},
        "record": {"sensors": sensors, "shape_line": {"direction": "z"}},
    }
    return build_model(check_config(values, "slanted"))


@pytest.mark.parametrize("form", READERS)
def test_points_of_a_support_add_up_to_its_k_and_c(form, study_model):
    springs = point_springs(answer(study_model.support_names), study_model)
    found = READERS[form](springs_text(springs, form))
    assert len(found) == 10
    across = np.diag([1.0, 1.0, 0.0])  # the legs run along z
    for support in ("left", "right"):
        mine = [value for name, value in found.items() if name.startswith(support)]
        np.testing.assert_allclose(sum(k for _, k, _ in mine), K * across, rtol=1e-8)
        np.testing.assert_allclose(sum(c for _, _, c in mine), C * across, rtol=1e-8)
        heights = sorted(place[2] for place, _, _ in mine)
        assert heights == pytest.approx(np.linspace(0.335, 0.365, 5))
        assert {round(place[0], 9) for place, _, _ in mine} == {-0.3 if support == "left" else 0.3}


@pytest.mark.parametrize("form", READERS)
def test_slanted_tube_is_held_across_and_free_along(form, slanted_model):
    springs = point_springs(answer(("plate",), "z"), slanted_model)
    found = READERS[form](springs_text(springs, form))
    across = np.eye(3) - np.outer(TANGENT, TANGENT)
    for name, share in (("plate_1", 0.25), ("plate_2", 0.5), ("plate_3", 0.25)):
        _, stiffness, damping = found[name]
        np.testing.assert_allclose(stiffness, share * K * across, atol=1e-6 * K)
        np.testing.assert_allclose(damping, share * C * across, atol=1e-6 * C)


@pytest.mark.parametrize("form", READERS)
def test_millimetres_and_tonnes(form, slanted_model):
    springs = point_springs(answer(("plate",), "z"), slanted_model, points="one")
    ((place, stiffness, damping),) = READERS[form](springs_text(springs, form, "mm")).values()
    np.testing.assert_allclose(place, 500.0 * TANGENT, rtol=1e-8)
    assert np.trace(stiffness) == pytest.approx(2.0 * K / 1000.0)
    assert np.trace(damping) == pytest.approx(2.0 * C / 1000.0)


@pytest.mark.parametrize("form", READERS)
def test_the_other_direction_can_be_left_free(form, study_model):
    springs = point_springs(answer(study_model.support_names), study_model, "one", "none")
    found = READERS[form](springs_text(springs, form))
    for _, stiffness, _ in found.values():
        np.testing.assert_allclose(stiffness, np.diag([0.0, K, 0.0]), rtol=1e-8)


@pytest.mark.parametrize("form", READERS)
def test_two_directions_have_each_its_own_k(form, study_model):
    first = answer(study_model.support_names).groups[0]
    both = (first, dataclasses.replace(first, direction="x", k=Span(3.0e4, 2.0e4, 4.0e4)))
    own = dataclasses.replace(answer(study_model.support_names), groups=both)
    springs = point_springs(own, study_model, "one")
    for _, stiffness, _ in READERS[form](springs_text(springs, form)).values():
        np.testing.assert_allclose(stiffness, np.diag([3.0e4, K, 0.0]), rtol=1e-8)


@pytest.mark.parametrize("form", READERS)
def test_a_damping_that_is_not_resolved_is_left_out(form, study_model):
    springs = point_springs(answer(study_model.support_names, c=None), study_model)
    text = springs_text(springs, form)
    for _, stiffness, damping in READERS[form](text).values():
        assert not damping.any() and np.trace(stiffness) == pytest.approx(2.0 * K / 5.0)
    assert springs.left_out == ("c of 'all' along y: not resolved: too short",)
    if form != "csv":
        assert "not resolved: too short" in text.replace("\n$ ", " ").replace("\n# ", " ")


def test_only_resolved_supports_are_written(study_model):
    whole = answer(("left",)).groups[0]
    lost = answer(("right",), k=None).groups[0]
    both = dataclasses.replace(answer(("left",)), groups=(whole, lost))
    springs = point_springs(both, study_model)
    assert {spring.support for spring in springs.springs} == {"left"}
    assert springs.left_out[0] == "k of 'all' along y: not resolved: too weak"
    assert springs.left_out[-1] == "support right has no spring"


@pytest.mark.parametrize(
    ("asked", "changes", "words"),
    [
        ({"k": None}, {}, "nothing to export: k of 'all' along y: not"),
        ({"direction": "z"}, {}, "nothing to export: support left has no spring"),  # along the tube
        ({}, {"contact_position": np.zeros((10, 3))}, "no positions in space"),
    ],
)
def test_what_has_no_spring_is_not_exported(study_model, asked, changes, words):
    model = dataclasses.replace(study_model, **changes)
    with pytest.raises(EquivalentError, match=words):
        point_springs(answer(model.support_names, **asked), model)


@pytest.mark.parametrize("form", READERS)
def test_oblique_parallel_stops_act_along_their_normal(form, study_model):
    """Two stops at 30 degrees from x on every point: K n n^T, and nothing across them."""
    normal = np.array([math.cos(math.pi / 6.0), math.sin(math.pi / 6.0)])
    points, normals = np.repeat(np.arange(10), 2), np.tile([normal, -normal], (10, 1))
    laws = study_model.contact_laws.with_columns(land_point=points, land_normal=normals)
    model = dataclasses.replace(study_model, contact_laws=laws)
    springs = point_springs(answer(model.support_names, "normal"), model, "one")
    along = np.array([*normal, 0.0])
    for _, stiffness, damping in READERS[form](springs_text(springs, form)).values():
        np.testing.assert_allclose(stiffness, K * np.outer(along, along), atol=1e-6 * K)
        np.testing.assert_allclose(damping, C * np.outer(along, along), atol=1e-6 * C)


def test_a_direction_that_is_not_driven_is_no_failure(study_model):
    driven = answer(study_model.support_names).groups[0]
    nothing = {"k": Span(), "c": Span(), "reason_k": NOT_MOVED, "reason_c": NOT_MOVED}
    still = dataclasses.replace(driven, direction="x", **nothing)
    both = dataclasses.replace(answer(study_model.support_names), groups=(driven, still))
    assert both.unresolved == []
    springs = point_springs(both, study_model, "one")
    assert springs.left_out == () and springs.springs[0].k == (K, K)
    assert point_springs(both, study_model, "one", "none").springs[0].k == (None, K)
    weak = dataclasses.replace(both, groups=(driven, dataclasses.replace(still, reason_k="weak")))
    assert point_springs(weak, study_model, "one").springs[0].k == (None, K)


def test_nastran_cards_fit_their_fields(slanted_model):
    text = springs_text(point_springs(answer(("plate",), "z"), slanted_model), "nastran")
    assert text.count("CORD2R*") == 3
    for line in text.splitlines():
        assert len(line) <= 72
    assert "." in text.split("PBUSH*")[1].splitlines()[0]


def test_names_that_a_format_can_not_tell_apart_are_refused(study_model):
    same = dataclasses.replace(study_model, support_names=("plate 1", "plate_1"))
    springs = point_springs(answer(same.support_names), same)
    for form in READERS:
        with pytest.raises(EquivalentError, match="both called plate_1_1"):
            springs_text(springs, form)
    long = dataclasses.replace(study_model, support_names=("left", "a_plate_with_a_long_name"))
    with pytest.raises(EquivalentError, match="more than the 24 characters"):
        springs_text(point_springs(answer(long.support_names), long), "code_aster")


def test_numbers_begin_where_asked(study_model):
    springs = point_springs(answer(study_model.support_names), study_model)
    assert "GRID*               5000" in springs_text(springs, "nastran", first_number=5000)
    assert "\n5000, " in springs_text(springs, "abaqus", first_number=5000)
    assert "first_tag=5000" in springs_text(springs, "opensees", first_number=5000)
    parser = argparse.ArgumentParser()
    command.add_arguments(parser)
    asked = parser.parse_args(["mine", "--load", "1", "--gap", "1"])
    assert asked.first_number == FIRST_NUMBER
