"""The impacting tube against OpenSees: displacement and contact force at every step.

Tube, force, gaps, damping and step are the same. Across its plane the tube meets |y| = gap on both
sides at ten points. OpenSees integrates all degrees of freedom with Newmark's average acceleration
and solves each step with Newton; the project integrates a reduced basis with a recurrence and a
fixed-point iteration. Both use the same Rayleigh coefficients, because OpenSees has no counterpart
of modal damping in a reduced basis. With all modes in the basis the two solve the same equations.
"""

from dataclasses import dataclass

import numpy as np

from evidence.validation.check import Check
from vibroimpact.config.reading import changed_config
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.integration.every_step import integrate_every_step
from vibroimpact.integration.kernel_layout import FIXED_POINT_TOLERANCE
from vibroimpact.reduction.reduced_model import build_model

from .opensees import opensees_impacts

RUN = {
    "integration.scheme": "newmark",
    "integration.steps_per_second": 51200,
    "structure.mesh.elements_per_span": 10,
    "structure.mesh.elements_per_bend": 40,
    "damping": {
        "kind": "rayleigh",
        "mass_coefficient_per_s": 1.0,
        "stiffness_coefficient_s": 2.0e-6,
    },
}
LOAD_RMS_N, BAND_HZ, SEED = 20.0, (5.0, 200.0), 3
RAMP_S = 0.005  # the force rises from zero, so that the initial acceleration is zero
HORIZON_S, MESH_HORIZON_S = 0.1, 0.05
MODES_TO_HZ = (2000.0, 4000.0, 7500.0, 15000.0, 1.0e9)  # the last: all modes
BEND_ELEMENTS, FINEST_BEND = (10, 20, 40, 80), 160
ACROSS = 1  # of the two contact directions of a leg: y
# The error of a truncated basis is estimated by our own change to the complete basis; twice it is
# allowed. Impacts amplify the residual of the contact iteration in each step (1e-4 of the force,
# times its contraction): it may grow back to 1e-4.
TRUNCATION_SAFETY = 2.0
MESH_ORDER, MESH_ORDER_TOLERANCE = 2.0, 0.3


@dataclass(frozen=True)
class Impacts:
    """Motion and contact force across the plane of the tube.

    time (step,): s.
    displacement, force (contact_point, step): m, and N on the tube.
    """

    time: np.ndarray
    displacement: np.ndarray
    force: np.ndarray


def impact_force(steps_per_second, horizon_s, load_rms=LOAD_RMS_N):
    """Return (step,) N: band-limited noise of about load_rms N, zero at first."""
    steps = 20 * round(horizon_s * steps_per_second / 20.0)
    noise = load_rms * band_limited_noise(
        np.random.default_rng(SEED), steps + 1, steps_per_second, BAND_HZ
    )
    return noise * -np.expm1(-((np.arange(steps + 1) / (RAMP_S * steps_per_second)) ** 2))


def impact_config(config, values=None):
    """Return the configuration of the comparison.

    It has few elements, Rayleigh damping, and the drive exactly at the 45 degree node.
    """
    tube = config.structure
    at = tube.bend_radius_m * np.sqrt(0.5)
    drive = (-at, 0.0, tube.leg_length_m + at)
    return changed_config(
        config,
        {**RUN, f"points.{config.excitation.point}": list(map(float, drive)), **(values or {})},
    )


def our_impacts(config, force, gap, free_modes_to_Hz):
    """Return the Impacts of the project.

    free_modes_to_Hz: highest frequency of the basis; it may exceed the limit that the
    configuration puts on omega step.
    """
    basis = config.basis.model_copy(update={"free_modes_to_Hz": free_modes_to_Hz})
    model = build_model(config.model_copy(update={"basis": basis}))
    rate, steps = config.integration.steps_per_second, len(force) - 1
    padded = np.append(force, np.zeros(40))[:, None, None]
    traces = integrate_every_step(
        model,
        rate,
        steps,
        np.array([gap]),
        np.zeros((len(model.support_of_point), 2, 1)),
        lambda first, count: padded[first : first + count],
    )
    across = (0, slice(None), ACROSS, slice(0, steps + 1))
    return Impacts(
        traces.time[: steps + 1], traces.contact_displacement[across], traces.contact_force[across]
    )


def judged_impacts(config, force, gap, refinement=1):
    """Return the Impacts of OpenSees. Raises JudgeAbsent."""
    rate = config.integration.steps_per_second
    displacement, pushed = opensees_impacts(config, force, rate, gap, refinement)
    return Impacts(np.arange(len(force)) / rate, displacement, pushed)


def apart(ours, judge):
    """Return {quantity: relative difference from the judge}.

    Quantities: largest displacement difference, RMS and peak of the contact forces.
    """
    return {
        "displacement": float(
            np.abs(ours.displacement - judge.displacement).max() / np.abs(judge.displacement).max()
        ),
        "contact force": float(
            np.linalg.norm(ours.force - judge.force) / np.linalg.norm(judge.force)
        ),
        "peak contact force": float(
            abs(np.abs(ours.force).max() / np.abs(judge.force).max() - 1.0)
        ),
    }


def impacts_of(force):
    """Return the number of impacts: how often a force (contact_point, step) begins."""
    return int(np.sum((force[:, 1:] != 0.0) & (force[:, :-1] == 0.0)))


def modes_rows(config, horizon_s=HORIZON_S, modes_to_Hz=MODES_TO_HZ):
    """Return (rows, {name: Impacts}): ours against OpenSees on the same nodes, one row per basis.

    The last basis is complete. Row keys: free_modes_to_Hz, quantity, difference (from OpenSees),
    own_difference (from ours with all modes), impacts. Raises JudgeAbsent.
    """
    run, gap = impact_config(config), min(config.grid.gap_m)
    force = impact_force(run.integration.steps_per_second, horizon_s)
    judge = judged_impacts(run, force, gap)
    ours = {kept: our_impacts(run, force, gap, kept) for kept in modes_to_Hz}
    complete = ours[modes_to_Hz[-1]]
    rows = [
        {
            "free_modes_to_Hz": kept,
            "quantity": quantity,
            "difference": difference,
            "own_difference": apart(found, complete)[quantity],
            "impacts": impacts_of(judge.force),
        }
        for kept, found in ours.items()
        for quantity, difference in apart(found, judge).items()
    ]
    kept = min(modes_to_Hz, key=lambda hertz: abs(hertz - config.basis.free_modes_to_Hz))
    return rows, {"OpenSees": judge, "ours": ours[kept]}


def mesh_rows(config, horizon_s=MESH_HORIZON_S, bends=BEND_ELEMENTS, finest=FINEST_BEND):
    """Return rows of ours on coarser bends against OpenSees on the finest.

    Row keys: elements_per_bend, quantity, difference. Raises JudgeAbsent.
    """
    fine = impact_config(config, {"structure.mesh.elements_per_bend": finest})
    gap = min(config.grid.gap_m)
    force = impact_force(fine.integration.steps_per_second, horizon_s)
    judge = judged_impacts(fine, force, gap)
    rows = []
    for count in bends:
        ours = our_impacts(
            impact_config(config, {"structure.mesh.elements_per_bend": count}),
            force,
            gap,
            config.basis.free_modes_to_Hz,
        )
        rows += [
            {"elements_per_bend": count, "quantity": quantity, "difference": difference}
            for quantity, difference in apart(ours, judge).items()
        ]
    return rows


def modes_checks(rows) -> list[Check]:
    """Return the Checks of `modes_rows`.

    Differences must be explained by the truncation of our basis and by the contact iteration.
    """
    names = {rows[-1]["free_modes_to_Hz"]: "all modes"}
    return [
        Check(
            "judge OpenSees",
            f"{row['impacts']} impacts, {row['quantity']}, "
            + names.get(row["free_modes_to_Hz"], f"free modes to {row['free_modes_to_Hz']:g} Hz"),
            "1",
            0.0,
            "OpenSees, same nodes and step",
            row["difference"],
            TRUNCATION_SAFETY * row["own_difference"] + FIXED_POINT_TOLERANCE,
            scale=1.0,
        )
        for row in rows
    ]


def mesh_checks(rows) -> list[Check]:
    """Return the Check of the order of convergence to OpenSees on the finest bend.

    Chords are shorter than arcs by angle²/24.
    """
    own = [row for row in rows if row["quantity"] == "displacement"]
    # The finest mesh has an error too: with order 2 the difference is (1/n² - 1/finest²).
    size = np.log([row["elements_per_bend"] ** -2.0 - FINEST_BEND**-2.0 for row in own[1:]])
    order = MESH_ORDER * float(
        np.polyfit(size, np.log([row["difference"] for row in own[1:]]), 1)[0]
    )
    return [
        Check(
            "judge OpenSees",
            "impacts, order of the displacement's difference in the bend's elements",
            "1",
            MESH_ORDER,
            f"OpenSees, {FINEST_BEND} elements per bend",
            order,
            MESH_ORDER_TOLERANCE,
            scale=1.0,
        )
    ]
