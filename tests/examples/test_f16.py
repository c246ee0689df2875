"""The aircraft's records: a file with a known pole, and the benchmark's published behaviour where
the data are at hand.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from examples.f16.poles import pole_table, read_response, stable_column
from tests.identify.test_lscf import chart, pole_of

RECORDS = Path(__file__).resolve().parents[3] / "shared/data/f16_ground_vibration"


def write_level(folder, level, frequency=7.3, ratio=0.008, noise=0.0):
    """A file like the benchmark's: 9 periods of a multisine, three channels with two modes; the
    first period is a transient.
    """
    generator = np.random.default_rng(level)
    place = np.fft.rfftfreq(8192, 1.0 / 400.0)
    excited = (place >= 2.0) & (place <= 15.0)
    force = np.where(excited, np.exp(2j * np.pi * generator.uniform(size=place.size)), 0.0) * 3000.0
    omega = 2.0 * np.pi * place
    modes = [(frequency, ratio, (1.0, 2.0, 1.9)), (11.0, 0.01, (0.6, -0.3, 0.2))]
    response = np.zeros((3, place.size), complex)
    for mode, damping, shape in modes:
        pole = 2.0 * np.pi * mode
        response += (
            np.outer(shape, -(omega**2) / (pole**2 - omega**2 + 2j * damping * pole * omega)) * 0.01
        )
    signals = np.fft.irfft(response * force, 8192)
    acceleration = np.tile(signals, (1, 9)) + noise * generator.standard_normal((3, 9 * 8192))
    acceleration[:, :8192] += 50.0 * np.exp(-np.arange(8192) / 400.0)
    path = folder / f"F16Data_FullMSine_Level{level}.mat"
    savemat(
        path,
        {
            "Force": np.tile(np.fft.irfft(force, 8192), 9)[None],
            "Acceleration": acceleration,
            "Fs": 400.0,
        },
    )
    return path


def test_a_known_pole_and_shape_come_back(tmp_path):
    rows = pole_table(
        [write_level(tmp_path, 3), write_level(tmp_path, 1, frequency=7.35, ratio=0.006)]
    )
    assert [(row["level"], row["method"]) for row in rows] == [
        (level, method)
        for level in (1, 3)
        for method in ("peak_half", "peak_quarter", "peak_25th", "lscf", "ods")
    ]
    for row in rows:
        if row["method"] != "ods":
            assert row["frequency_Hz"] == pytest.approx(
                7.3 if row["level"] == 3 else 7.35, rel=1.0e-3
            )
            assert row["damping_ratio"] == pytest.approx(
                0.008 if row["level"] == 3 else 0.006, rel=0.05
            )
            assert row["quality"] == "ok"
        assert (row["shape_2_re"], row["shape_3_re"]) == pytest.approx((2.0, 1.9), rel=0.02)
    exact = [row for row in rows if row["method"] == "lscf"]
    assert exact[0]["frequency_Hz"] == pytest.approx(7.35, rel=1.0e-6) and exact[0][
        "damping_ratio"
    ] == pytest.approx(0.006, rel=1.0e-4)


def test_the_longest_stable_column_is_found():
    lone = chart(
        (2, [(7.4, 0.03, True)]),
        (3, [(7.3, 0.01, False)]),
        (4, [(7.32, 0.005, True)]),
        (5, [(7.31, 0.005, True)]),
        (6, [(9.0, 0.01, True)]),
        (7, [(7.2, 0.02, True)]),
    )
    np.testing.assert_allclose(
        stable_column(lone, pole_of(7.3, 0.001), 0.3), [pole_of(7.32, 0.005), pole_of(7.31, 0.005)]
    )
    assert stable_column(lone, pole_of(3.0, 0.001), 0.3).size == 0


def test_the_transient_period_is_left_out_and_the_rest_averaged(tmp_path):
    response = read_response(write_level(tmp_path, 5))
    assert response.level == 5 and response.load_rms_N == pytest.approx(
        np.sqrt(0.5 * 267) * 2.0 * 3000.0 / 8192.0
    )
    assert response.frequency[1] == pytest.approx(400.0 / 8192.0) and np.all(
        response.per_force[:, response.frequency > 15.0] == 0.0
    )
    line = np.argmin(np.abs(response.frequency - 7.3))
    omega, poles = response.frequency[line], np.array([7.3, 11.0])
    modes = -(omega**2) / (poles**2 - omega**2 + 2j * np.array([0.008, 0.01]) * poles * omega)
    assert response.per_force[2, line] == pytest.approx(0.01 * modes @ (1.9, 0.2), rel=1.0e-9)


def test_foreign_file_is_named(tmp_path):
    path = tmp_path / "Level2.mat"
    savemat(path, {"Force": np.ones((1, 5000)), "Acceleration": np.ones((3, 5000)), "Fs": 400.0})
    with pytest.raises(ValueError, match="no whole number of periods"):
        read_response(path)
    with pytest.raises(ValueError, match="must hold the level"):
        read_response(path.rename(tmp_path / "other.mat"))


def test_the_measured_mode_softens_and_its_response_falls():
    files = sorted(RECORDS.glob("F16Data_FullMSine_Level*.mat"))
    if not files:
        pytest.skip(f"no F-16 records in {RECORDS}: download them from nonlinearbenchmark.org")
    rows = pole_table(files)
    first, last = (next(row for row in rows if row["level"] == level) for level in (1, 7))
    assert (first["peak_line_Hz"], last["peak_line_Hz"]) == pytest.approx((7.324, 7.227), abs=0.001)
    by_level = {row["level"]: row["channel_3_per_force"] for row in rows}
    assert [by_level[level] for level in (1, 3, 5, 7)] == pytest.approx(
        [0.258, 0.233, 0.097, 0.075], abs=0.0005
    )
    for method in ("peak_half", "peak_quarter", "lscf"):
        poles = {row["level"]: row for row in rows if row["method"] == method}
        assert (
            poles[1]["frequency_Hz"] == pytest.approx(7.32, abs=0.01)
            and 7.14 < poles[7]["frequency_Hz"] < 7.24
        )
        ratios = [poles[level]["damping_ratio"] for level in (1, 3, 5, 7)]
        assert (
            ratios == pytest.approx(np.maximum.accumulate(ratios), rel=0.05)
            and ratios[3] > 2.5 * ratios[0]
        )
        assert all(poles[level]["quality"] == "ok" for level in poles)
