"""Turbulence on a tube: joint acceptances in closed form, the limits of long and short correlation,
simulated spectra against the linear response, independent directions.
"""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lsim

from evidence.validation.reference.frequencies import straight_tube
from tests.support.straight_path import straight_path
from vibroimpact.config.reading import check_config
from vibroimpact.excitation.correlated_field import POINTS, field_covariance
from vibroimpact.excitation.force_stream import ForceStream, force_channels
from vibroimpact.excitation.force_vectors import line_load
from vibroimpact.excitation.line_force_spectrum import line_force_psd, line_force_rms
from vibroimpact.excitation.turbulence import drive_shapes, load_of_spectrum
from vibroimpact.identify.linear.responses import frf
from vibroimpact.identify.spectra.welch import psd_statistics, segment_spectra
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.reduction.ritz_basis import eigenmodes, uncoupled_groups
from vibroimpact.study.cases import Case
from vibroimpact.study.simulation import simulate_cases

LENGTH, DIAMETER, WALL, DENSITY = 2.0, 0.02, 0.001, 8000.0
MASS_PER_LENGTH = np.pi * (DIAMETER - WALL) * WALL * DENSITY
GAP = 9.0e-3  # never closed


def beam(excitation, **parts):
    """A pinned straight tube along z under turbulence, and one support that it never reaches."""
    return check_config(
        {
            "study": "beam",
            "seed": 5,
            "structure": straight_path(
                LENGTH,
                [0.0, 0.0, 1.0],
                {"outer_diameter_m": DIAMETER, "wall_thickness_m": WALL},
                (2.0e11, 0.3, DENSITY),
                ends=("pinned", "pinned"),
                theory="euler_bernoulli",
                mesh={"elements_per_span": 40},
            ),
            "damping": {"kind": "modal", "first_ratios": [], "other_ratio": 0.03},
            "supports": [
                {
                    "name": "far",
                    "at_m": [0.0, 0.0, 0.5],
                    "height_m": 0.02,
                    "points": 1,
                    "stiffness_N_per_m": 1.0e4,
                }
            ],
            "points": {"middle": [0.0, 0.0, 0.5 * LENGTH], "side": [0.0, 0.0, 0.3 * LENGTH]},
            "excitation": {
                "kind": "turbulence",
                "direction": [1.0, 0.0, 0.3],
                "correlation_length_m": 0.1,
                "band_Hz": [5.0, 200.0],
                "spectrum": {"kind": "flat"},
            }
            | excitation,
            "basis": {"free_modes_to_Hz": 1500.0},
            "integration": {"steps_per_second": 10240, "start_up_s": 2.0},
            "grid": {"load_rms_N": [1.0], "gap_m": [GAP], "seeds": 1},
            "record": {
                "duration_s": 20.0,
                "sampling_frequency_Hz": 1024,
                "sensors": {"points": ["middle", "side"], "directions": ["x", "y"]},
                "shape_line": {"points": 3, "direction": "x"},
            },
            "spectra": {"segment_s": 4.0, "overlap": 0.5, "window": "hann"},
        }
        | parts,
        "beam",
    )


def acceptance(n, ratio):
    """Double integral over 0..1 of sin(n pi x) sin(n pi y) exp(-ratio |x - y|)."""
    b = n * np.pi
    return (
        ratio / (ratio**2 + b**2)
        + 2.0 * b**2 * (1.0 - (-1.0) ** n * np.exp(-ratio)) / (ratio**2 + b**2) ** 2
    )


def square_of_sum(ratio):
    """Double integral over 0..1 of exp(-ratio |x - y|)."""
    return 2.0 / ratio - 2.0 * (1.0 - np.exp(-ratio)) / ratio**2


def sine_modes(count):
    """Mass-normalised modes of a pinned beam as a structure, and the force's directions along x."""
    tube = straight_tube("pinned-pinned", 40, LENGTH)
    groups = uncoupled_groups(tube.mass, tube.stiffness, np.zeros((0, tube.dofs)))
    along_x = next(group for group in groups if np.any(tube.displacement_rows(0.9)[0][group.dofs]))
    omega, inside = eigenmodes(along_x.stiffness, along_x.mass, 3000.0)
    shapes = np.zeros((tube.dofs, count))
    shapes[along_x.dofs] = inside[:, :count]
    mass = np.pi * (0.02222 - 0.00127) * 0.00127 * 8330.0
    return tube, shapes, omega[:count], mass


def turbulence(correlation_length, **keys):
    """The section of a turbulent force along x."""
    return SimpleNamespace(
        **{
            "direction": (1.0, 0.0, 0.0),
            "both_directions": False,
            "stretches": (),
            "correlation_length_m": correlation_length,
            "band_Hz": (5.0, 1.0e4),
            "spectrum": SimpleNamespace(kind="flat"),
            "tolerance": 1.0e-9,
        }
        | keys
    )


@pytest.mark.parametrize("correlation_length", [1.0e-4, 0.02, 0.3, 5.0])
def test_modes_of_a_beam_have_their_joint_acceptance(correlation_length):
    """Powell 1958: force of mode n, variance (2 / m L) times the acceptance of sin(n pi x / L)."""
    tube, shapes, omega, mass = sine_modes(6)
    driven = drive_shapes(tube, shapes, omega, turbulence(correlation_length))
    ratio = LENGTH / correlation_length
    expected = [
        2.0 / (mass * LENGTH) * acceptance(n, ratio) / square_of_sum(ratio) for n in range(1, 7)
    ]
    np.testing.assert_allclose((driven**2).sum(axis=1), expected, rtol=2e-4)


def test_short_correlation_drives_modes_apart_and_equally():
    """White in space: (2 lambda / L) x the mean square of each shape, no covariance."""
    tube, shapes, omega, mass = sine_modes(6)
    driven = drive_shapes(tube, shapes, omega, turbulence(1.0e-6))
    np.testing.assert_allclose(
        driven @ driven.T, np.eye(6) / (mass * LENGTH), atol=1e-5 / (mass * LENGTH)
    )


def test_long_correlation_is_one_uniform_line_load():
    tube, shapes, omega, _ = sine_modes(6)
    driven = drive_shapes(tube, shapes, omega, turbulence(1.0e10, tolerance=0.01))
    load = SimpleNamespace(
        from_m=(0.0, 0.0, 0.0), to_m=(0.0, 0.0, LENGTH), direction=(1.0, 0.0, 0.0)
    )
    uniform = line_load(tube, load) @ shapes / LENGTH
    np.testing.assert_allclose(driven, uniform[:, None], atol=1e-7 * np.abs(uniform).max())


def test_covariance_of_a_field_on_stretches_against_its_sum():
    """The slow twin: the double sum over a fine grid, with a gap, factors and a quadratic."""
    ends, length = [(0.1, 0.4, 1.0), (0.55, 1.2, 0.3)], 0.17
    pieces = []
    for begin, end, factor in ends:
        for first, last in pairwise(np.linspace(begin, end, 8)):
            places = first + (last - first) * POINTS
            pieces.append((first, last, factor * np.column_stack([np.ones(4), places**2])))
    got = field_covariance(pieces, length)
    places, values = [], []
    for begin, end, factor in ends:
        step = (end - begin) / 2000
        middle = begin + step * (0.5 + np.arange(2000))
        places.append(middle)
        values.append(step * factor * np.column_stack([np.ones(2000), middle**2]))
    at, weighted = np.concatenate(places), np.vstack(values)
    correlation = np.exp(-np.abs(at[:, None] - at) / length)
    np.testing.assert_allclose(got, weighted.T @ correlation @ weighted, rtol=2e-6)


@pytest.mark.parametrize(("correlation_length", "channels"), [(0.01, 9), (0.3, 9), (300.0, 5)])
def test_channels_explain_each_mode_to_the_tolerance(correlation_length, channels):
    tube, shapes, omega, _ = sine_modes(8)
    exact = drive_shapes(tube, shapes, omega, turbulence(correlation_length))
    driven = drive_shapes(tube, shapes, omega, turbulence(correlation_length, tolerance=0.01))
    missing = 1.0 - (driven**2).sum(axis=1) / (exact**2).sum(axis=1)
    assert missing.min() > -1e-9 and missing.max() <= 0.01
    assert driven.shape[1] <= channels


def test_modes_above_the_band_get_no_channel_of_their_own():
    tube, shapes, omega, _ = sine_modes(8)
    force = turbulence(0.02, band_Hz=(5.0, omega[2] / (2.0 * np.pi)), tolerance=0.01)
    driven = drive_shapes(tube, shapes, omega, force)
    exact = drive_shapes(tube, shapes, omega, turbulence(0.02))
    missing = 1.0 - (driven**2).sum(axis=1) / (exact**2).sum(axis=1)
    weight = np.minimum(omega[2] / omega, 1.0) ** 4
    assert driven.shape[1] < exact.shape[1]
    assert np.all(weight * missing <= 0.01) and missing.max() > 0.1


def test_the_load_of_a_spectrum_is_its_line_force_summed():
    """Root of PSD x band x double integral of the correlation; near 2 lambda L if short."""
    config = beam(
        {
            "spectrum": {
                "kind": "table",
                "frequency_Hz": [1.0, 300.0],
                "psd_N2_per_m2_Hz": [4.0e-3, 4.0e-3],
            }
        }
    )
    got = load_of_spectrum(config.structure, config.excitation)
    variance = 4.0e-3 * 195.0 * LENGTH**2 * square_of_sum(LENGTH / 0.1)
    assert got == pytest.approx(np.sqrt(variance), rel=1e-9)
    assert got == pytest.approx(np.sqrt(4.0e-3 * 195.0 * 2.0 * 0.1 * LENGTH), rel=0.03)


def simulated(excitation, seeds=16):
    """The records of a beam under 2 N, and its model and configuration."""
    config = beam(excitation)
    model = build_model(config)
    cases = [Case(2.0, GAP, seed) for seed in range(seeds)]
    return config, model, [record for _, record in simulate_cases(config, model, cases)]


def mean_psd(config, records, name, index=None):
    """(frequency, PSD averaged over segments and records)."""
    psds = []
    for record in records:
        values = record[name].values if index is None else record[name].values[index]
        spectra = segment_spectra(values.astype(float), 1024.0, config.spectra)
        psds.append(psd_statistics(spectra.values)[0][0])
    return spectra.frequency, np.mean(psds, axis=0)


def test_simulated_spectra_are_those_of_the_linear_beam():
    """Band by band within four standard errors: one per square root of duration x bandwidth."""
    spectrum = {
        "kind": "tube_bundle",
        "velocity_m_per_s": 2.0,
        "fluid_density_kg_per_m3": 750.0,
    }
    config, model, records = simulated({"spectrum": spectrum, "correlation_length_m": 0.3})
    assert all(record["contact_fraction"].values.max() == 0.0 for record in records)
    assert model.drive_shapes.shape[1] >= 4
    fine = np.arange(4.0, 205.0, 0.01)
    unit = (
        line_force_psd(config.excitation, DIAMETER, fine)
        / line_force_rms(config.excitation, DIAMETER) ** 2
    )
    for index, name in ((0, "middle.x"), (2, "side.x")):
        assert model.sensor_names[index] == name
        frequency, psd = mean_psd(config, records, "displacement", index)
        shape = model.sensor_shapes[:, [index]]
        channels = range(model.drive_shapes.shape[1])
        power = sum(np.abs(frf(model, 0.0, 0.0, fine, shape, channel=n)[0]) ** 2 for n in channels)
        expected = 2.0**2 * unit * power
        for low, high in ((5.5, 9.0), (9.0, 16.0), (16.0, 60.0), (60.0, 110.0), (110.0, 190.0)):
            inside = (frequency >= low) & (frequency < high)
            at = (fine >= frequency[inside][0] - 0.125) & (fine < frequency[inside][-1] + 0.125)
            ratio = psd[inside].mean() / expected[at].mean()
            # of the few lines that carry the power of a band with a peak
            power = expected[at] / expected[at].sum()
            width = 0.01 / np.sum(power**2)
            error = 1.0 / np.sqrt(20.0 * len(records) * width)
            assert abs(ratio - 1.0) < 4.0 * error + 0.01, (name, low, ratio, error)
    frequency, psd = mean_psd(config, records, "force")
    inside = (frequency > 6.0) & (frequency < 195.0)
    wanted = 4.0 * np.interp(frequency[inside], fine, unit)
    ratio = (psd[inside] / wanted).mean()
    assert abs(ratio - 1.0) < 4.0 / np.sqrt(20.0 * len(records) * 189.0) + 0.01


def test_the_two_directions_are_independent_and_alike():
    keys = {"both_directions": True, "correlation_length_m": 0.2}
    _, model, records = simulated(keys, 8)
    names = list(model.sensor_names)
    x, y = (names.index(f"middle.{axis}") for axis in "xy")
    moved = np.array([record["displacement"].values[[x, y]] for record in records], float)
    square = (moved**2).mean(axis=(0, 2))
    assert square[0] == pytest.approx(square[1], rel=0.25)
    product = (moved[:, 0] * moved[:, 1]).mean() / np.sqrt(square[0] * square[1])
    assert abs(product) < 4.0 / np.sqrt(8 * 20.0 * 3.0)
    # the first direction is the same bit for bit without the second
    _, _, alone = simulated(keys | {"both_directions": False}, 8)
    np.testing.assert_array_equal(
        alone[3]["displacement"].values[x], records[3]["displacement"].values[x]
    )
    assert not np.any(alone[3]["displacement"].values[y])


def test_a_doubled_load_and_gap_double_the_record():
    config = beam({}, record=short_record())
    model = build_model(config)
    ((_, one),) = simulate_cases(config, model, [Case(40.0, 1.0e-3, 2)])
    ((_, two),) = simulate_cases(config, model, [Case(80.0, 2.0e-3, 2)])
    assert one["contact_fraction"].values[0] > 0.0
    for name in ("displacement", "force", "support_force"):
        np.testing.assert_array_equal(2.0 * one[name].values, two[name].values)


def test_forces_of_all_channels_act_at_every_step():
    """The contact point moves as the sum of its modes, each solved alone for a linear force."""
    record = short_record(every_step=True)
    steps = {"steps_per_second": 10240, "start_up_s": 0.0}
    config = beam({"both_directions": True}, record=record, integration=steps)
    model = build_model(config)
    ((_, record),) = simulate_cases(config, model, [Case(4.0, GAP, 2)])
    count, rate = record.sizes["step"], 10240.0

    def values(excitation, generator):
        last = slice(0, round(rate) + 1)
        stream = ForceStream(excitation, generator, round(rate) + 12, rate, last)
        return stream.values(0, round(rate) + 12)

    channels = model.drive_shapes.shape[1]
    assert channels > 8
    force = 4.0 * np.array(force_channels(config, 2, channels, values))[:, :count]
    moved = np.zeros((count, 2))
    for mode, push in enumerate(model.drive_shapes @ force):
        oscillator = [1.0, model.damping[mode], model.omega[mode] ** 2]
        amplitude = lsim(([1.0], oscillator), push, np.arange(count) / rate)[1]
        moved += amplitude[:, None] * model.contact_shapes[mode, 0]
    got = record["contact_displacement"].values[0].T
    assert np.abs(moved).max(axis=0).min() > 1e-5
    np.testing.assert_allclose(got, moved, atol=1e-8 * np.abs(moved).max())


def short_record(**keys):
    """Sensors and one second of record."""
    return {
        "duration_s": 1.0,
        "sampling_frequency_Hz": 1024,
        "sensors": {"points": ["middle"], "directions": ["x", "y"]},
        "shape_line": {"points": 3, "direction": "x"},
    } | keys
