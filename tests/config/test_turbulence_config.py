"""Turbulence in a configuration: what is refused, with place, value and remedy; the load that the
command `check` prints.
"""

import copy
from pathlib import Path

import pytest
import yaml

from vibroimpact.cli import main
from vibroimpact.config.reading import ConfigError, check_config

ROOT = Path(__file__).parents[2]
FORCE = {
    "kind": "turbulence",
    "direction": [0.0, 1.0, 0.0],
    "both_directions": True,
    "correlation_length_m": 0.075,
    "band_Hz": [5.0, 200.0],
    "spectrum": {"kind": "tube_bundle", "velocity_m_per_s": 2.0, "fluid_density_kg_per_m3": 750.0},
}
LEG = {"from_m": [-0.3, 0.0, 0.1], "to_m": [-0.3, 0.0, 0.6]}


@pytest.fixture
def study():
    """The default study under turbulence, without identification."""
    values = yaml.safe_load((ROOT / "config" / "study.yaml").read_text())
    del values["identification"], values["overlay"]
    values["excitation"] = copy.deepcopy(FORCE)
    return values


def refusal(values):
    """The sentences that a configuration is refused with, in one text."""
    with pytest.raises(ConfigError) as refused:
        check_config(values, "mine")
    return "\n".join(refused.value.problems)


def test_turbulence_on_the_study_is_accepted(study):
    config = check_config(study, "mine")
    assert config.excitation.tolerance == 0.01 and config.excitation.stretches == ()
    assert config.excitation.spectrum.shape == "two_slopes"


@pytest.mark.parametrize(
    ("key", "value", "parts"),
    [
        ("direction", [1.0, 0.0, 0.0], ["excitation.direction", "along the tube", "0.0, 1.0]"]),
        ("band_Hz", [0.0, 200.0], ["excitation.band_Hz = [0.0, 200.0]", "above 0 Hz"]),
        ("band_Hz", [5.0, 2000.0], ["steps_per_second", "2000 Hz", "at least 40000"]),
        (
            "stretches",
            [LEG, {"from_m": [-0.3, 0.0, 0.5], "to_m": [-0.3, 0.0, 0.7]}],
            ["stretches[1]", "overlaps stretches[0]"],
        ),
        ("stretches", [{**LEG, "to_m": LEG["from_m"]}], ["stretches[0].to_m", "same place"]),
        (
            "spectrum",
            {"kind": "table", "frequency_Hz": [8.0, 300.0], "psd_N2_per_m2_Hz": [1.0, 0.1]},
            ["spectrum.frequency_Hz = [8.0, 300.0]", "5 to 200", "narrow the band"],
        ),
        (
            "spectrum",
            {"kind": "table", "frequency_Hz": [1.0, 300.0], "psd_N2_per_m2_Hz": [1.0] * 3},
            ["spectrum.frequency_Hz", "3 values", "one value per place"],
        ),
        (
            "spectrum",
            {**FORCE["spectrum"], "kind": "two_phase", "void_fraction": 80},
            ["void_fraction = 80", "80 % is 0.8"],
        ),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(study, key, value, parts):
    study["excitation"][key] = value
    text = refusal(study)
    for part in parts:
        assert part in text


def test_a_stretch_keeps_the_direction_off_the_bend(study):
    study["excitation"] |= {"direction": [1.0, 0.0, 0.0], "stretches": [LEG]}
    check_config(study, "mine")


def test_identification_under_turbulence_needs_its_band(study):
    whole = yaml.safe_load((ROOT / "config" / "study.yaml").read_text())
    study["identification"] = whole["identification"]
    check_config(study, "mine")
    study["excitation"]["band_Hz"] = [20.0, 60.0]
    assert "reaches beyond the excited band [20.0, 60.0] Hz" in refusal(study)


def test_turbulence_on_a_chain_is_refused(study):
    study["structure"] = {"kind": "chain", "masses": [{"name": "one", "mass_kg": 1.0}]}
    study |= {"supports": [], "points": {}}
    study["record"].pop("sensors"), study["record"].pop("shape_line")
    assert "acts along a tube, structure.kind is chain" in refusal(study)


def test_check_prints_the_load_of_a_velocity(study, tmp_path, capsys):
    """1.5075 N, by hand: 2.5849 N/m RMS, the integral of the two slopes at 2 m/s, 750 kg/m3 and
    22.22 mm, times 0.5832 m, the root of the double integral of the correlation over 2.342 m.
    """
    file = tmp_path / "mine.yaml"
    file.write_text(yaml.safe_dump(study))
    assert main(["check", str(file)]) == 0
    assert capsys.readouterr().out.rstrip().endswith("; 2 m/s is a load_rms_N of 1.508")
    study["excitation"]["spectrum"] = {"kind": "flat"}
    file.write_text(yaml.safe_dump(study))
    assert main(["check", str(file)]) == 0
    assert "load_rms_N of" not in capsys.readouterr().out
