"""A mass on a spring as a configuration: the smallest study."""

ALONG_X = {"point": "mass", "direction": [1.0, 0.0, 0.0]}


def one_mass(stiffness, mass=1.0, **sections):
    """The mapping of a study of a mass (kg), called "mass", on a spring (N/m) under a random force
    along x; top-level sections are added or replaced.
    """
    return {
        "study": "mass",
        "structure": {
            "kind": "chain",
            "masses": [{"name": "mass", "mass_kg": mass}],
            "springs": [{"between": ["ground", "mass"], "stiffness_N_per_m": stiffness}],
        },
        "excitation": {"kind": "band_limited", "band_Hz": [5.0, 200.0], **ALONG_X},
        "grid": {"load_rms_N": [1.0], "gap_m": [1.0], "seeds": 1},
        "record": {"duration_s": 5.0},
    } | sections
