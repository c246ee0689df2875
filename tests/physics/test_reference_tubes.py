"""R7 and R8: tubes against supports at their end, through the public interface, from their
configurations alone.
"""

from pathlib import Path

import numpy as np
import pytest

from vibroimpact.config.reading import load_config
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.study.cases import all_cases
from vibroimpact.study.simulation import simulate_cases
from vibroimpact.validation.variant import changed

FOLDER = Path(__file__).resolve().parents[2] / "config" / "reference"
# Displacement of the tip in mm at 1, 2, ... 12 ms, by stiffness in N/m (SDNL32, three digits).
LAUNCHED_MM = {
    18000.0: (-2.66, -4.33, -4.92, -4.78, -3.82, -2.87, -2.71, -3.09, -3.41, -3.36, -2.64, -0.742),
    45000.0: (-2.25, -2.66, -1.96, -1.15, -0.124, -0.364, -2.01, -2.74, -1.89, -0.352, 1.70, 4.99),
}


def run(name, **changes):
    """The model and the record of a reference configuration with dotted keys changed."""
    keys = {key.replace("__", "."): value for key, value in changes.items()}
    config = changed(load_config(FOLDER / f"{name}.yaml"), keys)
    model = build_model(config, motion_only=True)
    ((_, record),) = simulate_cases(config, model, all_cases(config.grid))
    return model, record


@pytest.mark.parametrize("stiffness", LAUNCHED_MM)
def test_a_beam_launched_on_a_tip_spring(stiffness):
    """R7, to 1 % of the largest displacement."""
    model, record = run("r7_beam_launched", supports__stiffness_N_per_m=stiffness)
    assert np.sum(np.any(model.contact_shapes[:, :, 0], axis=1)) == 10  # modes in the plane
    tip = np.interp(
        1.0e-3 * np.arange(1, 13),
        record["step_time"].values,
        record["contact_displacement"].values[0, 0],
    )
    expected = 1.0e-3 * np.array(LAUNCHED_MM[stiffness])
    assert tip == pytest.approx(expected, rel=0.0, abs=0.01 * np.abs(expected).max())


def tip_force_rms(record):
    """RMS in N of the force of the last support, 0.17 to 0.25 s."""
    window = record["step_time"].values >= 0.17
    return np.sqrt(np.mean(record["contact_force"].values[3, 0, window] ** 2))


def test_a_cantilever_on_four_gaps_with_all_its_flexibility():
    """R8 with 29 shapes in the plane, 24 of them modes below 3 kHz and residual shapes at the
    supports: 22.85 N of another integration with all 96 modes, 23.98 N as published.
    """
    model, record = run("r8_cantilever_gaps")
    assert np.sum(np.any(model.contact_shapes[:, :, 0], axis=1)) == 29
    assert tip_force_rms(record) == pytest.approx(22.85, rel=2e-3)
    assert tip_force_rms(record) == pytest.approx(23.98, rel=0.05)


def test_a_cantilever_on_four_gaps_with_few_modes():
    """R8 with 24 modes and no residual shapes: 23 to 25 N of others with 12 to 40 modes."""
    model, record = run(
        "r8_cantilever_gaps",
        basis__free_modes_to_Hz=4000.0,
        basis__attachment_shapes=False,
        basis__constrained_modes_to_Hz=1.0,
    )
    assert np.sum(np.any(model.contact_shapes[:, :, 0], axis=1)) == 24
    assert 23.0 < tip_force_rms(record) < 25.0
