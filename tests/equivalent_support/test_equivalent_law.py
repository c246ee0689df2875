"""The law that estimates k and c without a simulation, and what it was measured to miss by."""

import numpy as np
import pytest
import yaml

from evidence.validation.prediction.law_errors import error_rows, tube_rows
from evidence.validation.prediction.laws import EquivalentLaw, fit_displacement_law, law_text
from tests.conftest import ROOT
from tests.support.one_mass import ALONG_X, one_mass
from vibroimpact import EquivalentError, build_model, check_config, estimate_equivalent, load_config
from vibroimpact.config.yaml_file import read_yaml
from vibroimpact.equivalent_support.displacement_law import (
    LAW_FILE,
    DisplacementLaw,
    held_tube,
    shipped_law,
)
from vibroimpact.identify.linear.responses import frf
from vibroimpact.io.records import read_table
from vibroimpact.study.method_agreement import COMPARED

BAND = (5.0, 200.0)
GAP = 2.8886e-4


@pytest.fixture(scope="module")
def tube(study_model):
    """The study's tube on its plates."""
    return held_tube(study_model, BAND)


def changed(**keys):
    """The study's configuration with top-level keys replaced."""
    data = yaml.safe_load((ROOT / "config" / "study.yaml").read_text())
    return check_config(data | keys, "changed")


def test_held_motion_of_one_mass_is_that_of_the_closed_form():
    """RMS displacement pi f G / (4 zeta K²) of an oscillator under a flat one-sided PSD G."""
    mass, stiffness, ratio, wide = 1.0, 63165.0, 0.01, (0.5, 4000.0)
    values = one_mass(
        stiffness,
        damping={"kind": "modal", "first_ratios": [ratio], "other_ratio": ratio},
        supports=[{"name": "stop", "point": "mass", "stiffness_N_per_m": 1.0e6}],
        excitation={"kind": "band_limited", "band_Hz": list(wide), **ALONG_X},
        integration={"steps_per_second": 102400},
        record={"duration_s": 20.0, "sampling_frequency_Hz": 10240},
    )
    config = check_config(values, "mass")
    held = held_tube(build_model(config), wide)
    for place in (0, 80, 144):
        total = stiffness + held.stiffness[place]
        frequency = np.sqrt(total / mass) / (2.0 * np.pi)
        zeta = ratio * np.sqrt(stiffness / total)  # the damper of the mass stays as it is
        psd = 1.0 / (wide[1] - wide[0])
        expected = np.sqrt(np.pi * frequency * psd / (4.0 * zeta * total**2))
        assert held.motion[place] == pytest.approx(expected, rel=0.01)
        assert held.omega[place] == pytest.approx(2.0 * np.pi * frequency, rel=1e-9)


def test_held_motion_of_the_tube_is_that_of_its_frf(study_model, tube):
    k, step = 1.0e5, 0.002
    middle = study_model.contact_shapes[:, [2, 7], 1]
    power = np.abs(frf(study_model, k, 0.0, np.arange(*BAND, step), middle)) ** 2
    assert tube.held(k, 2.0, GAP) == pytest.approx(2.0 * np.sqrt(power.mean()) / GAP, rel=0.01)


def test_the_stiffness_that_holds_a_motion_is_found_again(tube):
    for k in (3.0e3, 5.0e4, 1.0e6):
        assert tube.stiffness_at(tube.held(k, 3.0, GAP), 3.0, GAP) == pytest.approx(k, rel=1e-3)
    assert tube.stiffness_at(10.0 * tube.level(3.0, GAP), 3.0, GAP) == tube.stiffness[0]  # free
    assert tube.stiffness_at(1e-6, 3.0, GAP) == pytest.approx(4.0e6)  # the contact stiffness


def test_a_law_is_fitted_back_from_what_it_says(tube):
    level = np.geomspace(0.6, 20.0, 30)
    given = DisplacementLaw(level, 1.5 * level / (1.5 + level), 0.3 / (1.0 + 0.1 * level))
    rows = []
    for load in np.geomspace(1.2, 15.0, 40):
        names = ("load_rms_N", "gap_m", "k_median", "c_median")
        row = dict(zip(names, (load, GAP, *given.at(tube, load, GAP)), strict=True))
        rows += [row | {"method": method} for method in COMPARED]
    found = fit_displacement_law(rows, tube)
    for load in (2.0, 5.0, 10.0):
        assert found.at(tube, load, GAP) == pytest.approx(given.at(tube, load, GAP), rel=0.03)


def test_k_depends_on_load_over_gap_alone(tube):
    law = shipped_law().law
    assert law.at(tube, 4.0, GAP) == pytest.approx(law.at(tube, 8.0, 2.0 * GAP), rel=1e-12)


def test_the_shipped_law_joins_the_free_tube():
    law = shipped_law().law
    assert np.all(np.diff(law.level) > 0.0) and np.all(law.held < law.level)
    assert law.held[0] == pytest.approx(law.level[0], rel=0.05)  # hardly touching: free
    assert 1.2 < law.held[law.level > 4.0].min() and law.held.max() < 2.0  # rattling: the gap


def test_the_shipped_errors_are_those_of_its_cases():
    shipped = shipped_law()
    rows = read_table(LAW_FILE.with_name("displacement_law_errors.csv"))
    assert len({row["tube"] for row in rows}) == 8
    for stated, computed in zip(shipped.errors, error_rows(rows), strict=True):
        assert stated == pytest.approx(computed, rel=1e-3)
    ratios = [row["k_secant"] / row["k_law"] for row in rows]
    assert np.median(ratios) == pytest.approx(1.1, abs=0.2)


@pytest.mark.slow
def test_the_errors_of_a_tube_are_found_again(study_config):
    """One level of one tube is simulated again. Impacts are chaotic: round-off, such as that of
    another linear algebra, changes a record of 24 s by its statistical error.
    """
    tubes = read_yaml(ROOT / "config" / "validation" / "other_tubes.yaml")
    law, other = shipped_law().law, EquivalentLaw(np.array([0.1, 100.0]), np.ones(2), np.ones(2))
    name = "more_damping"
    (found,) = tube_rows(study_config, name, tubes[name], law, other, levels=(3.0,))
    rows = read_table(LAW_FILE.with_name("displacement_law_errors.csv"))
    place = (name, found["load_rms_N"])
    stored = next(row for row in rows if (row["tube"], row["load_rms_N"]) == place)
    within = dict.fromkeys(("level", "k_law", "c_law"), 1e-4) | {"k_secant": 0.06}
    for name, tolerance in (within | {"k_identified": 0.2, "c_identified": 0.2}).items():
        assert found[name] == pytest.approx(stored[name], rel=tolerance)


def test_a_law_is_read_as_it_was_written(tmp_path):
    shipped = shipped_law()
    path = tmp_path / "law.json"
    path.write_text(law_text(shipped.law, shipped.errors, shipped.origin))
    again = shipped_law(path)
    np.testing.assert_array_equal(again.law.held, shipped.law.held)
    assert again.errors == shipped.errors and again.origin == shipped.origin
    assert again.origin["study"] == "gv_local"


def test_the_estimate_states_its_interval_and_that_it_is_one(study_config):
    answer = estimate_equivalent(study_config, 5.0, 2.5e-4)
    (group,) = answer.groups
    assert answer.kind == "estimate" and "This is an estimate from a law" in answer.notes[0]
    assert group.k.low < group.k.value < group.k.high and group.supports == ("left", "right")
    assert group.k.low < 7.6e4 < group.k.high  # what the default study says there
    assert group.c.low < 205.0 < group.c.high


@pytest.mark.parametrize("load", [0.1, 100.0])
def test_the_law_is_not_extrapolated(study_config, load):
    with pytest.raises(EquivalentError, match="Nothing is extrapolated") as no:
        estimate_equivalent(study_config, load, 2.5e-4)
    assert "gaps RMS at its plates; the law was fitted from" in str(no.value)


def test_what_the_law_does_not_know_is_refused():
    support = {"name": "left", "at_m": [-0.3, 0.0, 0.35], "height_m": 0.03}
    support["stiffness_N_per_m"] = 4.0e6
    with pytest.raises(EquivalentError, match="a gap fixed in m of support left"):
        estimate_equivalent(changed(supports=[support | {"gap_m": 1.0e-4}]), 5.0, 2.5e-4)
    with pytest.raises(EquivalentError, match="has no supports"):
        estimate_equivalent(changed(supports=[], identification=None), 5.0, 2.5e-4)
    rubbing = estimate_equivalent(changed(supports=[support | {"friction": 0.2}]), 5.0, 2.5e-4)
    assert "without friction, which this model has" in rubbing.notes[1]
    damping = {"kind": "rayleigh", "mass_coefficient_per_s": 1.0e3, "stiffness_coefficient_s": 0.0}
    with pytest.raises(EquivalentError, match="a mode of the structure is overdamped"):
        estimate_equivalent(changed(damping=damping), 5.0, 2.5e-4)
    harmonic = load_config(ROOT / "config" / "four_supports.yaml")
    with pytest.raises(EquivalentError, match="excitation.kind is harmonic"):
        estimate_equivalent(harmonic, 5.0, 2.5e-4)
