"""The parts of the discrepancy workflow, each against a number from elsewhere."""

import numpy as np
import pytest

from vibroimpact.discrepancy import naming
from vibroimpact.discrepancy.candidates import Candidate, Pair, candidate_named
from vibroimpact.discrepancy.emulator import Emulator
from vibroimpact.discrepancy.features import (
    COARSE,
    FeatureLayout,
    compressed,
    record_features,
    uncompressed,
)
from vibroimpact.discrepancy.likelihood import LawLikelihood, log_likelihood, scatter_of
from vibroimpact.discrepancy.mapping import clusters
from vibroimpact.discrepancy.misfit import closed_fraction, excess, floor_of
from vibroimpact.discrepancy.next_measurement import next_measurement
from vibroimpact.discrepancy.null import Null
from vibroimpact.discrepancy.screening import NINETY, _above, _best, _profile
from vibroimpact.discrepancy.workbench import Workbench

RATE = 2048.0


def layout(channels=1, pairs=()):
    """A FeatureLayout of 24 bands from 5 to 200 Hz."""
    rows = [("power", c, b) for c in range(channels) for b in range(24)] + [
        ("coherence", c, b) for c in range(channels) for b in range(COARSE)
    ]
    rows += [(kind, a, b) for kind in ("co", "quad") for a, _ in pairs for b in range(COARSE)]
    rows += [(kind, c, -1) for kind in ("skewness", "kurtosis") for c in range(channels)]
    kind, channel, band = map(np.array, zip(*rows, strict=True))
    return FeatureLayout(
        RATE,
        np.geomspace(5.0, 200.0, 25),
        np.geomspace(5.0, 200.0, COARSE + 1),
        list(pairs),
        kind,
        channel,
        band,
    )


def test_band_power_of_white_noise_is_density_times_width():
    force, response = np.random.default_rng(1).standard_normal((2, 60 * 2048))
    found = layout().power(record_features(layout(), force, response[None]))[0]
    expected = 10.0 * np.log10(2.0 / RATE * np.diff(layout().edges))
    assert np.abs(found - expected)[12:].max() < 0.7
    assert abs(np.mean(10 ** (found / 10)) / np.mean(10 ** (expected / 10)) - 1.0) < 0.03


def test_coherence_is_one_for_the_force_zero_for_noise():
    force, other = np.random.default_rng(2).standard_normal((2, 60 * 2048))
    features = record_features(layout(2), force, np.stack([3.0 * force, other]))
    coherence = np.tanh(features[layout(2).kind == "coherence"]).reshape(2, -1)
    assert coherence[0].min() > 0.99 and coherence[1].max() < 0.45


def test_the_sense_of_two_directions_is_seen():
    x = np.random.default_rng(3).standard_normal(40 * 2048)
    chosen = layout(2, [(0, 1)])
    same, against = (
        record_features(chosen, x, np.stack([x, sign * x]))[chosen.kind == "co"]
        for sign in (1.0, -1.0)
    )
    np.testing.assert_allclose(same, -against)
    assert same.min() > 3.0


def test_asinh_compression_is_invertible_and_linear_near_zero():
    values = np.linspace(-60.0, 60.0, layout().kind.size)
    np.testing.assert_allclose(
        uncompressed(compressed(values, layout()), layout()), values, atol=1e-9
    )
    assert np.abs(compressed(0.01 * np.ones(layout().kind.size), layout()) - 0.01).max() < 1e-6


def test_shrunk_covariance_keeps_variances_and_can_be_inverted():
    chosen = layout()
    draws = np.random.default_rng(4).standard_normal((12, chosen.kind.size)) * np.linspace(
        0.1, 1.0, chosen.kind.size
    )
    scatter = scatter_of(draws, chosen)
    assert np.linalg.eigvalsh(scatter.covariance).min() > 0.0
    np.testing.assert_allclose(
        np.diag(scatter.covariance),
        np.sum(compressed(draws - draws.mean(axis=0), chosen) ** 2, axis=0) / 11.0,
    )


def test_likelihood_falls_with_distance_and_levels_off():
    scores = [
        log_likelihood(np.full(40, distance), np.eye(40))[0] for distance in (0.0, 1.0, 10.0, 100.0)
    ]
    assert scores[0] > scores[1] > scores[2] > scores[3]
    gaussian = -0.5 * 40 * 100.0**2
    assert (
        scores[3] - scores[0] > 0.01 * gaussian
    )  # a t law: a hundred sigma are not a hundred times ten


def test_model_error_is_tolerated_in_proportion():
    change = np.full(40, 20.0)
    plain = log_likelihood(0.1 * change, np.eye(40))[1]
    forgiven = log_likelihood(0.1 * change, np.eye(40), change, np.zeros(40, int))[1]
    assert forgiven < 0.1 * plain


def test_emulator_interpolates_its_points():
    points = np.linspace(0.0, 1.0, 8)[:, None]
    curve = np.column_stack([np.sin(3.0 * points[:, 0]), points[:, 0] ** 2])
    emulator = Emulator(points, curve, np.full(8, 1e-6))
    between, unknown = emulator(np.array([0.37]))
    np.testing.assert_allclose(between, [np.sin(1.11), 0.37**2], atol=0.01)
    assert unknown < 0.01


def test_emulated_angles_wrap_round():
    points = np.linspace(0.0, 0.9, 10)[:, None]
    emulator = Emulator(points, np.cos(2.0 * np.pi * points), np.full(10, 1e-6), periodic=(0,))
    np.testing.assert_allclose(emulator(np.array([0.999]))[0], 1.0, atol=0.02)


def test_emulator_fits_a_length_scale_per_parameter():
    points = np.stack(
        np.meshgrid(np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 3)), axis=-1
    ).reshape(-1, 2)
    emulator = Emulator(
        points, np.sin(9.0 * points[:, :1]) + 0.3 * points[:, 1:], np.full(27, 1e-6)
    )
    assert emulator.lengths[0] < emulator.lengths[1]
    np.testing.assert_allclose(
        emulator(np.array([0.43, 0.31]))[0], np.sin(9.0 * 0.43) + 0.093, atol=0.05
    )


@pytest.mark.parametrize("best", [(0.731,), (0.123, 0.618), (0.31, 0.77, 0.52, 0.9)])
def test_the_search_finds_the_top_of_a_tilted_hill(best):
    tilt = np.eye(len(best)) + 0.4

    def score(point):
        away = (np.asarray(point) - best) / 0.08
        return -0.5 * away @ tilt @ away

    unit = _best(score, np.full(len(best), 0.5))
    np.testing.assert_allclose(unit, best, atol=0.02 if len(best) > 2 else 0.004)
    for number, (values, scores) in enumerate(_profile(score, unit)):
        low, high = _above(values, scores, unit[number], NINETY)
        assert high - low == pytest.approx(
            2 * 1.645 * 0.08 * np.sqrt(np.linalg.inv(tilt)[number, number]), rel=0.1
        )


def test_flat_likelihood_gives_the_whole_range():
    ((values, scores),) = _profile(lambda point: 0.0, np.array([0.4]))
    assert _above(values, scores, 0.4).tolist() == [0.0, 1.0]


def test_components_of_a_vector_are_also_tried_alone():
    design = Candidate("support_offset", "all").design()
    assert {(0.5, 0.3), (0.5, 0.7), (0.3, 0.5), (0.7, 0.5), (0.5, 0.4), (0.6, 0.5)} <= {
        tuple(np.round(point, 6)) for point in design
    } and len(design) == 17
    assert len(Candidate("support_offset", "all").design(quick=True)) == 8  # along the axes alone
    assert len(Candidate("plate_flexibility", "all").design()) == 12


def test_neutral_point_is_known_if_in_range():
    scales = {"gap": 2.0e-4, "one": 1.0}
    offset, friction = Candidate("support_offset", "all"), Candidate("dry_friction", "all")
    np.testing.assert_allclose(
        offset.physical(offset.neutral_unit(scales), scales)["offset_x"], 0.0, atol=1e-12
    )
    assert np.isnan(friction.neutral_unit(scales)).all()


def test_interval_of_a_parabola():
    values = np.linspace(0.0, 1.0, 61)
    low, high = _above(values, -0.5 * ((values - 0.4) / 0.1) ** 2, 0.38, NINETY)
    np.testing.assert_allclose([low, high], [0.4 - 0.1645, 0.4 + 0.1645], atol=0.006)


def test_interval_belongs_to_the_highest_maximum():
    """Where nothing was simulated the score of an emulator rises again, above what is known."""
    values = np.linspace(0.0, 1.0, 61)
    low, high = _above(
        values,
        np.maximum(-0.5 * ((values - 0.4) / 0.05) ** 2, np.where(values > 0.9, 30.0, -20.0)),
        0.41,
        NINETY,
    )
    np.testing.assert_allclose([low, high], [0.4 - 0.0822, 0.4 + 0.0822], atol=0.006)


def test_profile_stays_within_simulated_points():
    ((values, _),) = _profile(
        lambda point: -float(point[0] ** 2), np.array([0.4]), np.array([[0.2, 0.6]])
    )
    assert (values.min(), values.max()) == (0.2, 0.6)


def test_closed_fraction_is_that_of_the_excess():
    assert excess(5.0, 3.0) == pytest.approx(4.0)
    assert closed_fraction(5.0, np.hypot(3.0, 1.0), 3.0) == pytest.approx(0.75)
    assert closed_fraction(3.1, 3.0, 3.0) is None


def test_floor_of_independent_seeds_is_root_two_of_their_scatter():
    power = np.random.default_rng(5).standard_normal((2, 8, 3, 24))
    assert floor_of(power, np.ones((2, 3, 24), bool)) == pytest.approx(np.sqrt(2.0), rel=0.1)


def test_names_of_candidates_come_back():
    for name in ("gap@all", "gap@left+dry_friction@all"):
        assert candidate_named(name).name == name
    pair = Pair(Candidate("gap", "all"), Candidate("foliate_obstacle", "all"))
    assert pair.split == 1 and pair.periodic == (2,) and len(pair.effect.parameters) == 3


def test_exact_alias_comes_with_a_measurement_to_break_it():
    assert "clearance" in next_measurement([["gap"], ["sensor_gain"]])
    assert next_measurement([["gap"]]) is None


def test_draws_share_no_seed():
    class Bench:
        draw = 0
        signals = type("Signals", (), {"gap": [1e-4, 2e-4]})

    seeds = []
    for draw in (0, 1, 2):
        Bench.draw = draw
        seeds.append(
            {
                seed
                for first in (0, 900, 20000)
                for _, _, seed in Workbench.runs(Bench, [0, 1], 16, first)
            }
        )
    assert seeds[0] & set(range(16)) and not seeds[0] & seeds[1] and not seeds[1] & seeds[2]


def test_clusters_end_at_half_the_peak_difference():
    difference = np.array([0.5, 6.0, 10.0, 7.0, 3.0, 3.5, -4.0, 0.2])
    found = clusters(difference, np.abs(difference) > 0.3)
    assert [row.tolist() for row in found] == [[1, 2, 3], [6], [4, 5], [0]]


def test_damping_direction_is_no_evidence():
    """A difference along a free direction costs its prior, however large; across it nothing is
    forgiven.
    """
    covariance = np.eye(40)[None]
    null = Null(
        np.array([1]),
        np.zeros((1, 4, 40)),
        np.zeros((1, 40)),
        covariance,
        covariance,
        np.zeros(40, int),
        np.full(40, 10.0),
    )
    silent = np.where(np.arange(40) < 20, 8.0, 0.0)
    freed = null.freed(silent[None, None])
    along = log_likelihood(silent, freed.covariance[0])[1]
    across = log_likelihood(silent[::-1], freed.covariance[0])[1]
    assert along == pytest.approx(1.0, abs=0.01)
    assert across == pytest.approx(20 * 64.0)
    assert null.covariance is covariance


def test_closed_fraction_without_bands_is_undefined():
    assert closed_fraction(0.0, 0.0, 0.0) is None


def test_larger_scatter_of_the_model_runs_is_used():
    rng, size = np.random.default_rng(8), 40
    null = Null(
        np.array([1]),
        rng.standard_normal((1, 16, size)),
        np.zeros((1, size)),
        2.0 * np.eye(size)[None],
        np.eye(size)[None],
        np.zeros(size, int),
        np.full(size, 1.0e6),
    )
    along = np.ones(size) / np.sqrt(size)
    alike = rng.standard_normal((1, 20, size))
    apart = alike + 8.0 * rng.standard_normal((1, 20, 1)) * along
    assert along @ null.scattered(alike).covariance[0] @ along < 4.0
    wider = null.scattered(apart).covariance[0]
    assert 20.0 < along @ wider @ along < 100.0  # 64 more, shrunk
    across = np.where(np.arange(size) < size // 2, 1.0, -1.0) / np.sqrt(size)
    assert across @ wider @ across < 8.0


def test_bursts_widen_the_chi_square_scatter():
    """A record in which one run of sixteen breaks out: its chi-square without that run is far from
    the others', so no 200 above expectation says that something is missing.
    """
    rng, size = np.random.default_rng(5), 60
    calm = rng.standard_normal((16, size))
    burst = calm + np.where(np.arange(16) == 3, 4.0, 0.0)[:, None]
    features = np.stack([calm, burst])
    covariances = np.array(
        [
            np.diag(np.full(size, 1.0))
            + (1.0 + 1.0 / 16.0) * scatter_of(rows, Blend(size)).covariance
            for rows in features
        ]
    )
    null = Null(
        np.array([1, 2]),
        features,
        features.mean(axis=1),
        covariances,
        covariances,
        np.zeros(size, int),
        Blend(size).blend,
    )
    chi_square = null.left_out()
    assert (
        chi_square.shape == (2, 16) and 0.4 * size < chi_square[0].mean() < 0.8 * size
    )  # half of the covariance is what two codes differ by
    assert np.argmax(chi_square[1]) == 3 and chi_square[1, 3] > 5.0 * np.median(chi_square[1])
    least, wider = naming.bare_spread(null)
    assert least == pytest.approx(naming.SPREAD * np.sqrt(2.0 * size)) and wider > 4.0 * least


class Blend:
    """What the compression of differences needs, so large that there is none."""

    def __init__(self, size):
        self.blend = np.full(size, 1.0e6)


def test_diagonalised_likelihood_is_the_same():
    rng, size = np.random.default_rng(4), 40
    root = rng.standard_normal((size, 2 * size))
    covariance = root @ root.T
    change = rng.standard_normal(size)
    groups = np.arange(size) % 2
    spread = rng.uniform(0.0, 1.0, size) ** 4
    spread[3] = 0.0
    held = LawLikelihood(covariance, change, groups, spread)
    for multiple in (0.0, 0.3, 40.0):
        residual = 5.0 * rng.standard_normal(size)
        assert held(residual, multiple) == pytest.approx(
            log_likelihood(residual, covariance, change, groups, multiple * spread)[0], abs=1.0e-3
        )
