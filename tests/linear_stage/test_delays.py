"""Delays from the phases of modes, with the errors that these have."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.linear_stage.lags import lags

FREQUENCY = np.array([20.0, 55.0, 110.0, 180.0])


def found(lag, errors, phases=(0.0, 0.0, 0.0, 0.0)):
    """Return ((s,), (s,)) of a channel that shows four modes, `lag` s late, with phases that are
    known to errors (mode,) and off by phases (mode,), in rad.
    """
    shape = np.exp(1j * (np.array(phases) - 2.0 * np.pi * FREQUENCY * lag))
    fit = SimpleNamespace(
        modes=np.arange(4),
        log_frequency=np.zeros(4),
        participation=shape[None],
        shape_covariance=np.diag(np.array(errors) ** 2)[None],
        share=np.array([0.05]),
    )
    ones = np.ones((4, 1))
    model = SimpleNamespace(frequencies=FREQUENCY, sensor_shapes=ones, drive_shapes=ones)
    return lags(fit, model)


@pytest.mark.parametrize("lag", [-3.0e-3, 5.0e-5, 4.1e-3])
def test_delay_is_known_to_its_error(lag):
    told, error = found(lag, [0.01] * 4)
    assert told[0] == pytest.approx(lag, abs=1.0e-9)
    # four phases, each known to hypot(0.01, 0.02) rad: least squares through the origin
    sd = np.hypot(0.01, 0.02) / (2.0 * np.pi * np.linalg.norm(FREQUENCY))
    assert error[0] == pytest.approx(sd)


def test_phase_that_is_hardly_known_makes_no_channel_late():
    """Of two close modes the split is hardly known, and so are their phases."""
    told, error = found(0.0, [0.01, 0.01, 0.01, 0.6], phases=(0.0, 0.0, 0.0, -0.5))
    assert abs(told[0]) < 2.0 * error[0]
