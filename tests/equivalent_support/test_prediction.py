"""The equivalent linear model's prediction: exact where the tube is linear, and the pieces that
make the table.
"""

import numpy as np
import pytest

from evidence.validation.prediction.laws import fit_law, free_level, plate_stiffness
from evidence.validation.prediction.responses import (
    amplified,
    expected_peak_factor,
    linear_response,
    prediction_rows,
    summary_rows,
    synthesise_records,
)
from vibroimpact.identify.linear.responses import frf

BAND = (5.0, 200.0)


def test_a_linear_tube_is_predicted_by_its_own_support(study_model):
    """RMS displacement and stress of a synthesised record of the linear tube with (k, c), within
    what 49 s tell.
    """
    k, c, load, rate = 1e5, 300.0, 3.0, 2048.0
    generator = np.random.default_rng(2)
    lines = np.zeros(int(98 * rate) // 2 + 1, complex)
    inside = slice(int(BAND[0] * 98), int(BAND[1] * 98))
    lines[inside] = np.array([1.0, 1j]) @ generator.standard_normal((2, lines[inside].size))
    force = np.fft.irfft(lines, int(98 * rate))
    force *= load / force.std()
    expected = linear_response(study_model, k, c, load, BAND, 98.0)
    records = synthesise_records(study_model, k, c, force, rate)
    for name, record in zip(study_model.sensor_names, records, strict=True):
        if name.endswith(".y"):
            assert record.std() == pytest.approx(expected.rms_displacement[name], rel=0.12)
    shapes = study_model.stress_shapes.reshape(study_model.modes, -1)
    stress = synthesise_records(study_model, k, c, force, rate, output_shapes=shapes)
    stress = stress.reshape(study_model.stress_shapes.shape[1], 2, -1)
    rms = np.sqrt((stress**2).sum(axis=1).mean(axis=-1))
    peak = np.sqrt((stress**2).sum(axis=1)).max(axis=-1)
    assert rms == pytest.approx(list(expected.rms_stress.values()), rel=0.12)
    assert peak == pytest.approx(list(expected.peak_stress.values()), rel=0.25)


def test_plate_force_of_a_stiff_and_of_an_absent_support(study_model):
    soft, stiff = (linear_response(study_model, k, 0.0, 1.0, BAND, 49.0) for k in (1.0, 4e6))
    assert max(soft.rms_force.values()) < 1e-3 < min(stiff.rms_force.values())


def test_expected_peak_of_gaussian_noise():
    generator = np.random.default_rng(4)
    records = generator.standard_normal((300, 4096))
    kernel = np.hanning(9)
    smooth = np.apply_along_axis(lambda row: np.convolve(row, kernel, "valid"), 1, records)
    smooth /= smooth.std()
    crossings = np.mean(np.sum((smooth[:, 1:] > 0) & (smooth[:, :-1] <= 0), axis=1))
    assert smooth.max(axis=1).mean() == pytest.approx(expected_peak_factor(crossings), rel=0.03)


def summary(power=1.5):
    """Rows of a consistency summary that follow k = (load/gap)^power exactly."""
    return [
        {"method": method, "gap_m": gap, "load_rms_N": load}
        | {"k_median": (load / gap) ** power, "c_median": 0.01 * load / gap}
        for gap in (1e-4, 3e-4)
        for load in np.geomspace(1.0, 20.0, 8)
        for method in ("lscf", "ods", "broadband", "peak_half")
    ]


def test_equivalent_law_interpolates_and_extrapolates():
    law = fit_law(summary(), lambda load, gap: load / gap)
    for level in np.geomspace(law.level[0], law.level[-1], 7):
        k, c = law.at(level)
        assert k == pytest.approx(level**1.5, rel=0.01)
        assert c == pytest.approx(0.01 * level, rel=0.05) and law.inside(level)
    assert law.at(1.0) == (0.0, 0.0)
    beyond = 3.0 * law.level[-1]
    assert law.at(beyond)[0] == pytest.approx(beyond**1.5, rel=0.05) and not law.inside(beyond)


def test_a_load_left_out_is_not_fitted():
    rows = summary()
    left = rows[4 * 3]["load_rms_N"]
    spoiled = [{**row, "k_median": 1e-30} if row["load_rms_N"] == left else row for row in rows]
    kept = fit_law(rows, lambda load, gap: load / gap, without_load=left)
    without = fit_law(spoiled, lambda load, gap: load / gap, without_load=left)
    assert np.array_equal(kept.k, without.k)


def test_the_level_of_a_tube_is_its_free_motion_over_the_gap(study_model):
    frequency = np.arange(*BAND, 0.02)
    middle = study_model.contact_shapes[:, 2:3, 1]
    moved = np.sqrt(np.mean(np.abs(frf(study_model, 1.0, 0.0, frequency, middle)) ** 2))
    assert free_level(study_model, BAND) == pytest.approx(moved, rel=0.02)
    static, _ = plate_stiffness(study_model)
    assert 1e4 < static < 1e6  # between the tube's softest mode and the contact


def test_rows_and_verdicts(study_model):
    linear = linear_response(study_model, 1e5, 300.0, 3.0, BAND, 49.0)
    labels = {"geometry": "g", "law": "l"}
    seeds = [amplified(linear, gain) for gain in (1.0, 1.02)]
    seeds = [type(linear)(**{**vars(seed), "contact": 0.2}) for seed in seeds]
    rows = prediction_rows(labels, linear, seeds, ["apex.y"])
    assert {row["regime"] for row in rows} == {"transition"} and all(row["usable"] for row in rows)
    assert all(-0.2 < row["error_dB"] < 0.0 for row in rows)
    assert {row["may_be_used"] for row in summary_rows(rows)} == {"yes"}
    doubled = prediction_rows(labels, amplified(linear, 2.0), seeds, ["apex.y"])
    assert all(row["error_dB"] == pytest.approx(6.02 - 0.087, abs=0.01) for row in doubled)
    assert {row["may_be_used"] for row in summary_rows(doubled)} == {"no"}
    assert {row["may_be_used"] for row in summary_rows(rows + rows + doubled)} == {"with care"}
