"""Which bands of the map are marked: judged by the covariance and the error rate of the verdict."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.discrepancy.covariance import feature_sd, free_directions, shrunk
from vibroimpact.discrepancy.discrepancy_map import regions, significant, z_of
from vibroimpact.linear_stage import priors
from vibroimpact.linear_stage.driven_channels import driven_channels
from vibroimpact.observation.features import compressed, feature_layout

RECORDS, CHANNELS, BANDS, SEEDS = 4, 5, 24, 16


def null_of(bench, features):
    """The mean of features (record, seed, feature), and their covariance with what two codes differ
    by.
    """
    layout, rows = bench.layout, features - features.mean(axis=1, keepdims=True)
    common = free_directions(layout, driven_channels(bench))
    own = np.diag(feature_sd(layout) ** 2) + common.T @ common
    scatter = [shrunk(compressed(row, layout), SEEDS - 1) * (1.0 + 1.0 / SEEDS) for row in rows]
    return SimpleNamespace(
        records=np.arange(RECORDS), mean=features.mean(axis=1), covariance=np.array(scatter) + own
    )


def campaign(draw, change=0.0, scatter=0.4):
    """(Workbench in the parts that the map sees, Null, fresh seeds) of a campaign whose bands
    scatter by so many dB and whose channels have levels of their own, within the priors.
    """
    signals = SimpleNamespace(
        names=[f"c{number}" for number in range(CHANNELS)],
        kinds=["acceleration"] * CHANNELS,
        edges=np.geomspace(5.0, 200.0, BANDS + 1),
        band_Hz=(5.0, 200.0),
        rate=2048.0,
        load=np.arange(1.0, RECORDS + 1.0),
        gap=np.full(RECORDS, 2.0e-4),
        record_names=[f"r{number}" for number in range(RECORDS)],
    )
    layout = feature_layout(signals, np.eye(CHANNELS, 3) * np.arange(1.0, CHANNELS + 1)[:, None])
    size, power = len(layout.kind), layout.kind == "power"
    sd = np.where(power, scatter, 0.05)
    # the last channel is across the force: 1.2 dB of its level are of no code
    shapes = np.ones((3, CHANNELS))
    shapes[:, -1] = 0.0
    level = np.where(layout.channel == CHANNELS - 1, priors.LEVEL_SD[False], priors.LEVEL_SD[True])
    measured = sd * draw.standard_normal((RECORDS, size))
    measured += power * level * draw.standard_normal((RECORDS, 1))
    measured[2, (layout.channel == 1) & power & (layout.band == 7)] += change
    bench = SimpleNamespace(
        layout=layout,
        signals=signals,
        measured_features=measured,
        bare=SimpleNamespace(
            modes=3,
            support_names=(),
            support_of_point=np.zeros(0, int),
            sensor_positions=np.eye(CHANNELS, 3),
            sensor_directions=np.eye(CHANNELS, 3),
            contact_position=np.zeros((0, 3)),
            sensor_shapes=shapes,
            drive_shapes=np.ones((3, 1)),
            frequencies=np.array([20.0, 60.0, 150.0]),
        ),
    )
    features = sd * draw.standard_normal((RECORDS, SEEDS, size))
    null = null_of(bench, features)
    return bench, null, sd * draw.standard_normal((RECORDS, 4, size))


def marked(number, change=0.0):
    """Rows of regions of a campaign."""
    bench, null, seeds = campaign(np.random.default_rng(number), change)
    difference, z, _ = z_of(bench, null, seeds)
    return regions(bench, difference, z, np.ones(difference.shape, bool))


def test_levels_within_the_priors_mark_no_band():
    found = [len(marked(number)) for number in range(20)]
    assert np.count_nonzero(found) <= 1  # of 20 at a rate of 1 %


def test_band_beyond_chance_is_marked_alone():
    (row,) = marked(3, change=6.0)
    assert (row["record"], row["channel"]) == ("r2", "c1") and row["z"] > 5.0
    assert row["band_Hz"][0] == pytest.approx(5.0 * 40.0 ** (7 / 24))


def test_z_is_in_standard_deviations_of_the_verdict():
    bench, null, seeds = campaign(np.random.default_rng(11))
    difference, z, sd = z_of(bench, null, seeds)
    variance = np.diagonal(null.covariance, axis1=1, axis2=2)
    np.testing.assert_allclose(sd**2, bench.layout.power(variance))
    small = np.abs(difference) < 0.5
    np.testing.assert_allclose(z[small], (difference / sd)[small], rtol=1.0e-3, atol=1.0e-12)
    assert not significant(np.zeros((2, 3, 4)), np.ones((2, 3, 4), bool)).any()
