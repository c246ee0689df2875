"""The small file of an identified structure: what is left out is left to the records, what is wrong
is told with place, value and remedy.
"""

import re

import pytest

from tests.support import two_masses
from vibroimpact.config.declared_keys import examples_of
from vibroimpact.config.measured_structure import MeasuredStructure
from vibroimpact.config.reading import ConfigError
from vibroimpact.diagnosis.identified.local_laws import LAWS
from vibroimpact.diagnosis.identified.stated import check_names, default_places, laws_of
from vibroimpact.diagnosis.identified.structure_file import (
    model_from,
    model_of,
    read_structure,
    values_of,
)


def written(folder, text):
    """The path of a file with a text."""
    path = folder / "x.yaml"
    path.write_text(text)
    return str(path)


def test_everything_may_be_left_out(tmp_path):
    assert (
        read_structure(written(tmp_path, "structure: {kind: identified}"))
        == MeasuredStructure(kind="identified")
        == read_structure("identified")
    )


def test_stated_values_are_kept(tmp_path):
    found = read_structure(
        written(
            tmp_path,
            """
structure:
  kind: identified
  band_Hz: [5, 60]
  drive: a1
  places: {joint: {a1: -1, a2: 1}}
  candidates: [cubic_stiffness.joint]
  additions: []
  residual_modes: [true, false]
""",
        )
    )
    assert (found.band_Hz, found.drive, found.residual_modes) == ((5, 60), "a1", (True, False))
    assert found.places == {"joint": {"a1": -1, "a2": 1}}
    assert (found.candidates, found.additions) == (("cubic_stiffness.joint",), ())
    assert model_from(values_of(found)) == model_of(found) == found


@pytest.mark.parametrize(
    "text", ["structure: {kind: chain}", "study: x", "structure: {kind: identified, modes: []}"]
)
def test_other_models_are_left_to_the_study(tmp_path, text):
    assert read_structure(written(tmp_path, text)) is None


@pytest.mark.parametrize(
    ("key", "told"),
    [
        (
            "band_Hz: [60, 5]",
            "structure.band_Hz = [60, 5] must be two frequencies in Hz, the lower one first",
        ),
        ("bandHz: [5, 60]", "unknown key 'bandHz' in structure: did you mean 'band_Hz'?"),
        ("drive: 3", "structure.drive = 3 must be the name of a channel"),
        (
            "places: {the joint: {a1: 1}}",
            "structure.places: the name 'the joint' must begin with a letter",
        ),
        ("places: {joint: {a1: 0}}", "structure.places.joint = {'a1': 0} must give a coefficient"),
        ("candidates: [cubic.joint]", "structure.candidates[0] = 'cubic.joint' names no law"),
        (
            "candidates: [clearance]",
            "structure.candidates[0] = 'clearance' must be a law and a place",
        ),
        (
            "residual_modes: yes please",
            "structure.residual_modes = 'yes please' must be two of true and false",
        ),
        ("emphasis: -1", "structure.emphasis = -1 must be between 0"),
        (
            "candidates: [clearance.a/../b]",
            "structure.candidates[0] = 'clearance.a/../b' must be a law and a place",
        ),
        (
            "additions: [clearance.a, clearance.a]",
            "structure.additions = ['clearance.a', 'clearance.a'] must be a list of names",
        ),
    ],
)
def test_errors_in_the_structure_file_are_reported(tmp_path, key, told):
    with pytest.raises(ConfigError) as error:
        read_structure(written(tmp_path, f"structure:\n  kind: identified\n  {key}\n"))
    assert (
        str(error.value).startswith(f"{tmp_path}/x.yaml: {told}") and len(error.value.problems) == 1
    )


def test_all_problems_of_a_file_are_reported_at_once(tmp_path):
    text = """
study: x
structure:
  kind: identified
  band_Hz: [60, 5]
  candidates: [cubic.joint, clearance]
  additions: [cleerance.joint]
"""
    with pytest.raises(ConfigError) as error:
        read_structure(written(tmp_path, text))
    assert [
        problem.removeprefix(f"{tmp_path}/x.yaml: ").split(" ")[0]
        for problem in error.value.problems
    ] == [
        "unknown",
        "structure.band_Hz",
        "structure.candidates[1]",
        "structure.candidates[0]",
        "structure.additions[0]",
    ]


def test_every_declared_key_has_an_example():
    keys = MeasuredStructure.model_fields
    for name, key in keys.items():
        assert key.description.endswith(".") and len(examples_of(key)) == 1, name
    examples = {name: examples_of(key)[0] for name, key in keys.items()}
    assert MeasuredStructure.model_validate(examples).emphasis == 1.0


def test_unknown_channel_names_are_listed_with_known_ones():
    stated = MeasuredStructure(
        kind="identified",
        drive="b",
        places={"joint": {"upper": -1, "c": 1}},
        candidates=["clearance.root", "clearance.elsewhere"],
        additions=["clearance.elsewhere"],
    )
    with pytest.raises(ConfigError) as error:
        check_names(stated, two_masses.campaign("nothing", periods=2))
    places = [
        problem.removeprefix("structure.").split(" is ")[0] for problem in error.value.problems
    ]
    assert places == [
        "drive = 'b'",
        "places.joint.c",
        "candidates: 'clearance.root'",
        "candidates: 'clearance.elsewhere'",
    ]
    assert "the usable channels are upper, lower" in str(error.value)


def test_laws_are_tried_at_the_places_that_change():
    candidates, additions = laws_of(MeasuredStructure(kind="identified"), ["joint", "root"])
    assert "clearance.joint" in candidates and "clearance.root" in candidates
    assert {name.partition(".")[2] for name in additions} == {"joint"}


def test_places_are_channel_pairs_and_channels_to_ground():
    places = default_places(
        ["1:+z", "top left", "side"], [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)]
    )
    assert places == {
        "c1_z-top_left": {"1:+z": 1.0, "top left": 1.0},
        "c1_z": {"1:+z": 1.0},
        "top_left": {"top left": 1.0},
        "side": {"side": 1.0},
    }


def test_the_key_reference_names_every_law():
    described = MeasuredStructure.model_fields["candidates"].description
    assert set(LAWS) <= set(re.findall(r"`(\w+)`", described))
