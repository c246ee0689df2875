"""Claims on the main peak: its transition, its pole by two methods, its apparent damping."""

import numpy as np

from evidence.validation.study_curves import median, standard_error
from vibroimpact.identify.linear.poles import first_pole

from .claim import AGREE, Claim, graded, text

LARGEST_STEP = 0.10  # of the frequency, between neighbouring loads: a larger one is a jump
NEAR_LIMIT = 0.05  # of a linear limit's frequency
RISE, FALL = 2.0, 0.75  # apparent damping: of its low-level value, and of its maximum


def smooth_transition(curves, model):
    """Return the Claim that the peak moves smoothly from the low-level to the high-level regime."""
    frequency = median(curves.pole_frequency["lscf"])
    error = standard_error(curves.pole_frequency["lscf"])
    steps = np.diff(np.log(frequency))
    falls = np.diff(frequency) < -3.0 * np.hypot(error[1:], error[:-1])
    largest = float(np.nanmax(np.abs(steps)))
    return Claim(
        "the transition from the low to the high level regime is smooth",
        "3.2",
        "LSCF peak frequency against load",
        f"{frequency[0]:.2f} to {frequency[-1]:.2f} Hz, largest step between neighbouring loads"
        f" {100 * largest:.1f} %",
        f"no step above {100 * LARGEST_STEP:g} %, no fall beyond 3 standard errors",
        graded(largest <= LARGEST_STEP and not falls.any(), largest <= 2 * LARGEST_STEP),
        f"frequency rises over a factor of {_span(curves, frequency):.0f} in load without a jump",
    )


def _span(curves, frequency):
    """Return the factor in load over which the peak covers 5 to 95 % of its rise."""
    share = (frequency - frequency[0]) / (frequency[-1] - frequency[0])
    return float(
        np.exp(
            np.interp(0.95, share, np.log(curves.load))
            - np.interp(0.05, share, np.log(curves.load))
        )
    )


def limits(curves, model):
    """Return the Claim that the peaks at low and high level are at the two linear limits.

    The limits are k = 1 N/m and k = the contact's own stiffness.
    """
    stiffness = float(np.bincount(model.support_of_point, model.contact_stiffness).mean())
    free, held = (abs(first_pole(model, k, 0.0)) / (2.0 * np.pi) for k in (1.0, stiffness))
    low = float(median(curves.pole_frequency["lscf"])[0])
    tops = {gap: frequency / held - 1.0 for gap, frequency in curves.top_frequency.items()}
    widest, tightest = tops[max(tops)], tops[min(tops)]
    low_error = low / free - 1.0
    return Claim(
        "low and high level peaks sit on the two linear limits",
        "3.2",
        "LSCF peak frequency beside the linear tube's",
        f"low {low:.2f} Hz on {free:.2f}; high {curves.top_frequency[max(tops)]:.2f} Hz (largest"
        f" gap) and {curves.top_frequency[min(tops)]:.2f} Hz (smallest gap) on {held:.2f}",
        f"within {100 * NEAR_LIMIT:g} %",
        graded(
            max(abs(low_error), abs(widest)) <= NEAR_LIMIT,
            max(abs(low_error), abs(tightest)) <= NEAR_LIMIT,
        ),
        f"low level: {100 * low_error:+.2f} %; the largest load reaches {100 * widest:+.1f} % at"
        f" the largest gap and {100 * tightest:+.1f} % at the smallest: the high limit is"
        " approached, it is not reached while contacts open",
    )


def pole_methods(curves, model):
    """Return the Claim that poles from peak width and from operational modal analysis agree."""
    damping = _deviation(curves.pole_damping, ("peak_half", "lscf"))
    frequency = _deviation(curves.pole_frequency, ("peak_half", "lscf"))
    return Claim(
        "poles from the peak's width and from OMA agree",
        "4.1",
        "half-power and LSCF poles at every load, distance from their mean",
        f"damping ratio: worst {100 * np.nanmax(damping):.0f} %, median"
        f" {100 * np.nanmedian(damping):.1f} %; frequency: worst"
        f" {100 * np.nanmax(frequency):.2f} %",
        f"{100 * AGREE:g} %",
        graded(np.nanmax(damping) <= AGREE, np.nanmedian(damping) <= AGREE),
        (
            f"at all {np.isfinite(damping).sum()} loads where both resolve a pole"
            if np.nanmax(damping) <= AGREE
            else f"worst at {curves.load[np.nanargmax(damping)]:.3g} N"
        ),
    )


def widths(curves, model):
    """Return the Claim that widths read at 1/4 and 1/25 of the peak agree with half-power."""
    deviation = _deviation(curves.pole_damping, ("peak_half", "peak_quarter", "peak_25th"))
    worst = int(np.nanargmax(deviation))
    ratio = [
        median(curves.pole_damping[method])[worst] / median(curves.pole_damping["peak_half"])[worst]
        for method in ("peak_quarter", "peak_25th")
    ]
    return Claim(
        "widths at 1/4 and 1/25 of the peak agree with half-power",
        "4.1",
        "damping ratios by width, distance from their median",
        f"worst {100 * deviation[worst]:.0f} % at {curves.load[worst]:.3g} N, median"
        f" {100 * np.nanmedian(deviation):.1f} %",
        f"{100 * AGREE:g} %",
        graded(np.nanmax(deviation) <= AGREE, np.nanmedian(deviation) <= AGREE),
        f"where they differ most the ratios to half-power are {text(ratio)}: a peak that is an"
        " average of moving resonances has thinner skirts than a linear one of its width",
    )


def _deviation(tables, methods):
    values = np.array([median(tables[method]) for method in methods])
    centre = np.median(values, axis=0)
    return np.max(np.abs(values - centre), axis=0) / centre


def apparent_damping(curves, model):
    """Return the Claim that the apparent damping rises in the transition and falls back."""
    damping = median(curves.pole_damping["lscf"])
    error = standard_error(curves.pole_damping["lscf"])
    low, top, high = damping[0], int(np.nanargmax(damping)), damping[-1]
    sure = damping[top] - high > 2.0 * np.hypot(error[top], error[-1])
    linear = -first_pole(
        model, float(np.bincount(model.support_of_point, model.contact_stiffness).mean()), 0.0
    )
    held = linear.real / abs(linear)
    return Claim(
        "apparent damping rises in the transition and falls back",
        "4.1",
        "LSCF damping ratio against load",
        f"{100 * low:.2f} % at {curves.load[0]:.3g} N, {100 * damping[top]:.2f} +-"
        f" {100 * error[top]:.2f} % at {curves.load[top]:.3g} N, {100 * high:.2f} +-"
        f" {100 * error[-1]:.2f} % at {curves.load[-1]:.3g} N",
        f"maximum above {RISE:g} times the low level; highest load below {FALL:g} of the maximum,"
        " by 2 standard errors",
        graded(
            bool(damping[top] > RISE * low and high < FALL * damping[top] and sure),
            bool(damping[top] > RISE * low and high < damping[top]),
        ),
        f"it has not come down to the held tube's {100 * held:.2f} % at the largest load",
    )
