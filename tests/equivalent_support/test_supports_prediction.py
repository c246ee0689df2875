"""Prediction by linear supports: equal to that of one support, and to a dense slow twin."""

import numpy as np
import pytest
import xarray as xr

from evidence.validation.prediction.responses import linear_response
from tests.physics.test_identification_of_supports import structure
from vibroimpact.equivalent_support.supports_prediction import (
    EACH,
    ONE,
    SECANT,
    linear_supports,
    one_for_all,
    supports_prediction_rows,
    supports_response,
)

BAND, LOAD = (2.0, 60.0), 3.0
TRUTH = {"plate_1": (2.0e5, 60.0), "plate_2": (3.0e4, 20.0), "plate_3": (0.0, 0.0)}


@pytest.fixture(scope="module")
def tube():
    """(configuration, model) of the straight tube through three plates."""
    return structure(excitation={"band_Hz": list(BAND)}, identification={"broadband": BROADBAND})


BROADBAND = {"point": "span_2", "band_Hz": [4.0, 50.0]}


def table(values, direction="y"):
    """Rows of equivalent.csv with {group: (k, c)}, 0 as not resolved."""
    case = {"gap_m": 3.0e-4, "load_rms_N": LOAD, "direction": direction}
    return [
        case
        | {"group": group, "k_N_per_m": k or np.nan, "c_N_s_per_m": c or np.nan}
        | {"secant_k_N_per_m": 0.5 * k, "secant_c_N_s_per_m": c}
        for group, (k, c) in values.items()
    ]


def dense_psd(model, values, frequency, shapes):
    """(output, frequency) PSD of a structure on supports {name: (k, c)} along y, by full solves."""
    stiffness, damping = np.diag(model.omega**2), np.diag(model.damping)
    for name, (k, c) in values.items():
        at = model.support_of_point == model.support_names.index(name)
        shape = model.contact_shapes[:, at, 1] * np.sqrt(model.contact_weight[at])
        stiffness, damping = stiffness + k * shape @ shape.T, damping + c * shape @ shape.T
    psd = []
    for omega in 2.0 * np.pi * frequency:
        dynamic = stiffness + 1j * omega * damping - omega**2 * np.eye(model.modes)
        psd.append(np.abs(shapes.T @ np.linalg.solve(dynamic, model.drive_shapes[:, 0])) ** 2)
    return np.array(psd).T * LOAD**2 / (BAND[1] - BAND[0])


def records(model, step_Hz=0.05):
    """(record, spectra) of the linear structure on the supports TRUTH, by full solves."""
    frequency = np.arange(0.0, 80.0, step_Hz)
    inside = (frequency >= BAND[0]) & (frequency < BAND[1])
    stress = model.stress_shapes.reshape(model.modes, -1)
    power = np.zeros((len(model.sensor_names) + stress.shape[1], frequency.size))
    shapes = np.hstack([model.sensor_shapes, stress])
    power[:, inside] = dense_psd(model, TRUTH, frequency[inside], shapes)
    sensors = len(model.sensor_names)
    variance = power[sensors:].reshape(-1, 2, frequency.size).sum(axis=(1, 2)) * step_Hz
    record = xr.Dataset(
        {"stress_rms": ("section", np.sqrt(variance))},
        {"section": list(model.section_names)},
        {"gap_m": 3.0e-4, "load_rms_N": LOAD},
    )
    spectra = xr.Dataset(
        {"psd_displacement_mean": (("sensor", "frequency"), power[:sensors])},
        {"frequency": frequency},
    )
    return record, spectra


def test_equal_supports_respond_as_one_support_for_all(study_model):
    k, c, band = 1.0e5, 300.0, (5.0, 40.0)
    rows = table({"left": (k, c), "right": (k, c)})
    supports = linear_supports(study_model, "each", rows)
    own = supports_response(study_model, "each", supports, LOAD, band)
    one = linear_response(study_model, k, c, LOAD, band, 49.0)
    for name in ("psd", "rms_stress"):
        ours, theirs = getattr(own, name), getattr(one, name)
        moved = [place for place, value in theirs.items() if np.all(value > 0.0)]
        assert moved and ours.keys() == theirs.keys()
        ours, theirs = (np.array([values[place] for place in moved]) for values in (ours, theirs))
        assert ours == pytest.approx(theirs, rel=1e-6)


def test_unequal_supports_are_predicted_by_their_own_values(tube):
    config, model = tube
    record, spectra = records(model)
    equivalent = {EACH: table(TRUTH), ONE: table({"all": (1.0e5, 30.0)})}
    rows = supports_prediction_rows(config, model, equivalent, [record], [spectra])
    error = {
        name: np.abs([row["error_dB"] for row in rows if row["supports"] == name])
        for name in (EACH, ONE, SECANT)
    }
    # The sums over 0.01 and 0.05 Hz and the edges of the bands differ.
    assert len(error[EACH]) == 4 * 4 + 3 and error[EACH].max() < 0.1
    assert error[ONE].max() > 3.0 and error[SECANT].max() > 0.5
    stress = [row for row in rows if row["quantity"] == "RMS bending stress"]
    assert [row["of"] for row in stress[:3]] == ["plate_1", "plate_2", "plate_3"]


def test_a_support_that_is_not_resolved_is_left_out(tube):
    _, model = tube
    k, c = linear_supports(model, "each", table(TRUTH))
    assert k.tolist() == [2.0e5, 3.0e4, 0.0] and c.tolist() == [60.0, 20.0, 0.0]


def test_prediction_refuses_other_forces_and_groups(tube):
    config, model = tube
    with pytest.raises(ValueError, match="groups must be all"):
        one_for_all(config, model, [], [])
    force = config.excitation.model_copy(update={"kind": "white_noise"})
    noise = config.model_copy(update={"excitation": force})
    with pytest.raises(ValueError, match="band_limited, not white_noise"):
        supports_prediction_rows(noise, model, {}, [], [])
