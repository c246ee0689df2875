"""Detection against strength: how strong a hidden effect must be for a campaign to tell of it."""

import numpy as np
from scipy import optimize, special

# kinds with one effect hidden, which the catalogue holds
KINDS = ("strong", "medium", "exact_alias", "near_alias")
POWER = 0.80  # probability of detection at the limit
FEWEST = 8  # campaigns that a limit is fitted to
WEAKEST = 0.1  # floors; less is half a percent of misfit beyond the floor: none
DEVIANCE = 3.841  # 95 % quantile of chi squared with one degree of freedom
CELLS = 200  # limits tried
SLOPES = (0.0, 4.0)  # the fit starts from, per factor e of the strength


def single_effects(rows):
    """Return the judged rows with one effect hidden whose strength is known."""
    return [row for row in rows if row["drawn_as"] in KINDS and np.isfinite(row["strength"])]


def probability(curve, strength):
    """Return the probability of detection at strengths in floors, for (intercept, slope) over the
    logarithm of the strength.
    """
    return special.expit(curve[0] + curve[1] * _logarithm(strength))


def detection_curve(strength, found):
    """Return (intercept, slope) of the logistic regression of found (campaign,) bool on the
    logarithm of the strength in floors.

    Firth's: the likelihood times Jeffreys' prior, the root of the determinant of the information.
    It has a finite maximum where all weak effects are missed and all strong ones found, which sends
    the slope of plain maximum likelihood to infinity, and no constant to choose.
    """
    x, y = _logarithm(strength), np.asarray(found, bool)
    centre, level = x.mean(), special.logit((y.sum() + 0.5) / (y.size + 1.0))
    # Of few campaigns the product can have a flat and a steep maximum: the higher one counts.
    fits = [
        optimize.minimize(
            lambda at: -_likelihood(at[0] - at[1] * centre, at[1], x, y),
            (level, slope),
            method="BFGS",
        )
        for slope in SLOPES
    ]
    middle, slope = min(fits, key=lambda fit: fit.fun).x
    return float(middle - slope * centre), float(slope)


def detection_limit(strength, found):
    """Return {limit, low, high, note}: the strength in floors at which POWER of the campaigns find
    what is hidden, and its 95 % interval.

    The interval holds the limits that the penalised likelihood, at its best slope, does not reject;
    NaN where the campaigns do not bound it. limit is NaN, and note says why, where there are too
    few campaigns, all alike, or none as strong or weak as it.
    """
    strength, found = np.asarray(strength, float), np.asarray(found, bool)
    nothing = {"limit": float("nan"), "low": float("nan"), "high": float("nan")}
    if found.size < FEWEST:
        return nothing | {
            "note": f"{found.size} campaigns, fewer than {FEWEST}: no limit is fitted"
        }
    if found.all() or not found.any():
        return nothing | {
            "note": (
                f"{'all' if found.all() else 'none'} of {found.size} found: the limit lies"
                f" {'below' if found.all() else 'above'} what was tried"
            )
        }
    intercept, slope = detection_curve(strength, found)
    x = _logarithm(strength)
    at = (special.logit(POWER) - intercept) / slope if slope > 0.0 else np.inf
    if not x.min() <= at <= x.max():
        side = "below" if at < x.min() else "above"
        return nothing | {
            "note": (
                f"{found.sum()} of {found.size} found: the limit lies {side} what was tried"
                if slope > 0.0
                else "detection does not grow with strength: no limit"
            )
        }
    low, high = _interval(x, found, _likelihood(intercept, slope, x, found))
    return {"limit": float(np.exp(at)), "low": low, "high": high, "note": ""}


def detection(rows):
    """Return rows {effect, campaigns, found, limit_over_floor, limit_low, limit_high} of judged
    rows: all together, then each effect with enough of them.
    """
    rows = single_effects(rows)
    names = sorted({row["hidden"] for row in rows})
    groups = [("all", rows)] + [
        (name, of)
        for name in names
        if len(of := [row for row in rows if row["hidden"] == name]) >= FEWEST
    ]
    out = []
    for name, of in groups:
        found = [row["in_set"] for row in of]
        limit = detection_limit([row["strength"] for row in of], found)
        out.append(
            {
                "effect": name,
                "campaigns": len(of),
                "found": sum(found),
                "limit_over_floor": limit["limit"],
                "limit_low": limit["low"],
                "limit_high": limit["high"],
            }
        )
    return out


def _likelihood(intercept, slope, x, y):
    """Return the logarithm of likelihood and Jeffreys' prior."""
    line = intercept + slope * x
    weight = special.expit(line) * special.expit(-line)
    total, mean = weight.sum(), weight @ x
    information = max(total * (weight @ x**2) - mean**2, 1.0e-300)
    return float(np.sum(special.log_expit(np.where(y, line, -line))) + 0.5 * np.log(information))


def _interval(x, y, best):
    """Return (low, high) of the limits in floors whose deviance stays below DEVIANCE, slopes
    upwards; NaN where that reaches the end of what was tried.
    """
    tried = np.linspace(x.min(), x.max(), CELLS)

    def at_best_slope(limit):
        def loss(slope):
            return -_likelihood(special.logit(POWER) - np.exp(slope) * limit, np.exp(slope), x, y)

        return -optimize.minimize_scalar(loss, bounds=(-5.0, 5.0), method="bounded").fun

    kept = np.array([2.0 * (best - at_best_slope(limit)) < DEVIANCE for limit in tried])
    first, last = np.flatnonzero(kept)[[0, -1]] if kept.any() else (0, CELLS - 1)
    return float(np.exp(tried[first])) if first > 0 else float("nan"), (
        float(np.exp(tried[last])) if last < CELLS - 1 else float("nan")
    )


def _logarithm(strength):
    return np.log(np.maximum(np.asarray(strength, float), WEAKEST))
