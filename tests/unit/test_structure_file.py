"""The small file of an identified structure: what is left out is left to the records, what is wrong
is told with place, value and remedy.
"""

import pytest

from vibroimpact.completion.own_study import check_names, default_places
from vibroimpact.completion.structure_file import StructureFile, read_structure
from vibroimpact.config.reading import ConfigError


def written(folder, text):
    """The path of a file with a text."""
    path = folder / "x.yaml"
    path.write_text(text)
    return str(path)


def test_everything_may_be_left_out(tmp_path):
    assert (
        read_structure(written(tmp_path, "structure: {kind: identified}"))
        == StructureFile()
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
    assert found == StructureFile(
        (5, 60), "a1", {"joint": {"a1": -1, "a2": 1}}, ("cubic_stiffness.joint",), (), (True, False)
    )


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
    ],
)
def test_errors_in_the_structure_file_are_reported(tmp_path, key, told):
    with pytest.raises(ConfigError) as error:
        read_structure(written(tmp_path, f"structure:\n  kind: identified\n  {key}\n"))
    assert (
        str(error.value).startswith(f"{tmp_path}/x.yaml: {told}") and len(error.value.problems) == 1
    )


def test_unknown_channel_names_are_listed_with_known_ones():
    asked = StructureFile(
        drive="b",
        places={"joint": {"a1": -1, "c": 1}},
        candidates=("clearance.root",),
        source="x.yaml",
    )
    with pytest.raises(ConfigError) as error:
        check_names(asked, ["a1", "a2"])
    places = [
        problem.removeprefix("x.yaml: structure.").split(" is ")[0]
        for problem in error.value.problems
    ]
    assert places == ["drive = 'b'", "places.joint.c", "candidates: 'clearance.root'"]
    assert "the usable channels are a1, a2" in str(error.value)


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
