"""F1 to F3 and F11: effective and critical velocities of tubes, and the factors of TEMA.

F1 is a test of code_aster, F2 has closed forms. F3 rests on formulas from memory, F11 on a
second-hand copy: they check the computation, not the formulas.
"""

from pathlib import Path

import numpy as np

from evidence.validation.check import Check
from vibroimpact.config.reading import changed_config, load_config
from vibroimpact.config.schema import Config
from vibroimpact.flow.along import tube_in_flow
from vibroimpact.flow.critical_velocity import tema_factor
from vibroimpact.flow.stability import StabilityRow, stability

ASTER, EXACT, MEMORY = "code_aster (sdll152a)", "closed form", "closed form, formulas from memory"
TOLERANCE = 2.0e-3
PIECES = 100  # of a parabola of velocity
TUBE_DENSITY, ASTER_DENSITY = 7800.0, 2500.0  # kg/m³: of F1's tube, and of code_aster's m_bar
METAL_AREA, FLUIDS = np.pi * (0.02**2 - 0.015**2), 1000.0 * np.pi * 0.015**2 + 0.8  # m², kg/m
# V_eff over the highest velocity of a pinned tube, by where the flow is.
EFFECTIVE = {
    "half the length": (0.707107, [(0.0, 0.5, 1.0)]),
    "the central half": (0.904605, [(0.25, 0.75, 1.0)]),
    "a parabola": (0.883016, None),
}
TEMA = {(30, 1.25, 0.5): 2.4499, (45, 1.25, 1.0): 3.0975}


def parabola() -> list[tuple[float, float, float]]:
    """Return (begin, end, factor) of pieces of 4 s (1 - s) over 1 m, each with its mean."""
    ends = np.linspace(0.0, 1.0, PIECES + 1)
    area = 2.0 * ends**2 - 4.0 * ends**3 / 3.0
    return list(zip(ends[:-1], ends[1:], np.diff(area) * PIECES, strict=True))


def in_pieces(config: Config, pieces: list[tuple[float, float, float]]) -> StabilityRow:
    """Return the first mode of a straight tube along z with a flow in pieces."""
    stretches = [
        {"from_m": [0.0, 0.0, begin], "to_m": [0.0, 0.0, end], "velocity_factor": factor}
        for begin, end, factor in pieces
    ]
    return stability(changed_config(config, {"flow.stretches": stretches})).rows[0]


def clamped_checks(folder: Path) -> list[Check]:
    """Return the Checks of F1; folder: of the reference configurations.

    code_aster's m_bar has a tube of 2500 kg/m³, the modes one of 7800 kg/m³. The ratio with all
    components has the generalised mass in V_eff, and m_bar as above.
    """
    row = in_pieces(load_config(folder / "f1_clamped_in_parabola.yaml"), parabola())
    share = (ASTER_DENSITY * METAL_AREA + FLUIDS) / (TUBE_DENSITY * METAL_AREA + FLUIDS)
    critical = row.critical_low * np.sqrt(share)
    general = np.sqrt(share) * row.effective / critical
    name, wide = "V_eff / V_c with the generalised mass", f"{ASTER}, 0.35 % off, not explained"
    return [
        Check("F1", "critical velocity", "m/s", 4.566805, ASTER, critical, TOLERANCE),
        Check("F1", "V_eff / V_c", "1", 0.200887, ASTER, row.effective / critical, TOLERANCE),
        Check("F1", name, "1", 0.142146, wide, general, 2.0 * TOLERANCE),
    ]


def effective_checks(folder: Path) -> list[Check]:
    """Return the Checks of F2; folder: of the reference configurations."""
    config = load_config(folder / "f2_pinned_in_flow.yaml")
    return [
        Check(
            "F2",
            f"V_eff over the highest velocity, {name}",
            "1",
            expected,
            EXACT,
            in_pieces(config, pieces or parabola()).effective,
            TOLERANCE,
        )
        for name, (expected, pieces) in EFFECTIVE.items()
    ]


def two_phase_checks(folder: Path) -> list[Check]:
    """Return the Checks of F3; folder: of the reference configurations."""
    config = load_config(folder / "f3_two_phase_bundle.yaml")
    row = stability(config).rows[0]
    without = config.model_dump(mode="json")["structure"]["fluid"]
    without[1]["two_phase_damping"] = None
    changes = {"structure.fluid": without, "damping.other_ratio": 0.01}
    stated = stability(changed_config(config, changes)).rows[0]
    without[1] |= {"mixture": None, "density_kg_per_m3": 750.0}
    liquid = stability(changed_config(config, {"structure.fluid": without})).rows[0]
    assert config.flow is not None, "F3 has a flow"
    mass = float(tube_in_flow(config, config.flow).along.mass.mean())
    values = (
        ("mass per length", "kg/m", 0.980691, EXACT, mass),
        ("first frequency", "Hz", 49.4310, EXACT, row.frequency),
        ("first frequency, liquid only", "Hz", 43.1298, EXACT, liquid.frequency),
        ("damping ratio of two phases", "1", 0.01047, MEMORY, row.damping_ratio),
        ("critical velocity at 1 %, K 3", "m/s", 3.1031, EXACT, stated.critical_high),
        ("critical velocity at 1 %, K 2.4", "m/s", 2.4825, EXACT, stated.critical_low),
    )
    return [
        Check("F3", name, unit, expected, source, ours, TOLERANCE)
        for name, unit, expected, source, ours in values
    ]


def tema_checks() -> list[Check]:
    """Return the Checks of F11."""
    return [
        Check(
            "F11",
            f"factor of TEMA, {pattern} deg, P/D {pitch:g}, X {damped:g}",
            "1",
            expected,
            "second-hand",
            tema_factor(pattern, pitch, damped),
            TOLERANCE,
        )
        for (pattern, pitch, damped), expected in TEMA.items()
    ]


def stability_checks(folder: Path) -> list[Check]:
    """Return the Checks of F1 to F3 and F11; folder: of the reference configurations."""
    checks = clamped_checks(folder) + effective_checks(folder)
    return checks + two_phase_checks(folder) + tema_checks()
