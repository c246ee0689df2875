"""A tube with gaps in flows of rising velocity, and the linear tubes that stand for it."""

from dataclasses import replace

import numpy as np
import pytest

import vibroimpact as vi
from vibroimpact.cli import main
from vibroimpact.flow.coupled import describing_stiffness
from vibroimpact.reports.figures.drawing import drawn
from vibroimpact.reports.figures.flow import flow_sweep_figures
from vibroimpact.study.flow_sweep import (
    Equivalent,
    FlowRun,
    at_velocity,
    equivalent_onset,
    flow_sweep,
    onset_of,
)

EXAMPLE = "config/examples/u_tube_flow.yaml"
QUICK = {
    "grid.load_rms_N": [0.1],
    "grid.seeds": 1,
    "flow.velocity_m_per_s": [0.3, 2.4],
    "integration.start_up_s": 2.0,
    "record.duration_s": 2.0,
    "spectra.segment_s": 1.0,
}


def test_describing_function_of_a_stop():
    """Against the first harmonic of the force, by quadrature."""
    angle = (np.arange(200_000) + 0.5) * 2.0 * np.pi / 200_000
    for amplitude in (1.05, 1.5, 4.0):
        u = amplitude * np.cos(angle)
        force = np.sign(u) * np.maximum(np.abs(u) - 1.0, 0.0)
        harmonic = 2.0 * np.mean(force * np.cos(angle)) / amplitude
        found = describing_stiffness(1.0, np.array([amplitude]))[0]
        assert found == pytest.approx(harmonic, rel=1e-6)
    assert describing_stiffness(1.0, np.array([0.5])) == 0.0


def runs(levels):
    """Runs at 0, 1, 2, ... m/s with given responses."""
    run = FlowRun(1.0, 1e-4, 0.0, "small", 0, 1.0, 0.0, 0.0, 0.0, 1.0, False)
    return [
        replace(run, velocity_m_per_s=float(v), rms_m=rms, coupled=v > 0)
        for v, rms in enumerate(levels)
    ]


@pytest.mark.parametrize(
    ("levels", "expected"),
    [((1.0, 1.1, 1.2), np.nan), ((1.0, 1.0, 1.25**2), 1.5), ((1.0, 1.0, np.inf), 2.0)],
)
def test_onset_is_where_the_response_leaves(levels, expected):
    assert onset_of(runs(levels)) == pytest.approx(expected, nan_ok=True)


def test_sweep_of_the_example():
    found = flow_sweep(vi.changed_config(EXAMPLE, QUICK))
    (onset,) = found.onsets
    assert onset.open_m_per_s == pytest.approx(0.3151, rel=1e-3)
    assert onset.closed_m_per_s == pytest.approx(3.202, rel=1e-3)
    assert onset.open_m_per_s < onset.equivalent_m_per_s < 0.5
    assert len(found.runs) == 3 * 2
    at = {(run.start, run.velocity_m_per_s): run for run in found.runs}
    for start in ("small", "large"):
        still, fast = at[start, 0.0], at[start, 2.4]
        assert still.fluid_power_W == 0.0 < fast.fluid_power_W
        assert fast.contact_fraction > 3.0 * still.contact_fraction
        # ten times above the critical velocity of the open supports the bars still hold the tube
        assert 1.25 * still.rms_m < fast.rms_m < 2.0 * 0.2e-3
    (sheet,) = map(drawn, flow_sweep_figures(found))
    small = [row for row in sheet.rows() if row["curve"] == "0.1 N, small start"]
    assert len(small) == 6


def test_growth_without_bound_is_told():
    """A frozen negative damping beyond the critical velocity of the closed supports."""
    law = {"kind": "negative_damping", "constant": 1.0, "frequency_Hz": 30.0}
    config = vi.changed_config(EXAMPLE, QUICK | {"flow.coupling": law})
    found = flow_sweep(vi.changed_config(config, {"flow.velocity_m_per_s": [0.01, 2.0]}))
    assert {run.velocity_m_per_s for run in found.runs if np.isinf(run.rms_m)} == {2.0}
    assert all(own.small_m_per_s <= 2.0 for own in found.onsets)


def test_a_sweep_without_a_force_is_told_what_it_needs(capsys):
    assert main(["stability", "config/examples/u_tube_drilled.yaml", "--simulate"]) == 1
    assert "flow.coupling" in capsys.readouterr().err


def test_turbulence_that_follows_has_the_load_of_its_spectrum():
    """A two-phase force rises with V^0.5, the dynamic pressure with V^2."""
    for turbulence, expected in (
        ({"kind": "dimensionless"}, 0.25**0.5),
        ({"kind": "power", "exponent": 2.0, "at_m_per_s": 2.0}, 0.25**2),
        (None, 1.0),
    ):
        config = vi.changed_config(EXAMPLE, {"flow.turbulence": turbulence})
        moved, share = at_velocity(config, 0.5)
        assert share == pytest.approx(expected, rel=1e-6)
        moves = turbulence is not None and turbulence["kind"] == "dimensionless"
        assert moved.excitation.spectrum.velocity_m_per_s == (0.5 if moves else 2.0)


def test_turbulence_at_its_own_velocity_is_that_of_the_grid():
    config = vi.changed_config(EXAMPLE, {"flow.turbulence": {"kind": "dimensionless"}})
    moved, share = at_velocity(config, 2.0)
    assert share == 1.0 and moved.excitation == config.excitation


def test_a_sweep_with_turbulence_that_follows():
    """Each velocity has a run under its turbulence alone, from which the response leaves."""
    found = flow_sweep(
        vi.changed_config(EXAMPLE, QUICK | {"flow.turbulence": {"kind": "dimensionless"}})
    )
    assert len(found.runs) == 2 * 4
    forces = {run.velocity_m_per_s: run.force_rms_N for run in found.runs}
    assert forces[2.4] / forces[0.3] == pytest.approx(np.sqrt(8.0), rel=1e-3)
    slow, fast = found.equivalents
    assert slow.k_N_per_m == 0.0 < fast.k_N_per_m
    assert 0.3 < found.onsets[0].equivalent_m_per_s < 0.4
    assert all(run.fluid_power_W == 0.0 for run in found.runs if not run.coupled)
    (sheet,) = map(drawn, flow_sweep_figures(found))
    alone = [row for row in sheet.rows() if "turbulence alone" in row["curve"]]
    assert len(alone) == 2


@pytest.mark.parametrize(
    ("critical", "expected"),
    [
        ((3.0, 3.0, 3.0), np.nan),
        ((2.0, 2.0, 2.0), 2.0),
        ((0.5, 2.0, 2.0), 0.5),
        ((np.nan, 1, 1), 2.0),
    ],
)
def test_onset_of_linear_tubes_that_change(critical, expected):
    tubes = [
        Equivalent(1.0, 1e-4, v, 1.0, 0.0, 0.0, c)
        for v, c in zip((1.0, 2.0, 2.5), critical, strict=True)
    ]
    assert equivalent_onset(tubes) == pytest.approx(expected, nan_ok=True)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"excitation.spectrum": {"kind": "flat"}}, "flow.turbulence.kind = 'dimensionless' needs"),
        (
            {
                "excitation.spectrum": {
                    "kind": "reduced_table",
                    "reduced_frequency": [0.02, 2.5],
                    "reduced_psd": [1.0, 0.1],
                    "velocity_m_per_s": 2.0,
                    "fluid_density_kg_per_m3": 180.0,
                }
            },
            "flow.velocity_m_per_s = 0.2 is too far for the spectrum, which does not cover",
        ),
    ],
)
def test_turbulence_that_can_not_follow_is_refused(changes, told):
    with pytest.raises(vi.ConfigError) as refused:
        vi.changed_config(EXAMPLE, changes | {"flow.turbulence": {"kind": "dimensionless"}})
    assert told in str(refused.value)
