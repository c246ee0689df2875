"""The reference cases run through the public interface, from configuration to checks."""

from pathlib import Path

import numpy as np

from evidence.validation.check import Check
from vibroimpact.config.reading import changed_config, load_config
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.study.cases import all_cases, load_values
from vibroimpact.study.simulation import simulate_cases

from . import cases as reference_cases
from . import flow_in_time
from .flow_stability import stability_checks
from .frequencies import frequency_checks
from .random_stops import StopCase, law_checks, linearisation_check
from .tubes import LAUNCHED_MM, cantilever_checks, launched_beam_checks
from .wear_depth import wear_checks

STEPS = (200_000, 400_000, 800_000, 1_600_000)  # per second, of R3's order
# The position of a contact within a step is random, so that the order from four steps scatters.
ORDER_TOLERANCE = 0.3
ORDER_COLUMNS = ("steps_per_second", "step_s", "contact_time_error_s")
# s0 of the loads of each configuration.
WHITE_SIGMA = {
    "r11_stops_10": (0.5, 1.0, 2.0),
    "r11_stops_100": (1.0, 2.0, 4.0),
    "r11_stops_1000": (1.0,),
    "r11_one_stop": (1.0, 2.0),
}


def run(config) -> list:
    """Return the record datasets of all cases of a configuration."""
    model = build_model(config)
    return [record for _, record in simulate_cases(config, model, all_cases(config.grid))]


def impact_checks(folder: Path) -> tuple[list[Check], list[dict]]:
    """Return (Checks of R1 to R6, rows {steps_per_second, contact_time_error_s} of R3).

    folder: of the reference configurations.
    """
    configs = {
        name: load_config(folder / f"{name}.yaml")
        for name in (
            "r1_friction_slide",
            "r2_launch_on_stop",
            "r3_forced_impact",
            "r4_base_driven",
            "r3_late_impacts",
            "r5_wear",
            "r6_free_vibration",
        )
    }
    checks = reference_cases.slide_checks(run(configs["r1_friction_slide"])[0])
    checks += reference_cases.launch_checks(run(configs["r2_launch_on_stop"])[0])
    checks += reference_cases.base_driven_checks(run(configs["r4_base_driven"])[0])
    wear = configs["r5_wear"]
    checks += reference_cases.wear_checks(run(wear), wear.elements[0].stick_stiffness_N_per_m)
    forced = [
        run(changed_config(configs["r3_forced_impact"], {"integration.steps_per_second": rate}))[0]
        for rate in STEPS
    ]
    checks += reference_cases.forced_impact_checks(forced[-1])
    checks += reference_cases.late_impact_checks(run(configs["r3_late_impacts"])[0])
    checks += reference_cases.free_vibration_checks(run(configs["r6_free_vibration"])[0])
    steps, errors, order = reference_cases.contact_time_order(forced)
    checks.append(
        Check(
            "R3",
            "order of the contact times in the step",
            "1",
            2.0,
            "average acceleration",
            order,
            ORDER_TOLERANCE,
            scale=1.0,
        )
    )
    rows = [
        {"steps_per_second": rate, "step_s": step, "contact_time_error_s": error}
        for rate, step, error in zip(STEPS, steps, errors, strict=True)
    ]
    return checks, rows


def tube_checks(folder: Path) -> list[Check]:
    """Return the Checks of R7 and R8.

    folder: of the reference configurations.
    """
    launched = load_config(folder / "r7_beam_launched.yaml")
    checks = []
    for stiffness in LAUNCHED_MM:
        record = run(changed_config(launched, {"supports.stiffness_N_per_m": stiffness}))[0]
        checks += launched_beam_checks(record, stiffness)
    return checks + cantilever_checks(run(load_config(folder / "r8_cantilever_gaps.yaml"))[0])


def random_stop_checks(folder: Path, name: str) -> list[Check]:
    """Return the Checks of one configuration of R11, a name of WHITE_SIGMA."""
    config = load_config(folder / f"{name}.yaml")
    model = build_model(config)
    omega = 2.0 * np.pi * model.full_mode_frequencies[0]
    support = config.supports[0]
    assert support.gap_m is not None, "the stops of R11 have a gap"
    ratio, sides = support.stiffness_N_per_m / omega**2, len(model.contact_laws.land_normal)
    records = run(config)
    checks = []
    for sigma, load in zip(WHITE_SIGMA[name], load_values(config.grid), strict=True):
        case = StopCase(sigma, ratio, omega, support.gap_m, sides)
        seeds = [record for record in records if record.attrs["load_rms_N"] == load]
        checks += law_checks(seeds, case, model)
        if sides == 2:
            rate = config.integration.steps_per_second
            checks.append(linearisation_check(case, load, rate, model))
    return checks


def flow_checks(folder: Path) -> list[Check]:
    """Return the Checks of F1 to F12: flow and wear.

    folder: of the reference configurations.
    """
    checks = stability_checks(folder) + flow_in_time.eigenvalue_checks(folder)
    checks += flow_in_time.stop_checks(folder) + flow_in_time.friction_checks(folder)
    checks += flow_in_time.damped_stop_checks(folder) + flow_in_time.white_noise_checks(folder)
    return sorted(checks + wear_checks(), key=lambda check: int(check.case[1:]))


def reference_group(group: str, study, folder: Path) -> tuple[list[Check], list[dict]]:
    """Return (Checks, rows of R3's order) of one group of reference cases.

    group: "frequencies", "impacts", "tubes", "flow", or a name of WHITE_SIGMA.
    study: the configuration of the stand-in tube.
    folder: of the reference configurations.
    """
    if group == "frequencies":
        return frequency_checks(study), []
    if group == "impacts":
        return impact_checks(folder)
    if group == "tubes":
        return tube_checks(folder), []
    if group == "flow":
        return flow_checks(folder), []
    return random_stop_checks(folder, group), []
