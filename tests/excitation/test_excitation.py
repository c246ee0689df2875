"""Forces: band, RMS, Gaussian amplitude, independence of seeds; measured records come back at
another rate.
"""

import tracemalloc
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from scipy.io import savemat

from vibroimpact.excitation.force_files import (
    ForceFileError,
    MeasuredForce,
    read_force,
    require_lasting,
)
from vibroimpact.excitation.force_stream import ForceStream
from vibroimpact.excitation.random_force import ForceError, band_limited_noise, resample_measured
from vibroimpact.excitation.random_streams import random_generator

BAND = (5.0, 200.0)


def test_noise_stays_in_its_band_and_is_flat():
    rate = 2048.0
    values = band_limited_noise(np.random.default_rng(1), 2**16, rate, BAND)
    frequency = np.fft.rfftfreq(values.size, 1 / rate)
    power = np.abs(np.fft.rfft(values)) ** 2
    inside = (frequency > 5.5) & (frequency < 199.5)
    assert power[(frequency < 4.5) | (frequency > 200.5)].max() < 1e-12 * power[inside].mean()
    blocks = np.array([part.mean() for part in np.array_split(power[inside], 20)])
    assert np.all(np.abs(blocks / blocks.mean() - 1) < 6 / np.sqrt(inside.sum() / 20))


def test_noise_is_gaussian_with_unit_rms():
    values = band_limited_noise(np.random.default_rng(2), 2**18, 2048.0, BAND)
    assert values.std() == pytest.approx(1.0, abs=0.02)
    assert np.mean(values**4) / np.mean(values**2) ** 2 == pytest.approx(3.0, abs=0.1)


def test_seeds_are_independent_and_reproducible():
    one, other, again = (
        band_limited_noise(random_generator(2012, seed, "force"), 2**17, 2048.0, BAND)
        for seed in (0, 1, 0)
    )
    assert np.array_equal(one, again)
    assert abs(np.corrcoef(one, other)[0, 1]) < 5 / np.sqrt(2 * 195 * 64)


def test_rms_over_the_record_is_exact():
    section = SimpleNamespace(kind="band_limited", band_Hz=BAND)
    stream = ForceStream(section, np.random.default_rng(3), 60000, 51200.0, slice(10000, 50000))
    values = stream.values(0, 60000)
    assert np.sqrt(np.mean(values[10000:50000] ** 2)) == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize(
    ("samples", "rate", "band"),
    [(400_000, 51200.0, BAND), (60_007, 51200.0, (100.0, 3000.0)), (5000, 1000.0, (5.0, 400.0))],
)
def test_a_streamed_force_is_the_inverse_transform_of_its_lines(samples, rate, band):
    section, recorded = SimpleNamespace(kind="band_limited", band_Hz=band), slice(100, samples - 2)
    values = band_limited_noise(np.random.default_rng(8), samples, rate, band)
    expected = values / np.sqrt(np.mean(values[recorded] ** 2))
    stream = ForceStream(section, np.random.default_rng(8), samples, rate, recorded)
    assert np.max(np.abs(stream.values(0, samples) - expected)) < 1e-12


@pytest.mark.parametrize(
    "section",
    [
        SimpleNamespace(kind="band_limited", band_Hz=BAND),
        SimpleNamespace(kind="white_noise"),
        SimpleNamespace(kind="none"),
        SimpleNamespace(kind="harmonic", frequency_Hz=7.3, phase_deg=20.0),
    ],
    ids=lambda section: section.kind,
)
def test_force_does_not_depend_on_the_requested_range(section):
    def stream():
        return ForceStream(
            section,
            np.random.default_rng(9),
            90_000,
            51200.0,
            slice(1000, 80_000),
            first_time_s=-0.5,
        )

    whole = stream().values(0, 90_000)
    pieces = stream()
    for first, count in [
        (0, 1),
        (0, 7001),
        (7000, 30_000),
        (37_000, 53_000),
        (25_599, 2),
        (88_000, 2000),
        (100, 10),
    ]:
        assert np.array_equal(pieces.values(first, count), whole[first : first + count])


def test_a_force_of_a_long_record_takes_little_memory():
    """Of 400 s, 160 MB as a whole, the Fourier lines and one block are held."""
    tracemalloc.start()
    stream = ForceStream(
        SimpleNamespace(kind="band_limited", band_Hz=BAND),
        np.random.default_rng(11),
        400 * 51200,
        51200.0,
        slice(0, 51200),
    )
    stream.values(0, 25000)
    assert tracemalloc.get_traced_memory()[1] < 40e6
    tracemalloc.stop()


def test_empty_band_is_refused():
    with pytest.raises(ForceError, match="5.2-5.3 Hz holds no line"):
        band_limited_noise(np.random.default_rng(0), 1000, 1000.0, (5.2, 5.3))


@pytest.mark.parametrize(
    ("rate", "to_rate"), [(2048.0, 51200.0), (400.0, 51200.0), (1000.0, 51200.0)]
)
def test_resampling_keeps_a_band_limited_wave(rate, to_rate):
    def wave(t):
        return np.cos(2 * np.pi * 17.3 * t) + 0.5 * np.sin(2 * np.pi * 71.0 * t + 0.3)

    got = resample_measured(wave(np.arange(round(4 * rate)) / rate), rate, to_rate)
    expected = wave(np.arange(got.size) / to_rate)
    assert got.size == round(4 * to_rate)
    inner = slice(round(0.2 * to_rate), round(3.8 * to_rate))
    assert np.max(np.abs(got[inner] - expected[inner])) < 2e-3


def measured_files(folder, values, rate):
    """The same record as netCDF, CSV and MATLAB file."""
    time = np.arange(values.size) / rate
    xr.Dataset({"force": ("time", values)}, {"time": time}).to_netcdf(folder / "force.nc")
    np.savetxt(
        folder / "force.csv",
        np.column_stack([time, values]),
        delimiter=",",
        header="time,force",
        comments="",
        fmt="%.17g",
    )
    savemat(folder / "force.mat", {"force": values[None, :], "Fs": rate})
    return [folder / f"force.{kind}" for kind in ("nc", "csv", "mat")]


def test_the_three_kinds_of_file_hold_the_same_record(tmp_path):
    values = np.random.default_rng(4).standard_normal(500)
    for path in measured_files(tmp_path, values, 400.0):
        read = read_force(path, "force", None)
        assert np.array_equal(read.values, values)
        assert read.rate == 400.0


def test_a_measured_force_drives_a_case(tmp_path):
    values = np.random.default_rng(5).standard_normal(4000)
    path = measured_files(tmp_path, values, 400.0)[0]
    section = SimpleNamespace(
        kind="measured", file=str(path), variable="force", sampling_frequency_Hz=None
    )
    stream = ForceStream(section, None, 5 * 51200, 51200.0, slice(51200, 4 * 51200))
    force = stream.values(0, 5 * 51200)
    assert np.sqrt(np.mean(force[51200 : 4 * 51200] ** 2)) == pytest.approx(1.0, rel=1e-14)
    assert np.corrcoef(force[::128], values[:2000])[0, 1] > 0.999
    with pytest.raises(
        ForceFileError, match="lasts 10.000 s, but start-up and record need 12.000 s"
    ):
        ForceStream(section, None, 12 * 51200, 51200.0, slice(0, 51200))


def timed_forces(folder, unit, per_second, stated=None):
    """Files of 10 s of a force at 400 Hz, whose times are in a unit; stated: attribute in Hz."""
    values = np.random.default_rng(6).standard_normal(4000)
    time = np.arange(4000) / 400.0 * per_second
    table, netcdf = folder / "force.csv", folder / "force.nc"
    header = f"time [{unit}],force" if unit else "time,force"
    np.savetxt(table, np.column_stack([time, values]), delimiter=",", header=header, comments="")
    units = {"units": unit} if unit else {}
    rate = {"sampling_frequency": stated} if stated else {}
    force = xr.Dataset({"force": ("time", values, rate)}, {"time": ("time", time, units)})
    force.assign_attrs(rate).to_netcdf(netcdf, engine="netcdf4")
    return table, netcdf


@pytest.mark.parametrize(("unit", "per_second"), [("s", 1.0), ("ms", 1e3), ("us", 1e6)])
def test_the_unit_of_the_times_of_a_force_counts(tmp_path, unit, per_second):
    for path in timed_forces(tmp_path, unit, per_second):
        read = read_force(path, "force", None)
        assert read.rate == 400.0
        assert read.described() == "10 s at 400 Hz"


def test_an_unknown_unit_of_time_is_refused(tmp_path):
    for path in timed_forces(tmp_path, "kg", 1.0):
        with pytest.raises(ForceFileError, match="has the unit 'kg', which is no time"):
            read_force(path, "force", None)


def test_times_that_contradict_the_stated_rate_are_refused(tmp_path):
    path = timed_forces(tmp_path, "s", 1.0, stated=200.0)[1]
    with pytest.raises(ForceFileError, match="frequency is 200 Hz, but the steps of time say 400"):
        read_force(path, "force", None)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"rate": 0.4}, "are its times in ms"),
        ({"stop": 3000}, "lasts 7.500 s, but start-up and record need 8.000 s"),
        ({"still_from": 500}, "the force ends within the start-up of 2 s"),
    ],
)
def test_a_force_that_is_none_of_a_case_is_refused(change, said):
    values = np.random.default_rng(7).standard_normal(4000)
    values[change.get("still_from", 4000) :] *= 1e-6
    force = MeasuredForce(values[: change.get("stop", 4000)], change.get("rate", 400.0))
    require_lasting("f.csv", MeasuredForce(values + 1.0, 400.0), 51200.0, 2.0, 8.0)
    with pytest.raises(ForceFileError, match=said):
        require_lasting("f.csv", force, 51200.0, 2.0, 8.0)


def test_errors_in_a_force_file_are_reported(tmp_path):
    values = np.ones(100)
    netcdf, table, _ = measured_files(tmp_path, values, 400.0)
    with pytest.raises(ForceFileError, match="no variable 'Force': it has force"):
        read_force(netcdf, "Force", None)
    with pytest.raises(
        ForceFileError, match="sampled at 400 Hz, but excitation.sampling_frequency_Hz = 500"
    ):
        read_force(netcdf, "force", 500.0)
    with pytest.raises(ForceFileError, match="no such file"):
        read_force(tmp_path / "none.nc", "force", None)
    with pytest.raises(ForceFileError, match="unknown kind '.txt'"):
        read_force(tmp_path / "force.txt", "force", None)
    values[7] = np.nan
    table.write_text("force\n" + "\n".join(map(str, values)))
    with pytest.raises(ForceFileError, match=r"force\[7\] is not finite"):
        read_force(table, "force", 400.0)
    table.write_text("force\n" + "\n".join(["1.0"] * 10))
    with pytest.raises(ForceFileError, match="says no sampling frequency"):
        read_force(table, "force", None)
