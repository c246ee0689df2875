"""From files to a verdict: a beam with a stop, and campaigns of the independent code."""

import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from tests.support.straight_path import straight_path
from vibroimpact.campaign.file import write_campaign
from vibroimpact.campaign.importing.assemble import import_folder
from vibroimpact.config.reading import check_config
from vibroimpact.diagnosis.diagnose import diagnose, run_diagnosis, write_diagnosis

UFF = Path(__file__).resolve().parents[3] / "shared/data/held/beam_with_stop"
SENSORS = {"a30": (3, 0.3), "a45": (45, 0.45), "tip": (6, 0.6)}
CHANNELS = [
    {
        "name": name,
        "variable": f"{node}:+y",
        "kind": "acceleration",
        "point_m": [at, 0.0, 0.0],
        "direction": "+y",
    }
    for name, (node, at) in SENSORS.items()
]
SIDECAR = {
    "source": "a cantilever that meets something",
    "antialias": "none",
    "forces": [
        {
            "name": "shaker",
            "variable": "2:+y",
            "unit": "N",
            "point_m": [0.2, 0.0, 0.0],
            "direction": "+y",
        }
    ],
    "channels": CHANNELS,
    "records": [{"name": f"level {n}", "file": f"level{n}.uff"} for n in (1, 2, 3, 4)],
}
CANTILEVER = {
    "study": "cantilever",
    "seed": 1,
    "structure": straight_path(
        0.6,
        [1.0, 0.0, 0.0],
        {"kind": "rectangle", "sides_m": [0.006, 0.03], "first_axis": [0, 1, 0]},
        (2.05e11, 0.3, 7850.0),
    ),
    "damping": {"kind": "modal", "first_ratios": [0.008], "other_ratio": 0.008},
    "supports": [],
    "points": {"shaker": [0.2, 0.0, 0.0], "tip": [0.6, 0.0, 0.0]},
    "excitation": {
        "kind": "band_limited",
        "point": "shaker",
        "direction": [0.0, 1.0, 0.0],
        "band_Hz": [8.0, 400.0],
    },
    "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-3], "seeds": 1},
    "record": {
        "duration_s": 8.0,
        "sensors": {"points": ["tip"], "directions": ["x", "y", "z"]},
        "shape_line": {"points": 7, "direction": "y"},
    },
}


@pytest.mark.slow
def test_one_sided_stop_of_a_beam_is_named_from_universal_files(tmp_path):
    """At 0.5 m, 0.5 mm away on the positive side, 2e5 N/m."""
    if not UFF.is_dir():
        pytest.skip(f"no files in {UFF}: put level1.uff to level4.uff there")
    for file in UFF.glob("*.uff"):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    (tmp_path / "campaign.yaml").write_text(yaml.safe_dump(SIDECAR))
    write_campaign(import_folder(tmp_path)[0], tmp_path / "beam.nc")
    verdict = diagnose(tmp_path / "beam.nc", check_config(CANTILEVER, "cantilever"))
    assert verdict.verdict == "named"
    (stop,) = verdict.effects
    assert stop.id == "one_sided_stop"
    place, turned = stop.location.removeprefix("arc_").split("mm_turned_")
    assert float(place.replace("_", ".")) == pytest.approx(500.0, abs=10.0)
    assert abs(float(turned.removesuffix("deg").replace("m", "-").replace("_", "."))) < 45.0
    assert stop.parameters["gap"].value == pytest.approx(5.0e-4, rel=0.03)
    assert stop.parameters["stiffness"].value == pytest.approx(2.0e5, rel=0.15)


def made(folder, *arguments):
    """A campaign of the independent code in a folder."""
    command = [sys.executable, "-m", "evidence.truth", "one", "--no-twin", "--duration", "10"]
    subprocess.run(
        [*command, "--out", str(folder / "x.nc"), "--levels", LEVELS, *arguments], check=True
    )
    return folder / "x.nc"


LEVELS = "0.8:1.3:fit,4:1.3:fit,20:1.3:fit,12:1.3:holdout"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("hidden", "parameter", "value"),
    [
        ((), None, None),
        (("--effect", "contact_damping", "--set", "damping=1000"), "damping", 1000.0),
        (("--effect", "added_mass", "--set", "mass=0.08"), "mass", 0.08),
    ],
    ids=["nothing", "contact damping", "mass"],
)
def test_what_another_code_hid_is_named(study_config, tmp_path, hidden, parameter, value):
    found = run_diagnosis(made(tmp_path, *hidden), study_config, "quick", threads=2)
    verdict = found.verdict
    if parameter is None:
        assert verdict.verdict == "none" and verdict.probability_none > 0.8
        return
    assert verdict.verdict == "named"
    assert verdict.effects[0].id == hidden[1]
    assert verdict.effects[0].parameters[parameter].value == pytest.approx(value, rel=0.1)
    assert verdict.misfit.holdout.after_dB < verdict.misfit.holdout.before_dB
    write_diagnosis(found, tmp_path)
    completed = (tmp_path / "model_updated.yaml").read_text(encoding="utf-8")
    assert check_config(yaml.safe_load(completed), "completed")


def test_campaign_without_a_usable_channel_is_not_testable(study_config, comparison):
    campaign = comparison.structure.campaign.copy(deep=True)
    campaign["channel_kind"].values[:] = "generic"
    verdict = diagnose(campaign, study_config)
    assert verdict.verdict == "not_testable" and verdict.next_measurement


def test_unknown_effort_is_refused(study_config, comparison):
    with pytest.raises(ValueError, match="give one of quick, standard, thorough"):
        diagnose(comparison.structure.campaign, study_config, "most")
