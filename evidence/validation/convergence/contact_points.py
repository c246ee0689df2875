"""First frequency against support stiffness, by the number of contact points per support.

The points stand for a layer of distributed stiffness. N points of equal stiffness, both edges
included, have the second moment h²/12 (N + 1)/(N - 1) about mid-height; a layer of the same
stiffness has h²/12. The rotational stiffness is too high by 2/(N - 1), an error of order 1 in the
spacing. With half a share at the edges (the trapezoidal rule) it is too high by 2/(N - 1)²,
order 2. Both orders are checked.
"""

import numpy as np

from evidence.validation.check import Check
from vibroimpact.config.reading import changed_config
from vibroimpact.identify.linear.modes import natural_frequencies
from vibroimpact.reduction.reduced_model import build_model

from .rate import extrapolated, fitted_order, successive_changes

CASE = "convergence: contact points"
STIFFNESS = np.sort(np.append(np.logspace(0.0, 9.0, 37), 4.0e6))  # N/m per support
REFINED_POINTS = (3, 5, 9, 17, 33)  # spacings halve
# N/m per support, where the first frequency depends on the rotational stiffness.
REFINED_STIFFNESS = (1.0e6, 4.0e6, 1.0e7)
WEIGHTS = {"equal": 1.0, "trapezoidal": 2.0}  # sharing of the stiffness -> order in the spacing
ORDER_TOLERANCE = 0.1  # absolute
# (k N/m, points) -> published first frequency (Hz) of the stand-in tube, 20 elements per span and
# 40 per bend.
PUBLISHED = {
    (4.0e6, 1): 27.751,
    (4.0e6, 2): 28.215,
    (4.0e6, 3): 28.069,
    (4.0e6, 5): 27.993,
    (4.0e6, 9): 27.954,
    (1.0e9, 1): 28.186,
    (1.0e9, 2): 33.621,
    (1.0e9, 3): 33.516,
    (1.0e9, 5): 33.331,
    (1.0e9, 9): 33.173,
}
PUBLISHED_TOLERANCE = 1.0e-4
FIVE_SUFFICE = 3.0e-3  # relative: accuracy of the modal frequencies of a model (docs/method.md)
SHARING = (("equal", 1), ("equal", 2), ("equal", 3), ("equal", 5), ("equal", 9), ("trapezoidal", 5))


def model_with_points(config, points, weights="equal"):
    """Return the ModalModel of the configuration with `points` contact points per support.

    weights: "equal", or that of the trapezoidal rule.
    """
    share = np.ones(points)
    if weights == "trapezoidal":
        share[[0, -1]] = 0.5
    total = float(np.sum(config.supports[0].stiffness_N_per_m))
    return build_model(
        changed_config(
            config,
            {
                "supports.points": points,
                "supports.stiffness_N_per_m": (total * share / share.sum()).tolist(),
            },
        )
    )


def contact_point_rows(config, sharing=SHARING, stiffness=STIFFNESS):
    """Return one row per sharing of the stiffness, number of points and stiffness.

    The layer has the sharing "layer" and 0 points. Row keys: weights, points, stiffness_N_per_m,
    first_frequency_Hz, from_layer (relative difference from the layer).
    """
    layer = layer_frequencies(config, stiffness)
    rows = []
    for weights, points in (*sharing, ("layer", 0)):
        values = (
            first_frequencies(model_with_points(config, points, weights), stiffness)
            if points
            else layer
        )
        rows += [
            {
                "weights": weights,
                "points": points,
                "stiffness_N_per_m": float(k),
                "first_frequency_Hz": value,
                "from_layer": value / limit - 1.0,
            }
            for k, value, limit in zip(stiffness, values, layer, strict=True)
        ]
    return rows


def first_frequencies(model, stiffness):
    """Return (k,) the lowest frequency in Hz for each support stiffness (k,) in N/m."""
    return np.array([natural_frequencies(model, k, 1)[0] for k in stiffness])


def layer_frequencies(config, stiffness):
    """Return (k,) Hz of a layer of stiffness.

    It is the limit of 17 and 33 points shared by the trapezoidal rule, of order 2.
    """
    coarse, fine = (
        first_frequencies(model_with_points(config, count, "trapezoidal"), stiffness)
        for count in REFINED_POINTS[-2:]
    )
    return extrapolated([coarse, fine], 2.0)


def refinement_rows(config, stiffness=REFINED_STIFFNESS, points=REFINED_POINTS):
    """Return one row per sharing of the stiffness, number of points and stiffness.

    Spacings halve. Row keys: weights, points, stiffness_N_per_m, size (spacing over the support's
    height), first_frequency_Hz, change (relative, to the next finer spacing; NaN for the finest).
    """
    rows = []
    for weights in WEIGHTS:
        table = np.array(
            [
                first_frequencies(model_with_points(config, count, weights), stiffness)
                for count in points
            ]
        )
        for column, k in enumerate(stiffness):
            change = np.append(successive_changes(table[:, column]) / table[-1, column], np.nan)
            rows += [
                {
                    "weights": weights,
                    "points": count,
                    "stiffness_N_per_m": k,
                    "size": 1.0 / (count - 1),
                    "first_frequency_Hz": table[level, column],
                    "change": change[level],
                }
                for level, count in enumerate(points)
            ]
    return rows


def published_checks(config):
    """Return the Checks against the published first frequencies, on the published mesh."""
    stated = changed_config(
        config, {"structure.mesh.elements_per_span": 20, "structure.mesh.elements_per_bend": 40}
    )
    models = {points: model_with_points(stated, points) for _, points in PUBLISHED}
    return [
        Check(
            CASE,
            f"first frequency, {points} points, k = {k:g} N/m",
            "Hz",
            value,
            "two finite-element codes",
            float(first_frequencies(models[points], [k])[0]),
            PUBLISHED_TOLERANCE,
        )
        for (k, points), value in PUBLISHED.items()
    ]


def order_checks(rows):
    """Return the Checks of the fitted orders in the spacing, from `refinement_rows`."""
    checks = []
    for weights, k in dict.fromkeys((row["weights"], row["stiffness_N_per_m"]) for row in rows):
        own = [
            row
            for row in rows
            if (row["weights"], row["stiffness_N_per_m"]) == (weights, k)
            and np.isfinite(row["change"])
        ][-3:]
        order = fitted_order([row["size"] for row in own], [row["change"] for row in own])
        checks.append(
            Check(
                CASE,
                f"order in the spacing, {weights} shares, k = {k:g} N/m",
                "1",
                WEIGHTS[weights],
                "second moment of the points",
                order,
                ORDER_TOLERANCE,
                1.0,
            )
        )
    return checks


def five_points_checks(config, rows):
    """Return the Check that five equal points follow the layer up to the contact's own stiffness.

    rows: of `contact_point_rows`. Towards 1e9 N/m five points are up to 2 % too stiff, because
    both edges have a whole share where the layer has half of one.
    """
    contact = float(np.sum(config.supports[0].stiffness_N_per_m))
    own = [
        row
        for row in rows
        if (row["weights"], row["points"]) == ("equal", 5) and row["stiffness_N_per_m"] <= contact
    ]
    farthest = max((row["from_layer"] for row in own), key=abs)
    return [
        Check(
            CASE,
            f"first frequency of 5 points against the layer's, farthest from 1 to {contact:g} N/m,"
            " relative",
            "1",
            0.0,
            "the paper, figure 4: five points are a good compromise",
            float(farthest),
            FIVE_SUFFICE,
            1.0,
        )
    ]


def checks(config, rows, refined):
    """Return all Checks of the topic, from `contact_point_rows` and `refinement_rows`."""
    return published_checks(config) + five_points_checks(config, rows) + order_checks(refined)
