"""The stability of tubes from their configuration."""

import csv

import numpy as np
import pytest

import vibroimpact as vi
from tests.support.straight_path import straight_path
from vibroimpact.cli import main
from vibroimpact.config.problems import ConfigError
from vibroimpact.flow.along import tube_in_flow
from vibroimpact.flow.stability import NoFlow

FLOW = {
    "velocity_m_per_s": [1.0],
    "density_kg_per_m3": 1000.0,
    "direction": [0.0, 1.0, 0.0],
    "criterion": {"kind": "connors", "constant": [4.5]},
}
QUASI_STEADY = {
    "kind": "lags",
    "stiffness": 20.0,
    "damping": 0.3,
    "amplitudes": [-20.0],
    "rates": [1.0],
}


def tube(outer, wall, material, ends, fluid=(), flow=None, zeta=0.0015, **keys):
    """A straight tube of 1 m along z."""
    section = {"kind": "tube", "outer_diameter_m": outer, "wall_thickness_m": wall}
    structure = straight_path(1.0, [0.0, 0.0, 1.0], section, material, ends, fluid=list(fluid))
    return vi.check_config(
        {
            "study": "tube_in_flow",
            "structure": structure | {"mesh": {"elements_per_span": 40}},
            "damping": {"kind": "modal", "other_ratio": zeta},
            "points": {"middle": [0.0, 0.0, 0.5]},
            "excitation": {
                "kind": "band_limited",
                "point": "middle",
                "direction": [0.0, 1.0, 0.0],
                "band_Hz": [5.0, 200.0],
            },
            "grid": {"load_rms_N": [1.0], "gap_m": [1e-4], "seeds": 1},
            "record": {"sensors": {"points": ["middle"], "directions": ["x", "y"]}},
            "flow": FLOW if flow is None else FLOW | flow,
        }
        | keys,
        "a test",
    )


def test_a_clamped_tube_in_a_parabola_of_water():
    """code_aster's sdll152a: ratio 0.200887, with metal of 2500 kg/m3 in m_bar of V_c."""
    cells = 50
    ends = np.linspace(0.0, 1.0, cells + 1)
    middle = 0.5 * (ends[1:] + ends[:-1])
    flow = {
        "stretches": [
            {"from_m": [0, 0, a], "to_m": [0, 0, b], "velocity_factor": 4.0 * s * (1.0 - s)}
            for a, b, s in zip(ends[:-1], ends[1:], middle, strict=True)
        ]
    }
    added = {"kind": "coefficient", "added_mass_coefficient": 0.8 / (1000.0 * np.pi * 0.02**2)}
    fluid = [
        {"kind": "inside", "density_kg_per_m3": 1000.0},
        {"kind": "outside", "density_kg_per_m3": 1000.0, "confinement": added},
    ]
    config = tube(0.04, 0.005, (210e9, 0.3, 7800.0), ("clamped", "clamped"), fluid, flow)
    row = vi.stability(config).rows[0]
    area, inside = np.pi * (0.02**2 - 0.015**2), 1000.0 * np.pi * 0.015**2
    mass, of_the_test = (density * area + inside + 0.8 for density in (7800.0, 2500.0))
    critical = row.critical_low * np.sqrt(of_the_test / mass)
    assert critical == pytest.approx(4.566805, rel=2e-3)
    assert row.effective / critical == pytest.approx(0.200887, rel=2e-3)


MIXTURE = {
    "void_fraction": 0.85,
    "liquid_density_kg_per_m3": 750.0,
    "vapour_density_kg_per_m3": 33.2,
}
BUNDLE = {"kind": "bundle", "pitch_m": 0.0325, "pattern": "square"}


def in_steam(void=0.85, numbers=None, flow=None, confinement=None, zeta=0.0):
    """A tube of a square bundle in steam and water; numbers: of two_phase_damping."""
    mixture = MIXTURE | {"void_fraction": void}
    outside = {"kind": "outside", "viscosity_Pa_s": 0.0, "confinement": confinement or BUNDLE}
    fluid = [
        {"kind": "inside", "density_kg_per_m3": 740.0},
        outside | {"mixture": mixture, "two_phase_damping": numbers},
    ]
    rule = {"kind": "connors", "constant": [3.0, 2.4]}
    given = {"density_kg_per_m3": None, "mixture": mixture, "criterion": rule} | (flow or {})
    material, ends = (211e9, 0.3, 8190.0), ("pinned", "pinned")
    return tube(0.02222, 0.00127, material, ends, fluid, given, zeta=zeta)


def check_again(config):
    """A configuration read from its own numbers."""
    return vi.check_config(config.model_dump(mode="json"), "again")


def test_a_tube_of_a_square_bundle_in_steam_and_water():
    row = vi.stability(in_steam(zeta=0.01)).rows[0]
    assert row.frequency == pytest.approx(49.431, rel=2e-3)
    assert row.critical_high == pytest.approx(3.1031, rel=2e-3)
    assert row.critical_low == pytest.approx(2.4825, rel=2e-3)
    assert row.effective == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize(
    ("void", "ratio"), [(0.85, 0.01047), (0.0, 0.0), (0.2, 0.5), (0.6, 1.0), (1.0, 0.0)]
)
def test_two_phases_damp_between_liquid_and_vapour(void, ratio):
    """1.047 % at 85 %; elsewhere the share of the plateau, whose ratio is over the mass."""
    numbers = {"coefficient": 0.04, "plateau": [0.4, 0.7]}
    config = in_steam(void, numbers)
    row = vi.stability(config).rows[0]
    if void != 0.85:
        mass = float(tube_in_flow(config, config.flow).along.mass.mean())
        ratio *= 0.04 * 750.0 * 0.02222**2 / mass * 1.38695
    assert row.damping_ratio == pytest.approx(ratio, rel=1e-3, abs=1e-12)


def test_a_mixture_has_the_mean_density_everywhere():
    """As the flow, the added mass and the flow of a stretch."""
    stretch = {"from_m": [0, 0, 0], "to_m": [0, 0, 1], "mixture": MIXTURE}
    config = in_steam(flow={"stretches": [stretch], "mixture": None, "density_kg_per_m3": 9.0})
    along = tube_in_flow(config, config.flow).along
    assert along.density == pytest.approx(0.85 * 33.2 + 0.15 * 750.0)
    assert config.structure.fluid[1].density_kg_per_m3 == pytest.approx(140.72)
    assert check_again(config) == config


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ({"void": 85.0}, "structure.fluid[1].mixture.void_fraction = 85.0 must be <= 1"),
        ({"void": -0.1}, "flow.mixture.void_fraction = -0.1 must be >= 0"),
        ({"flow": {"density_kg_per_m3": 500.0}}, "500.0 is not that of the mixture, 140.72"),
        ({"flow": {"mixture": None}}, "flow.density_kg_per_m3 is missing: give it, or a mixture"),
        ({"numbers": {"coefficient": 0.04}}, "damping.plateau is missing"),
        ({"numbers": {"coefficient": 4.0, "plateau": [0.4, 0.7]}}, "4 % is 0.04"),
        ({"confinement": {"kind": "coefficient", "added_mass_coefficient": 1.0}}, "annulus"),
    ],
)
def test_bad_mixtures_are_refused(keys, told):
    numbers = {"coefficient": 0.04, "plateau": [0.4, 0.7]}
    with pytest.raises(ConfigError) as refused:
        in_steam(**({"numbers": numbers} | keys))
    assert told in str(refused.value)
    assert len(refused.value.problems) <= 2


def supported(**flow):
    """A pinned tube with two supports, in a flow."""
    supports = [
        {
            "name": name,
            "at_m": [0.0, 0.0, at],
            "height_m": 0.01,
            "points": 1,
            "stiffness_N_per_m": 2e6,
            "profile": {"kind": "drilled"},
        }
        for name, at in (("low", 0.3), ("high", 0.7))
    ]
    material, ends = (211e9, 0.3, 8190.0), ("pinned", "pinned")
    return tube(0.02, 0.001, material, ends, flow=flow, zeta=0.01, supports=supports)


def test_a_support_that_does_not_hold_costs_stability():
    found = vi.stability(supported(), inactive=2)
    ratios = [found.worst(1.0, number).ratio_high for number in (0, 1, 2)]
    assert ratios == sorted(ratios) and ratios[2] > 5.0 * ratios[0]
    assert {row.inactive for row in found.rows} == {"", "low", "high", "low+high"}


def test_soft_supports_are_between_none_and_rigid_ones():
    config = supported()
    free = vi.stability(config, inactive=2).worst(1.0, 2).critical_low
    soft, hard = (vi.stability(config, k).rows[0].critical_low for k in (1e4, 1e9))
    assert free < soft < hard


def test_a_uniform_flow_couples_no_modes():
    """Its eigenvalues are those of each mode alone."""
    flow = {"coupling": QUASI_STEADY, "velocity_m_per_s": [2.0]}
    config = tube(0.02, 0.001, (211e9, 0.3, 8190.0), ("pinned", "pinned"), flow=flow, zeta=0.01)
    found = vi.stability(config)
    mass = 8190.0 * np.pi * (0.01**2 - 0.009**2)
    omega = 2.0 * np.pi * found.rows[0].frequency
    velocity = found.eigenvalues.critical
    load = 0.5 * 1000.0 * velocity**2 / mass
    lag = velocity / 0.02
    drag = 0.02 * omega + 0.5 * 1000.0 * velocity * 0.02 * 0.3 / mass
    polynomial = [
        1.0,
        drag + lag,
        omega**2 + load * 20.0 + lag * drag - 20.0 * load,
        lag * (omega**2 + load * 20.0),
    ]
    assert np.roots(polynomial).real.max() == pytest.approx(0.0, abs=1e-5 * omega)


@pytest.mark.parametrize(
    ("flow", "place"),
    [
        ({"direction": [0.0, 0.0, 1.0]}, "flow.direction"),
        ({"stretches": [{"from_m": [0, 0, 0], "to_m": [0, 1, 0]}]}, "flow.stretches[0].to_m"),
        ({"velocity_m_per_s": [-1.0]}, "flow.velocity_m_per_s"),
        ({"criterion": {"kind": "tema", "pattern_deg": 30, "pitch_m": 0.01}}, "pitch_m"),
        ({"criterion": {"kind": "tema", "pattern_deg": 31, "pitch_m": 0.1}}, "pattern_deg"),
        ({"coupling": QUASI_STEADY | {"rates": []}}, "flow.coupling.rates"),
    ],
)
def test_bad_flows_are_refused(flow, place):
    with pytest.raises(ConfigError) as refused:
        supported(**flow)
    assert place in str(refused.value)


def test_a_configuration_without_flow_is_told_what_it_needs():
    with pytest.raises(NoFlow, match="velocity_m_per_s"):
        vi.stability(vi.changed_config(supported(), {"flow": None}))


def test_the_command_writes_tables_and_a_figure(tmp_path, capsys):
    example = "config/examples/u_tube_drilled.yaml"
    assert main(["stability", example, "--inactive", "1", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert "cold_3" in printed and "unstable" in printed
    with open(tmp_path / "stability.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 7 * 2 * 2 * 8
    assert (tmp_path / "figure_stability.png").stat().st_size > 10_000
    assert main(["stability", example, "--stiffness", "-1"]) == 1
    assert "--stiffness -1" in capsys.readouterr().err
