"""What `check` says of a tube in a flow: its modes with supports open, closed and equivalent."""

import re

import pytest

import vibroimpact as vi
from tests.flow.test_stability import QUASI_STEADY, supported
from vibroimpact.cli import main
from vibroimpact.equivalent_support.in_flow import modes_in_flow


def test_closed_supports_hold_to_a_higher_velocity():
    config = supported(coupling=QUASI_STEADY, velocity_m_per_s=[5.0])
    told = re.findall(r"growth from ([\d.]+) m/s", modes_in_flow(config))
    free, held, equivalent = map(float, told)
    found = [vi.stability(config, stiffness=k).eigenvalues.critical for k in (0.0, None)]
    assert [free, held] == pytest.approx(found, rel=1e-3)
    assert free < equivalent < held and 2.0 * free < held


def test_check_prints_the_modes_with_equivalent_supports(capsys):
    """The law holds for this force: its stiffness is between open and closed."""
    assert main(["check", "config/examples/u_tube_drilled.yaml"]) == 0
    printed = capsys.readouterr().out
    named = re.findall(r"supports (\w+).*?: ([\d.]+) Hz.*?V_eff / V_c ([\d.]+)", printed)
    assert [name for name, *_ in named] == ["open", "closed", "equivalent"]
    frequencies = {name: float(frequency) for name, frequency, _ in named}
    assert frequencies["open"] < frequencies["equivalent"] < frequencies["closed"]


def test_check_of_a_study_without_flow_says_nothing_of_one(capsys):
    assert main(["check", "config/smoke.yaml"]) == 0
    assert "in the flow" not in capsys.readouterr().out
