"""Rows of the fluid-elastic force of a tube: they stand for the whole flow along it."""

import numpy as np
import pytest

import vibroimpact as vi
from tests.flow.test_in_time import damping_ratio, run
from tests.flow.test_stability import QUASI_STEADY, supported
from vibroimpact.excitation.fluid_elastic import fluid_force
from vibroimpact.flow.coupled import Zone, critical_velocity, oscillations, system
from vibroimpact.study.model_checks import check_model

ZONES = [
    {"from_m": [0, 0, 0.1], "to_m": [0, 0, 0.5], "velocity_factor": 0.7},
    {"from_m": [0, 0, 0.5], "to_m": [0, 0, 0.9], "density_kg_per_m3": 400.0},
]
LAGS = {"coupling": QUASI_STEADY, "velocity_m_per_s": [20.0], "acting_m_per_s": 12.0}


def acting(**flow):
    """A pinned tube with two supports, in a flow that acts."""
    return supported(**(LAGS | {"stretches": ZONES} | flow))


def of_rows(config, stiffness):
    """(Hz, damping ratios) at the acting velocity, and V_c, from the rows of the model."""
    model, force = vi.build_model(config), fluid_force(config.flow.coupling, 0.02)
    own, factors = config.flow.acting_m_per_s, model.fluid_laws.velocity
    zones = [
        Zone(velocity / own, rows @ rows.T)
        for velocity in np.unique(factors)
        for rows in [model.fluid_shapes[:, factors == velocity]]
    ]
    contact = model.contact_shapes.reshape(model.modes, -1)
    stiff = np.diag(model.omega**2) + stiffness * contact @ contact.T
    parts = stiff, np.diag(model.damping), force, zones
    return oscillations(system(*parts, own), 4), critical_velocity(*parts, 60.0)


@pytest.mark.parametrize("stiffness", [0.0, 2e6])
def test_rows_have_the_eigenvalues_of_the_whole_flow(stiffness):
    config = acting()
    whole = vi.stability(config, stiffness=stiffness).eigenvalues
    (frequency, ratio), critical = of_rows(config, stiffness)
    at = np.argmin(np.abs(whole.velocity - 12.0))
    assert whole.velocity[at] == pytest.approx(12.0)
    assert frequency == pytest.approx(whole.frequency[at, :4], rel=1e-3)
    assert ratio == pytest.approx(whole.damping_ratio[at, :4], abs=5e-4)
    assert critical == pytest.approx(whole.critical, rel=2e-3)


def test_few_rows_stand_for_the_tube():
    modes, rows = vi.build_model(acting(acting_m_per_s=1.4)).fluid_shapes.shape
    assert 2 <= rows < modes / 4
    still = supported(coupling=QUASI_STEADY)
    assert vi.build_model(still).fluid_shapes.shape[1] == 0


def test_a_tube_in_time_has_the_eigenvalue_of_its_lowest_mode():
    config = acting(acting_m_per_s=1.4)  # V_c is 1.5566 m/s
    model = vi.build_model(config)
    (_, ratio), _ = of_rows(config, 0.0)
    assert sorted(ratio[:2]) == [pytest.approx(0.003, abs=0.003), pytest.approx(0.01)]
    moved = np.abs(model.fluid_shapes).sum(axis=1) > 0.0
    model.initial_displacement[np.flatnonzero(moved)[0]] = 1e-5
    traces = run(model, 1.0, gap=1.0)
    second = traces.contact_displacement[0, 0, 1]
    traces.contact_displacement[0, 0, 0] = second  # along the force
    assert damping_ratio(traces) == pytest.approx(ratio[:2].min(), rel=2e-2)


@pytest.mark.parametrize(
    ("flow", "place"),
    [
        ({"coupling": None}, "flow.acting_m_per_s = 12"),
        ({"acting_m_per_s": -1.0}, "flow.acting_m_per_s = -1"),
        ({"coupling": QUASI_STEADY | {"reduced_velocity": [9.0, 2.0]}}, "reduced_velocity"),
        (
            {"coupling": {"kind": "connors", "constant": 3.0, "band_Hz": [9.0, 2.0]}},
            "flow.coupling.band_Hz",
        ),
    ],
)
def test_a_flow_that_can_not_act_is_refused(flow, place):
    with pytest.raises(vi.ConfigError) as refused:
        acting(**flow)
    assert place in str(refused.value)


def test_a_force_outside_its_fit_is_warned_of():
    fitted = acting(coupling=QUASI_STEADY | {"reduced_velocity": [1.0, 2.0]})
    told = [*check_model(fitted).warnings, *vi.stability(fitted).warnings]
    assert sum("flow.coupling.reduced_velocity = [1.0, 2.0]" in each for each in told) == 2
    wide = acting(coupling=QUASI_STEADY | {"reduced_velocity": [0.01, 100.0]})
    assert not [each for each in check_model(wide).warnings if "reduced" in each]


def test_a_record_holds_the_power_of_the_fluid():
    config = vi.changed_config(
        acting(acting_m_per_s=1.4),
        {"integration.start_up_s": 0.5, "record.duration_s": 1.0},
    )
    # without contact it feeds the lowest mode; the stops raise the frequencies, and it brakes
    free, stopped = (
        vi.simulate_case(config, load, gap) for load, gap in ((0.1, 5e-3), (5.0, 1e-4))
    )
    assert float(free["fluid_power"]) > 0.0 > float(stopped["fluid_power"])
    assert max(float(record["energy_residual"]) for record in (free, stopped)) < 1e-3
