"""The null: what the bare model, corrected for nuisances, does on the campaign's forces from seed to seed."""

from dataclasses import dataclass

import numpy as np

from vibroimpact.discrepancy.likelihood import feature_sd, scatter_of


@dataclass(frozen=True)
class Null:
    """features (record, seed, feature); scatter: a Scatter per record; base_sd (feature,)."""

    features: np.ndarray
    scatter: list
    base_sd: np.ndarray


def null_runs(bench, records, seeds, first_seed=0):
    """Return (record, seed, feature) of the corrected bare model."""
    model = bench.model()
    return bench.features(model, bench.runs(records, seeds, first_seed)).reshape(len(records), seeds, -1)


def null_of(bench, features):
    """Return the Null of (record, seed, feature)."""
    return Null(features, [scatter_of(record) for record in features], feature_sd(bench.layout))
