"""Exported contact is read back: at any displacement it has the force of the support's law."""

import dataclasses

import numpy as np
import pytest

from tests.support import exported_contacts as readers
from vibroimpact.cli import main
from vibroimpact.equivalent_support.answer import EquivalentError
from vibroimpact.equivalent_support.contact_points import ContactPoint, ContactSet, contact_set
from vibroimpact.equivalent_support.export_formats.registry import contacts_text

GAP, K = 1.0e-4, 4.0e5
MILLIMETRES = {"m": (1.0, 1.0), "mm": (1.0e3, 1.0)}  # lengths and forces of the file per SI unit


def tilted_axes():
    """Two directions across a tube that is along no global axis."""
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    first = np.cross(axis, [0.0, 0.0, 1.0])
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(axis, first)])


def point(name, axes, lands=(), **changes):
    """A contact point at a place of its own."""
    angles, place = np.radians(np.array(lands)), np.array([0.3, -0.2, 1.5])
    normals = np.column_stack([np.cos(angles), np.sin(angles)]) @ axes
    own = ContactPoint(name, place, np.asarray(axes), np.zeros(3), GAP, K, normals.reshape(-1, 3))
    return dataclasses.replace(own, **changes)


def own_force(own, u):
    """The force of the law: k times the penetration of the circle, or of each land."""
    d = u - own.offset
    if not len(own.lands):
        return readers.circle_force(own.axes, own.gap, own.stiffness, d)
    gaps = own.gap + own.extra_gap + np.zeros(len(own.lands))
    lands = zip(own.lands, gaps, strict=True)
    return sum(readers.normal_force(*land, own.stiffness, d) for land in lands)


def agrees(own, form, unit="m"):
    """Assert that a point written in a format has its own force at many displacements."""
    text, _ = contacts_text(ContactSet((own,)), form, unit)
    length, force = MILLIMETRES[unit]
    places = [{own.name: length * own.position}] if form == "code_aster" else []
    read = getattr(readers, form)(text, *places)
    generator = np.random.default_rng(3)
    moved = generator.uniform(-3.0 * GAP, 3.0 * GAP, (60, 2)) @ own.axes
    expected = force * np.array([own_force(own, u) for u in moved])
    found = np.array([read(own.name, length * u) for u in moved])
    assert found == pytest.approx(expected, abs=1e-5 * K * GAP * force)
    assert 20 < np.any(expected, axis=1).sum() <= 60


@pytest.mark.parametrize("unit", ["m", "mm"])
@pytest.mark.parametrize("form", ["abaqus", "opensees", "code_aster"])
def test_flat_lands_keep_their_force(form, unit):
    axes = tilted_axes()
    offset = np.array([2e-5, -1e-5]) @ axes
    extra = np.array([0.0, 0.3 * GAP, 0.6 * GAP])
    agrees(point("bars_1", axes, [20.0, 110.0, 200.0], offset=offset, extra_gap=extra), form, unit)


@pytest.mark.parametrize("form", ["abaqus", "opensees", "code_aster"])
def test_a_round_hole_keeps_its_force(form):
    agrees(point("plate_1", np.eye(3)[1:]), form, "mm")


@pytest.mark.parametrize("form", ["abaqus", "code_aster"])
def test_a_round_hole_may_be_askew(form):
    agrees(point("plate_1", tilted_axes()), form)


def test_code_aster_takes_holes_off_centre():
    axes = tilted_axes()
    agrees(point("plate_1", axes, offset=np.array([3e-5, 2e-5]) @ axes), "code_aster")


def test_code_aster_takes_lobes_as_an_outline():
    """Along a land and between two: the clearance is the gap, and the gap plus the depth."""
    own = point("plate_1", tilted_axes(), lobes=(4, 2.0 * GAP, np.radians(30.0)))
    text, _ = contacts_text(ContactSet((own,)), "code_aster")
    read = readers.code_aster(text, {own.name: own.position})
    for degrees, clearance in ((30.0, GAP), (120.0, GAP), (75.0, 3.0 * GAP)):
        direction = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))]) @ own.axes
        for reach in (0.5, 1.0):
            force = read(own.name, (clearance + reach * GAP) * direction)
            assert force == pytest.approx(-K * reach * GAP * direction, abs=1e-3 * K * GAP)
        assert not np.any(read(own.name, 0.999 * clearance * direction))


def test_code_aster_takes_damping_and_friction():
    own = point("p_1", np.eye(3)[:2], damping=7.0, friction=0.2, stick_stiffness=3e5)
    (term,) = readers.code_aster(contacts_text(ContactSet((own,)), "code_aster")[0], {}).terms
    assert term["AMOR_NOR"] == 7.0 and term["COULOMB"] == 0.2 and term["RIGI_TAN"] == 3e5


@pytest.mark.parametrize("form", ["abaqus", "opensees"])
def test_what_a_format_lacks_is_left_out_aloud(form):
    own = point("p_1", np.eye(3)[:2], damping=7.0, friction=0.2)
    text, left_out = contacts_text(ContactSet((own,)), form)
    assert len(left_out) == 2 and text.count("LEFT OUT") == 2


@pytest.mark.parametrize(
    ("form", "changes", "words"),
    [
        ("opensees", {"axes": tilted_axes()}, "across a global axis"),
        ("abaqus", {"offset": np.array([1e-5, 0.0, 0.0])}, "off centre"),
        ("opensees", {"lobes": (4, 1e-3, 0.0)}, "rounded lobes"),
        ("nastran", {}, "'nastran' is none of"),
    ],
)
def test_what_a_format_can_not_say_is_refused(form, changes, words):
    own = point("p_1", **{"axes": np.eye(3)[:2]} | changes)
    with pytest.raises(EquivalentError, match=words):
        contacts_text(ContactSet((own,)), form)


def test_the_contact_of_a_study_is_that_of_its_model(study_config, study_model):
    """Shares of the stiffness add up; every point has the gap of the case times its factor."""
    contacts = contact_set(study_config, study_model, 2e-4).points
    assert [own.name for own in contacts[:2]] == ["left_1", "left_2"]
    assert sum(own.stiffness for own in contacts) == pytest.approx(
        sum(np.sum(support.stiffness_N_per_m) for support in study_config.supports)
    )
    assert {own.gap for own in contacts} == {2e-4}
    assert all(np.allclose(own.axis @ own.axes.T, 0.0) for own in contacts)


def test_the_command_writes_contact(tmp_path, capsys):
    path = tmp_path / "contact.py"
    drilled, bars = (f"config/examples/{name}.yaml" for name in ("u_tube_drilled", "u_bend_bars"))
    export = ["--export", "opensees", str(path), "--gap"]
    assert main(["contact", drilled, *export, "1e-4"]) == 1  # damping and friction are left out
    told = capsys.readouterr()
    assert "18 points" in told.out and told.err.count("left out") == 2
    assert readers.opensees(path.read_text())("hot_1_1", np.array([2e-4, 0.0, 0.0]))[0] < 0.0
    assert main(["contact", drilled, *export, "-1"]) == 1
    assert "--gap -1 must" in capsys.readouterr().err
    assert main(["contact", bars, *export, "1e-4"]) == 1
    assert "bars_apex: preload_N" in capsys.readouterr().err
