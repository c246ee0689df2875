"""Beams that campaigns are drawn on. Development and acceptance draw from different shapes."""

import numpy as np

from evidence.truth.geometry import Holder, Straight, Tube

NICE = 1.0e-4  # m: lengths are rounded to it, as in a drawing


def rounded(value):
    """A length [m] as a drawing gives it."""
    return round(float(value) / NICE) * NICE


def damping(rng):
    """Damping ratios of a beam: of the two lowest modes and of the others."""
    return {
        "first_damping": float(round(rng.uniform(0.006, 0.02), 4)),
        "other_damping": float(round(rng.uniform(0.002, 0.006), 4)),
    }


def u_tube(rng, acceptance):
    """A U-tube with a plate on each leg, not alike in acceptance draws."""
    diameter, leg = rng.uniform(0.0155, 0.0225), rng.uniform(0.5, 0.8)
    factors = (1.0, float(round(rng.uniform(0.7, 1.4), 2))) if acceptance else (1.0, 1.0)
    return Tube(
        outer_diameter=rounded(diameter),
        wall=float(round(diameter * rng.uniform(0.05, 0.09), 5)),
        leg=rounded(leg),
        bend_radius=rounded(rng.uniform(0.2, 0.36) if acceptance else rng.uniform(0.26, 0.32)),
        plate_height=rounded(leg * (rng.uniform(0.35, 0.75) if acceptance else 0.5)),
        plate_length=rounded(rng.uniform(0.012, 0.035)),
        plate_stiffness=float(round(np.exp(rng.uniform(np.log(1.0e6), np.log(8.0e6))), -4)),
        drive_angle=float(round(rng.uniform(0.3, 1.1), 3)),
        plate_factors=factors,
        **damping(rng),
    )


def spans(rng, acceptance):
    """A straight tube through plates: two along z, or two to four along x with unequal gaps."""
    count = int(rng.integers(2, 5)) if acceptance else 2
    length = rounded(rng.uniform(1.5, 2.4))
    diameter = rng.uniform(0.014, 0.022)
    inner = np.arange(1, count + 1) / (count + 1)
    if acceptance:
        inner = inner + rng.uniform(-0.12, 0.12, count) / (count + 1)
    stiffness = float(round(np.exp(rng.uniform(np.log(1.0e6), np.log(6.0e6))), -4))
    holders = tuple(
        Holder(
            f"plate_{number}",
            rounded(length * at),
            rounded(rng.uniform(0.012, 0.03)),
            stiffness,
            gap_factor=float(round(rng.uniform(0.8, 1.3), 2)) if acceptance else 1.0,
        )
        for number, at in enumerate(inner, 1)
    )
    return Straight(
        outer_diameter=rounded(diameter),
        wall=float(round(diameter * rng.uniform(0.05, 0.1), 5)),
        length=length,
        axis="x" if acceptance else "z",
        holders=holders,
        drive=rounded(length * rng.uniform(0.3, 0.45) / (count + 1)),
        ends=("clamped", "pinned") if acceptance else ("clamped", "clamped"),
        **damping(rng),
    )


def cantilever(rng, acceptance):
    """A cantilever in a ring, or between two flat stops; a solid rod in acceptance draws."""
    length = rounded(rng.uniform(0.55, 0.8))
    diameter = rng.uniform(0.010, 0.014) if acceptance else rng.uniform(0.016, 0.02)
    stops = {"profile": "lands", "lobes": 2, "angle": float(0.5 * np.pi)} if acceptance else {}
    holder = Holder(
        "stop",
        rounded(length * rng.uniform(0.7, 0.95)),
        rounded(rng.uniform(0.008, 0.015)),
        float(round(np.exp(rng.uniform(np.log(3.0e5), np.log(3.0e6))), -4)),
        nodes=3,
        **stops,
    )
    return Straight(
        outer_diameter=rounded(diameter),
        wall=0.5 * rounded(diameter) if acceptance else float(round(diameter * 0.08, 5)),
        length=length,
        axis="z",
        holders=(holder,),
        drive=rounded(length * rng.uniform(0.35, 0.6)),
        ends=("clamped", "free"),
        **damping(rng),
    )


SHAPES = {"u_tube": u_tube, "spans": spans, "cantilever": cantilever}
