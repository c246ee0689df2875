"""Exported supports are read by the programs they are for: OpenSees, CalculiX, pyNastran."""

import json
import os
import re
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from evidence.validation.judges.opensees import NODES_FROM, clamped_tube
from evidence.validation.judges.presence import JudgeAbsent, calculix, opensees
from vibroimpact.equivalent_support.answer import Answer, GroupAnswer, Span
from vibroimpact.equivalent_support.export_formats.registry import springs_text
from vibroimpact.equivalent_support.springs import point_springs
from vibroimpact.identify.linear.modes import natural_frequencies

K, C = 8.0e4, 210.0
# pyNastran needs an older numpy than the library: a Python of another environment that has it.
NASTRAN_PYTHON = os.environ.get("PYNASTRAN_PYTHON", sys.executable)
# CalculiX solves nothing without a solid: one brick, held at four corners.
BRICK = """*NODE
1, 9., 0., 0.
2, 10., 0., 0.
3, 10., 1., 0.
4, 9., 1., 0.
5, 9., 0., 1.
6, 10., 0., 1.
7, 10., 1., 1.
8, 9., 1., 1.
*ELEMENT, TYPE=C3D8, ELSET=BRICK
1, 1, 2, 3, 4, 5, 6, 7, 8
*MATERIAL, NAME=STEEL
*ELASTIC
2.E11, 0.3
*SOLID SECTION, ELSET=BRICK, MATERIAL=STEEL
*BOUNDARY
1, 1, 3
2, 1, 3
3, 1, 3
4, 1, 3"""
READ_BULK = """
import json, sys
from pyNastran.bdf.bdf import read_bdf
model = read_bdf(sys.argv[1], punch=True, xref=True, debug=False)
springs = []
for element in model.elements.values():
    assert element.type == "CBUSH" and element.nodes[1] is None, element
    system = model.coords[element.cid]
    axes = [system.i.tolist(), system.j.tolist(), system.k.tolist()]
    springs.append(
        [model.nodes[element.nodes[0]].get_position().tolist(), axes, element.pid_ref.Ki,
         element.pid_ref.Bi]
    )
print(json.dumps(springs))
"""


def answer(supports, direction="y"):
    """An answer with one group, resolved."""
    group = GroupAnswer("all", supports, direction, Span(K, 0.9 * K, 1.2 * K), Span(C, C, C))
    return Answer("mine", "study", 5.0, 2.5e-4, (group,))


@pytest.fixture(scope="module")
def turned_model(study_model):
    """The study's tube with its contact directions turned by 30 degrees about z."""
    cos, sin = np.cos(np.pi / 6.0), np.sin(np.pi / 6.0)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return replace(study_model, contact_directions=study_model.contact_directions @ turn.T)


@pytest.fixture(scope="module")
def exported(study_model):
    """The springs of the study's tube."""
    return point_springs(answer(study_model.support_names), study_model)


def test_opensees_tube_on_exported_supports(exported, study_config, study_model):
    try:
        ops = opensees()
    except JudgeAbsent as absent:
        pytest.skip(str(absent))
    nodes = clamped_tube(ops, study_config, 1)
    names = {}
    exec(springs_text(exported, "opensees"), names)
    tags = [int(NODES_FROM + node) for node in nodes.contact]
    names["add_supports"](ops, dict(zip(names["POINTS"], tags, strict=True)))
    frequencies = np.sqrt(ops.eigen("-genBandArpack", 6)) / (2.0 * np.pi)
    ops.wipe()
    ours = natural_frequencies(study_model, K, 6)
    np.testing.assert_allclose(frequencies, ours, rtol=2.0e-6)
    free = natural_frequencies(study_model, 0.0, 6)
    assert np.abs(free / ours - 1.0).max() > 0.1


def test_opensees_mass_decays_as_the_exported_damper_says(exported):
    try:
        ops = opensees()
    except JudgeAbsent as absent:
        pytest.skip(str(absent))
    names = {}
    exec(springs_text(exported, "opensees"), names)
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    mass, tags = 2.0, {}
    for tag, (name, (place, *_)) in enumerate(names["POINTS"].items(), 1):
        ops.node(tag, *place)
        ops.fix(tag, 0, 0, 1, 1, 1, 1)
        ops.mass(tag, mass, mass, mass, 0.0, 0.0, 0.0)
        tags[name] = tag
    names["add_supports"](ops, tags)
    k, c = K / 5.0, C / 5.0
    omega, decay, start, dt = np.sqrt(k / mass), 0.5 * c / mass, 1.0e-3, 1.0e-5
    ops.setNodeVel(1, 2, start, "-commit")
    for command in (("constraints", "Plain"), ("numberer", "RCM"), ("system", "BandGeneral")):
        getattr(ops, command[0])(command[1])
    ops.algorithm("Linear")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    ops.analyze(3000, dt)
    found, time = ops.nodeDisp(1, 2), 3000 * dt
    ops.wipe()
    damped = np.sqrt(omega**2 - decay**2)
    expected = start / damped * np.exp(-decay * time) * np.sin(damped * time)
    assert found == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("across", ["same", "none"])
def test_calculix_reads_the_exported_springs(turned, across, study_model, turned_model):
    """Under a force at every point, its displacement is that of the springs by hand."""
    model = turned_model if turned else study_model
    direction = "second" if turned else "y"
    springs = point_springs(answer(model.support_names, direction), model, across=across)
    text = springs_text(springs, "abaqus")
    # CalculiX has no DASHPOT1.
    text = re.sub(r"\*ELEMENT, TYPE=DASHPOT1.*\n.*\n\*DASHPOT.*\n.*\n.*\n", "", text)
    assert ("ORIENTATION" in text) == turned and "DASHPOT" not in text
    numbers = range(900001, 900001 + len(springs.springs))
    force, soft = np.array([1.0, -2.0, 0.5]), 1.0e3  # N; N/m in every direction: nothing is free
    deck = [text, BRICK]
    for axis in (1, 2, 3):
        deck += [f"*ELEMENT, TYPE=SPRING1, ELSET=SOFT{axis}"]
        deck += [f"{100 * axis + place}, {number}" for place, number in enumerate(numbers)]
        deck += [f"*SPRING, ELSET=SOFT{axis}", f"{axis}", f"{soft}"]
    deck += ["*STEP", "*STATIC", "*CLOAD"]
    deck += [f"{node}, {axis + 1}, {force[axis]}" for node in numbers for axis in range(3)]
    deck += ["*NODE PRINT, NSET=SUPPORT_POINTS", "U", "*END STEP", ""]
    try:
        printed = calculix("\n".join(deck))
    except JudgeAbsent as absent:
        pytest.skip(str(absent))
    rows = [line.split() for line in printed.splitlines()]
    moved = {int(row[0]): np.array(row[1:], float) for row in rows if len(row) == 4}
    assert sorted(moved) == list(numbers)
    for number, spring in zip(numbers, springs.springs, strict=True):
        stiffness = soft * np.eye(3)
        for axis, k in zip(spring.axes, spring.k, strict=True):
            stiffness += (k or 0.0) * np.outer(axis, axis)
        expected = np.linalg.solve(stiffness, force)
        np.testing.assert_allclose(moved[number], expected, atol=2e-6 * np.abs(expected).max())


@pytest.mark.parametrize("turned", [False, True])
def test_pynastran_reads_the_exported_bushes(turned, study_model, turned_model, tmp_path):
    model = turned_model if turned else study_model
    springs = point_springs(answer(model.support_names, "second" if turned else "y"), model)
    path = tmp_path / "supports.bdf"
    path.write_text(springs_text(springs, "nastran"))
    done = subprocess.run(
        [NASTRAN_PYTHON, "-c", READ_BULK, str(path)], capture_output=True, text=True, check=False
    )
    if "No module named 'pyNastran'" in done.stderr:
        pytest.skip(
            "pyNastran is not installed: name a Python that has it in PYNASTRAN_PYTHON (pip install"
            " pyNastran 'numpy<2')"
        )
    assert done.returncode == 0, done.stderr
    read = json.loads(done.stdout)
    assert len(read) == 10
    for spring, (place, axes, k, c) in zip(springs.springs, read, strict=True):
        np.testing.assert_allclose(place, spring.position, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(np.array(axes)[:2], spring.axes, atol=1e-9)
        assert k[:2] == pytest.approx(spring.k, rel=1e-9) and k[2:] == [None] * 4
        assert c[:2] == pytest.approx(spring.c, rel=1e-9) and c[2:] == [None] * 4
