"""Claims on the equivalent support: agreement of the methods, gap and load, the model's needs."""

import numpy as np

from evidence.validation.study_curves import STIFFNESS
from vibroimpact.config.reading import changed_config
from vibroimpact.identify.linear.modes import natural_frequencies
from vibroimpact.reduction.reduced_model import build_model

from .claim import AGREE, Claim, graded

STIFFNESS_RANGE = (1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6, 4e6, 1e7, 1e8, 1e9)  # N/m per support
# N/m per support: the contact's own stiffness, an upper bound of the equivalent one.
OWN = 4.0e6
POINTS, LAYER_POINTS = (1, 2, 3, 5), 33
ACCURATE = 0.01  # of a frequency
MODES = 4
FINE = 2.0  # standard errors: smaller changes by a finer step or larger basis are not significant


def three_stiffnesses(curves, model):
    """Return the Claim that pole, shape and broadband PSD give the same stiffness."""
    points = {}
    for row in curves.summary:
        if row["method"] in STIFFNESS:
            points.setdefault((row["gap_m"], row["load_rms_N"]), {})[row["method"]] = row[
                "k_median"
            ]
    resolved = {
        point: values
        for point, values in points.items()
        if len(values) == len(STIFFNESS) and np.isfinite(list(values.values())).all()
    }
    factor = {
        point: max(values.values()) / min(values.values()) for point, values in resolved.items()
    }
    agree = [
        max(abs(value / np.median(list(values.values())) - 1.0) for value in values.values())
        <= AGREE
        for values in resolved.values()
    ]
    share = float(np.mean(agree)) if agree else 0.0
    worst = max(factor, key=factor.get, default=None)
    apart = (
        f"largest factor {factor[worst]:.2f} at {worst[1]:.3g} N, gap {1e3 * worst[0]:.3g} mm"
        if worst
        else "none resolved by all three"
    )
    return Claim(
        "the three stiffnesses agree",
        "4.4",
        "LSCF pole, deflection shape and broadband PSD, medians over seeds, every gap and load",
        f"{sum(agree)} of {len(agree)} points where all three resolve k; {apart}",
        f"within {100 * AGREE:g} % of their median",
        graded(share == 1.0 and len(agree) > 0, share >= 0.75),
        f"{len(points) - len(resolved)} of {len(points)} points are unresolved: nearer to the free"
        " tube no reading can tell k",
    )


def gap_reduction(curves, model):
    """Return the Claim that a smaller gap acts as a larger load.

    The measure is the ratio of k of different gaps at equal load/gap.
    """
    ratio = np.array(
        [row["k_ratio"] for row in curves.collapse if row["method"] in STIFFNESS], dtype=float
    )
    limit = 1.0 + AGREE
    return Claim(
        "gap reduction acts as load increase",
        "5",
        "largest over smallest k among the gaps at equal load/gap",
        f"median {np.median(ratio):.3f}, worst {ratio.max():.2f} over {ratio.size} places",
        f"{limit:g}",
        graded(ratio.max() <= limit, np.median(ratio) <= limit),
        "the model is homogeneous of degree one, so that only load/gap counts: the ratio is the"
        " scatter of the seeds and of the interpolation",
    )


def five_points(config):
    """Return the Claim that five contact points per plate suffice for all support stiffnesses."""
    shares = np.ones(LAYER_POINTS)
    shares[[0, -1]] = 0.5  # trapezoidal: the layer's own integral
    layer = _frequencies(
        changed_config(
            config,
            {
                "supports.points": LAYER_POINTS,
                "supports.stiffness_N_per_m": (OWN * shares / shares.sum()).tolist(),
            },
        )
    )
    error = {
        points: (
            np.abs(
                _frequencies(
                    changed_config(
                        config, {"supports.points": points, "supports.stiffness_N_per_m": OWN}
                    )
                )
                / layer
                - 1.0
            ).max(axis=1)
        )
        for points in POINTS
    }
    reached = {
        points: float(values[np.array(STIFFNESS_RANGE) <= OWN].max())
        for points, values in error.items()
    }
    return Claim(
        "five points per plate suffice",
        "2.2",
        f"first {MODES} frequencies, worst distance from a continuous layer ({LAYER_POINTS}"
        f" points), up to k = {OWN:.0e} and to 1e9 N/m",
        "; ".join(
            f"{points}: {100 * reached[points]:.2f} and {100 * values.max():.2f} %"
            for points, values in error.items()
        ),
        f"{100 * ACCURATE:g} % with five",
        graded(bool(error[5].max() <= ACCURATE), reached[5] <= ACCURATE),
        "one point never clamps; five equal points with both edges included are a little too stiff"
        " towards clamping",
    )


def _frequencies(config):
    model = build_model(config)
    return np.array([natural_frequencies(model, k, MODES) for k in STIFFNESS_RANGE])


def theories(config):
    """Return the Claim that Euler-Bernoulli and Timoshenko beams differ little."""
    tables = [
        _frequencies(changed_config(config, {"structure.theory": theory}))
        for theory in ("euler_bernoulli", "timoshenko")
    ]
    difference = np.abs(tables[0] / tables[1] - 1.0)
    reached = difference[np.array(STIFFNESS_RANGE) <= OWN]
    return Claim(
        "Euler and Timoshenko differ little",
        "2.1",
        f"first {MODES} frequencies from k = 1 to 1e9 N/m",
        f"worst {100 * difference.max():.2f} % (k ="
        f" {STIFFNESS_RANGE[int(np.argmax(difference.max(axis=1)))]:.0e} N/m),"
        f" {100 * reached.max():.2f} % up to k = {OWN:.0e} N/m",
        f"{100 * ACCURATE:g} %",
        graded(difference.max() <= ACCURATE, reached.max() <= ACCURATE),
        "the tube is slender between the plates; within a plate the contact points are a third of a"
        " diameter apart, and once they clamp, shear counts",
    )


def step(rows):
    """Return the Claim that a step of 2e-5 s is small enough.

    rows: runs with different steps, of convergence.runs.run_rows.
    """
    return _along(
        rows,
        "2e-5 s is small enough",
        "2.3",
        51200,
        max(row["value"] for row in rows),
        "1/51200 s beside the finest step",
    )


def basis(rows, quality):
    """Return the Claim that a larger basis matters least.

    rows: runs with different numbers of modes. quality: rows of basis_quality.csv.
    """
    worst = {}
    for row in quality:
        if row["relative_error"] == row["relative_error"]:
            worst[row["vectors"]] = max(worst.get(row["vectors"], 0.0), abs(row["relative_error"]))
    lost = {
        "free modes cut to a tenth": worst["free_modes to a tenth"],
        "no constrained modes": worst["without constrained_modes"],
        "no attachment shapes": worst["without attachment_shapes"],
    }
    changes = _changes(rows, 7500.0, max(row["value"] for row in rows))
    least = lost["free modes cut to a tenth"] <= min(
        lost["no attachment shapes"], max(lost["no constrained modes"], 1e-12)
    )
    calm = np.mean(np.abs(list(changes.values())) <= FINE) >= 0.9
    return Claim(
        "widening the basis matters least",
        "2.3",
        "worst frequency error below 400 Hz, k = 1 to 1e9 N/m; and response statistics with more"
        " free modes",
        "; ".join(f"{name} {value:.1e}" for name, value in lost.items())
        + f"; statistics with 12 kHz of modes: {_beyond(changes)}",
        "cutting the free modes loses less than leaving out either other family",
        graded(least and calm, lost["free modes cut to a tenth"] < lost["no attachment shapes"]),
        f"free modes alone lose {worst['free_modes alone']:.1e}: attachment shapes carry the local"
        " flexibility that they lack; beside both, the constrained modes add next to nothing here",
    )


def _along(rows, claim, section, value, finest, measure):
    changes = _changes(rows, value, finest)
    residual = np.mean([row["potential_energy_residual"] for row in rows if row["value"] == value])
    inside = np.mean(np.abs(list(changes.values())) <= FINE)
    largest = max(_relative(rows, value, finest).items(), key=lambda item: item[1])
    return Claim(
        claim,
        section,
        f"response statistics at {measure}, two loads, change over its standard error over seeds",
        f"{_beyond(changes)}; largest change {100 * largest[1]:.1f} % ({largest[0]}); energy error"
        f" {residual:.1e} of the input work",
        f"90 % of the statistics within {FINE:g} standard errors",
        graded(inside >= 0.9, inside >= 0.7),
        (
            "what moves beyond the scatter moves by a few per cent at most"
            if largest[1] < 0.05
            else f"{largest[0]} moves by {100 * largest[1]:.0f} %"
        ),
    )


def _beyond(changes):
    outside = [name for name, value in changes.items() if abs(value) > FINE]
    return f"{len(changes) - len(outside)} of {len(changes)} unchanged" + (
        f", not {', '.join(outside)}" if outside else ""
    )


STATISTICS = (
    "rms_displacement_apex.y_m",
    "rms_displacement_bend_45.y_m",
    "rms_force_N",
    "contact_fraction",
    "impact_rate_per_s",
    "rms_stress_root_Pa",
    "rms_stress_support_Pa",
    "band_5_20_dB",
    "band_20_40_dB",
    "band_40_80_dB",
    "band_80_200_dB",
)


def _pairs(rows, value, finest):
    for load in sorted({row["load_rms_N"] for row in rows}):
        for name in STATISTICS:
            pair = [
                np.array(
                    [
                        row[name]
                        for row in rows
                        if row["value"] == level and row["load_rms_N"] == load
                    ]
                )
                for level in (value, finest)
            ]
            yield f"{name} at {load:g} N", pair


def _changes(rows, value, finest):
    """Return {statistic: change of the mean over its standard error}."""
    return {
        name: float(
            (one.mean() - other.mean())
            / np.sqrt(one.var(ddof=1) / one.size + other.var(ddof=1) / other.size)
        )
        for name, (one, other) in _pairs(rows, value, finest)
    }


def _relative(rows, value, finest):
    return {
        name: float(abs(one.mean() / other.mean() - 1.0))
        for name, (one, other) in _pairs(rows, value, finest)
        if not name.endswith("dB")
    }
