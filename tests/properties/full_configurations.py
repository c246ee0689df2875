"""Small configurations that together state every number that a configuration may hold."""

import copy

OBLIQUE = [0.3, 1.0, 0.0]
TUBE = {
    "outer_diameter_m": 0.02222,
    "wall_thickness_m": 0.00127,
    "shear_coefficient": 0.53,
}
SECTIONS = {
    "round": {"kind": "round", "diameter_m": 0.02, "shear_coefficient": 0.9},
    "rectangle": {
        "kind": "rectangle",
        "sides_m": [0.01, 0.02],
        "first_axis": [0.0, 1.0, 0.4],
        "shear_coefficient": 0.85,
    },
    "general": {
        "kind": "general",
        "area_m2": 4.0e-4,
        "second_moments_m4": [3.33e-9, 5.33e-8],
        "torsion_constant_m4": 1.12e-8,
        "shear_coefficients": [0.8, 0.7],
        "outer_fibres_m": [0.005, 0.02],
        "first_axis": [0.0, 1.0, 0.4],
        "enclosed_area_m2": 5.0e-4,
    },
}
SUPPORT = {"at_m": [0.5, 0.0, 0.0], "height_m": 0.03, "points": 3, "stiffness_N_per_m": 4.0e5}
BASE = {
    "study": "full",
    "seed": 7,
    "structure": {
        "kind": "path",
        "section": TUBE,
        "material": {
            "young_modulus_Pa": 2.0e11,
            "poisson_ratio": 0.3,
            "density_kg_per_m3": 8000.0,
        },
        "fluid": [
            {
                "kind": "inside",
                "density_kg_per_m3": 740.0,
                "from_m": [0.2, 0.0, 0.0],
                "to_m": [0.8, 0.0, 0.0],
            },
            {
                "kind": "outside",
                "density_kg_per_m3": 700.0,
                "viscosity_Pa_s": 9.0e-5,
                "from_m": [0.3, 0.0, 0.0],
                "to_m": [0.7, 0.0, 0.0],
                "confinement": {"kind": "bundle", "pitch_m": 0.04, "pattern": "square"},
            },
        ],
        "start_m": [0.01, 0.002, 0.001],
        "start_direction": [1.0, 0.001, 0.001],
        "segments": [
            {"kind": "straight", "length_m": 1.0},
            {"kind": "bend", "radius_m": 0.2, "angle_deg": 90.0, "toward": [0.1, 0.2, 1.0]},
        ],
        "mesh": {"elements_per_span": 4, "elements_per_bend": 5},
        "start": {"kind": "springs", "translation_N_per_m": 1e7, "rotation_N_m_per_rad": 1e4},
        "end": {"kind": "springs", "translation_N_per_m": 1e6, "rotation_N_m_per_rad": 1e3},
    },
    "damping": {
        "kind": "modal",
        "first_ratios": [0.01, 0.02],
        "other_ratio": 0.003,
        "mass_coefficient_per_s": 0.5,
    },
    "supports": [
        {
            "name": "laws",
            **SUPPORT,
            "gap_factor": 1.1,
            "centre_offset_m": [1e-5, 2e-5],
            "damping_N_s_per_m": 5.0,
            "hunt_crossley_s_per_m": 0.4,
            "friction": 0.2,
            "stick_stiffness_ratio": 0.8,
            "plate": {"mass_kg": 2.0, "stiffness_N_per_m": 1e7, "damping_ratio": 0.02},
        },
        {
            "name": "hertz",
            **SUPPORT,
            "at_m": [0.8, 0.0, 0.0],
            "gap_m": 2e-4,
            "hertz_N_per_m15": 1e8,
            "friction": 0.1,
        },
    ],
    "elements": [
        {
            "name": "one",
            "point": "drive",
            "direction": OBLIQUE,
            "stiffness_N_per_m": 1e3,
            "quadratic_N_per_m2": 1e5,
            "cubic_N_per_m3": 1e9,
            "damping_N_s_per_m": 2.0,
            "damping_limit_N": 2.0,
            "drag_N_s2_per_m2": 3.0,
            "drag_partner": "two",
        },
        {
            "name": "two",
            "point": "drive",
            "direction": [0.0, 0.3, 1.0],
            "slip_limit_N": 2.0,
            "stick_stiffness_N_per_m": 1e4,
            "saturation_stiffness_N_per_m": 1e4,
            "saturation_limit_N": 3.0,
        },
    ],
    "masses": [{"name": "box", "point": "tip", "mass_kg": 0.05}],
    "mode_frequency_factors": [1.02, 0.99],
    "points": {"drive": [0.35, 0.0, 0.0], "tip": [0.9, 0.0, 0.0]},
    "excitation": {
        "kind": "band_limited",
        "point": "drive",
        "direction": OBLIQUE,
        "turn_deg": 3.0,
        "factor": 0.8,
        "band_Hz": [20.0, 80.0],
        "also": [{"point": "tip", "direction": OBLIQUE, "factor": 0.5}],
        "distributed": [
            {
                "from_m": [0.4, 0.0, 0.0],
                "to_m": [0.45, 0.0, 0.0],
                "direction": OBLIQUE,
                "factor_per_m": 2.0,
            }
        ],
        "constant": [{"point": "tip", "direction": OBLIQUE, "force_N": 2.0}],
    },
    "basis": {"free_modes_to_Hz": 600.0, "constrained_modes_to_Hz": 600.0},
    "integration": {
        "scheme": "newmark",
        "steps_per_second": 10240,
        "start_up_s": 1.0,
        "imperfection": 1e-5,
    },
    "grid": {"load_rms_N": {"first": 1.0, "last": 4.0, "count": 3}, "gap_m": [1e-4], "seeds": 2},
    "record": {
        "duration_s": 8.0,
        "sampling_frequency_Hz": 512,
        "stress_limit_Pa": 2e8,
        "sensors": {"points": ["tip", "drive"], "directions": ["y", "z"]},
        "shape_line": {"points": 5},
    },
    "spectra": {"segment_s": 2.0, "overlap": 0.5},
    "identification": {
        "response_point": "tip",
        "peak_search_Hz": [22.0, 70.0],
        "lscf": {"band_Hz": [21.0, 78.0], "max_order": 12, "references": ["tip"]},
        "broadband": {"point": "drive", "band_Hz": [21.0, 79.0]},
        "stiffness_range_N_per_m": [1e3, 1e8],
    },
    "overlay": {"load_rms_N": [2.0], "gap_ratio": 1.05, "noise": 0.02, "seed": 500},
}
CHAIN = {
    "study": "chain",
    "structure": {
        "kind": "chain",
        "masses": [{"name": "a", "mass_kg": 1.0}, {"name": "b", "mass_kg": 2.0}],
        "springs": [
            {"between": ["ground", "a"], "stiffness_N_per_m": 2e4, "damping_N_s_per_m": 3.0},
            {"between": ["a", "b"], "stiffness_N_per_m": 1e4, "damping_N_s_per_m": 2.0},
        ],
    },
    "damping": {"kind": "modal", "first_ratios": [0.01], "other_ratio": 0.02},
    "supports": [{"name": "stop", "point": "b", "stiffness_N_per_m": 1e5, "gap_m": 2e-4}],
    "initial": {"displacement_m": {"a": {"x": 1e-3}}, "velocity_m_per_s": {"b": {"x": 0.1}}},
    "excitation": {"kind": "harmonic", "point": "a", "direction": [1.0, 0.0, 0.0],
                   "frequency_Hz": 15.0, "phase_deg": 30.0},
    "grid": {"load_rms_N": [1.0, 2.0], "gap_m": [1e-3], "seeds": 2},
    "record": {"duration_s": 4.0, "sampling_frequency_Hz": 512},
    "integration": {"steps_per_second": 10240, "start_up_s": 1.0},
}  # fmt: skip
MODES = [
    {"frequency_Hz": 10.0, "damping_ratio": 0.02, "shape": {"a": {"x": 0.5}, "b": {"x": 0.4}}},
    {"frequency_Hz": 25.0, "damping_ratio": 0.01, "shape": {"a": {"x": 0.3}, "b": {"x": -0.6}}},
]
FLOW = {
    "direction": OBLIQUE, "correlation_length_m": 0.1, "band_Hz": [20.0, 80.0], "tolerance": 0.05,
    "stretches": [
        {"from_m": [0.2, 0.0, 0.0], "to_m": [0.4, 0.0, 0.0], "factor": 0.5},
        {"from_m": [0.5, 0.0, 0.0], "to_m": [0.9, 0.0, 0.0], "factor": 1.0},
    ],
}  # fmt: skip
SPECTRA = {
    "table": {"frequency_Hz": [5.0, 50.0, 200.0], "psd_N2_per_m2_Hz": [1e-2, 1e-3, 1e-5]},
    "tube_bundle": {"velocity_m_per_s": 2.0, "fluid_density_kg_per_m3": 700.0},
    "two_phase": {
        "void_fraction": 0.8, "velocity_m_per_s": 3.0, "fluid_density_kg_per_m3": 180.0,
    },
    "reduced_table": {
        "reduced_frequency": [0.01, 0.3, 3.0], "reduced_psd": [1e-2, 1e-3, 1e-5],
        "velocity_m_per_s": 2.0, "fluid_density_kg_per_m3": 700.0,
    },
}  # fmt: skip
ACTING = {
    "velocity_m_per_s": [1.0],
    "acting_m_per_s": 1.5,
    "density_kg_per_m3": 700.0,
    "direction": OBLIQUE,
    "stretches": [
        {"from_m": [0.1, 0.0, 0.0], "to_m": [0.35, 0.0, 0.0], "velocity_factor": 0.5},
        {"from_m": [0.35, 0.0, 0.0], "to_m": [0.6, 0.0, 0.0], "density_kg_per_m3": 300.0},
    ],
    "criterion": {"kind": "connors", "constant": [3.0]},
}
COUPLINGS = {
    "lags": {
        "stiffness": 20.0,
        "damping": 0.3,
        "amplitudes": [-20.0],
        "rates": [1.1],
        "reduced_velocity": [2.0, 50.0],
    },
    "quasi_steady": {"lift_slope": -20.0, "drag": 0.3, "delay": 0.8},
    "connors": {"constant": 3.0, "band_Hz": [5.0, 200.0]},
    "negative_damping": {"constant": 3.0, "frequency_Hz": 30.0},
}
PROFILES = {
    "planes": {"normals_deg": [10.0, 170.0], "extra_gap_m": [1.0e-4, 2.0e-4]},
    "lobes": {"count": 3, "depth_m": 1e-3, "angle_deg": 20.0},
    "broached": {"lands": 3, "angle_deg": 20.0, "depth_m": 1e-3},
    "broached by normal": {"lands": 3, "normal": [0.0, 1.0, 0.3]},
    "bars": {"angle_deg": 20.0},
    "bars by normal": {"normal": [0.0, 1.0, 0.3]},
    "lattice": {"angle_deg": 20.0, "spacing_m": 0.05},
    "lattice by normal": {"normal": [0.0, 1.0, 0.3]},
}
MIXTURE = {
    "void_fraction": 0.3,
    "liquid_density_kg_per_m3": 750.0,
    "vapour_density_kg_per_m3": 33.0,
}
NO_FIT = {"identification": None}


def changed(base, **sections):
    """A configuration with other sections; a dotted name, with __ for a dot, changes one key."""
    made = copy.deepcopy(base)
    for name, value in sections.items():
        *parts, last = [int(part) if part.isdigit() else part for part in name.split("__")]
        level = made
        for part in parts:
            level = level[part]
        level[last] = copy.deepcopy(value)
    return made


def _configurations():
    """Yield (name, configuration)."""
    yield "path", BASE
    yield (
        "rayleigh",
        changed(
            BASE,
            damping={
                "kind": "rayleigh",
                "mass_coefficient_per_s": 0.5,
                "stiffness_coefficient_s": 1e-6,
            },
        ),
    )
    for name, section in SECTIONS.items():
        fluid = [
            {"kind": "outside", "density_kg_per_m3": 700.0, "to_m": [0.7, 0.0, 0.0],
             "confinement": {"kind": "coefficient", "added_mass_coefficient": 1.2}},
        ]  # fmt: skip
        yield name, changed(BASE, structure__section=section, structure__fluid=fluid)
    yield (
        "annulus",
        changed(
            BASE,
            structure__fluid__1__confinement={"kind": "annulus", "equivalent_diameter_m": 0.05},
        ),
    )
    yield "named", changed(
        BASE,
        structure__material={"name": "inconel_690", "temperature_C": 200.0},
        structure__fluid=[
            {"kind": "inside", "name": "water", "temperature_C": 200.0},
            {"kind": "outside", "name": "water", "temperature_C": 220.0,
             "confinement": {"kind": "bundle", "pitch_m": 0.04, "pattern": "square"}},
        ],
    )  # fmt: skip
    yield "u_tube", changed(
        BASE,
        structure={
            "kind": "u_tube", "section": TUBE, "material": BASE["structure"]["material"],
            "leg_length_m": 0.7, "bend_radius_m": 0.3,
            "mesh": {"elements_per_span": 4, "elements_per_bend": 5},
            "root": {"kind": "springs", "translation_N_per_m": 1e7, "rotation_N_m_per_rad": 1e4},
        },
        supports=[{"name": "bend", **SUPPORT, "at_m": [-0.2121, 0.0, 0.9121]}],
        elements=[], points={"drive": [-0.15, 0.0, 0.9598], "tip": [0.15, 0.0, 0.9598]},
        excitation={"kind": "white_noise", "point": "drive", "direction": OBLIQUE,
                    "turn_deg": 3.0, "factor": 0.8},
        record__sensors={"points": ["tip", "drive"], "directions": ["x", "y"]},
        **NO_FIT,
    )  # fmt: skip
    for name, profile in PROFILES.items():
        yield (
            name,
            changed(BASE, supports__0__profile={"kind": name.split()[0], **profile}, elements=[]),
        )
    yield "preload", changed(
        BASE,
        supports=[{"name": "bars", **SUPPORT, "preload_N": 2.0,
                   "profile": {"kind": "bars", "angle_deg": 0.0}}],
    )  # fmt: skip
    for kind, unit in (("displacement", "m"), ("velocity", "m_per_s")):
        amount = f"{kind}_{unit}"
        turn = "rotation_rad" if kind == "displacement" else "rotation_rad_per_s"
        fields = (
            {"kind": "rigid", f"translation_{unit}": [1e-4, 2e-4, 3e-4],
             turn: [1e-3, 2e-3, 3e-3], "about_m": [0.1, 0.2, 0.3]},
            {"kind": "mode", "number": 1, "point": "tip", "direction": "y",
             f"amplitude_{unit}": 1e-4},
            {"kind": "places",
             "values": [{"at_m": [0.011, 0.002, 0.001], amount: [1e-4, 2e-4, 1e-4]},
                        {"at_m": [0.5, 0.002, 0.001], amount: [1e-4, 3e-4, 1e-4]},
                        {"at_m": END, amount: [1e-4, 2e-4, 2e-4]}]},
        )  # fmt: skip
        for field in fields:
            yield (
                f"{kind} {field['kind']}",
                changed(
                    BASE,
                    initial={kind: field},
                    basis__free_modes_to_Hz=4000.0,
                    integration__steps_per_second=40960,
                ),
            )
    for kind, spectrum in SPECTRA.items():
        force = {"kind": "turbulence", **FLOW, "spectrum": {"kind": kind, **spectrum}}
        yield kind, changed(BASE, excitation=force, **NO_FIT)
    for kind, coupling in COUPLINGS.items():
        flow = ACTING | {"coupling": {"kind": kind, **coupling}}
        if kind != "lags":
            del flow["stretches"]
        yield f"flow {kind}", changed(BASE, flow=flow)
    outside = {
        "kind": "outside",
        "viscosity_Pa_s": 9.0e-5,
        "confinement": {"kind": "annulus", "equivalent_diameter_m": 0.05},
        "two_phase_damping": {"coefficient": 0.04, "plateau": [0.4, 0.7]},
    }
    flow = {key: value for key, value in ACTING.items() if key != "density_kg_per_m3"}
    stretch = {**ACTING["stretches"][0], "mixture": MIXTURE}
    yield "mixture", changed(
        BASE,
        structure__fluid=[
            {"kind": "inside", "mixture": MIXTURE, "to_m": [0.5, 0.0, 0.0]},
            {**outside, "mixture": MIXTURE, "to_m": [0.4, 0.0, 0.0]},
            {**outside, "mixture": {**MIXTURE, "void_fraction": 0.85}, "from_m": [0.5, 0.0, 0.0]},
        ],
        flow={**flow, "mixture": MIXTURE, "stretches": [stretch],
              "coupling": {"kind": "quasi_steady", **COUPLINGS["quasi_steady"]}},
    )  # fmt: skip
    base = {"kind": "base_motion", "direction": OBLIQUE, "obstacles": "fixed"}
    moved = {"base_displacement_m": 1e-4, "base_velocity_m_per_s": 1e-3}
    for signal in (
        {"kind": "band_limited", "band_Hz": [20.0, 80.0]},
        {"kind": "harmonic", "frequency_Hz": 30.0, "phase_deg": 20.0},
    ):
        yield (
            f"base {signal['kind']}",
            changed(BASE, excitation=base | {"signal": signal}, initial=moved, **NO_FIT),
        )
    yield "chain", CHAIN
    yield (
        "modes",
        changed(
            {key: value for key, value in CHAIN.items() if key != "damping"},
            structure={"kind": "identified", "modes": MODES},
            initial=None,
        ),
    )


END = [1.2098, 0.0424, 0.1983]
CONFIGURATIONS = dict(_configurations())
