"""Made-up results of the discrepancy workflow, to draw figures and the report from: friction hidden
in a tube that has none in its model.
"""

import numpy as np

from vibroimpact.diagnosis.verdict.content import Verdict

CHANNELS = [
    "apex_y",
    "apex_x",
    "bend45_right_y",
    "left_leg_upper_y",
    "left_leg_upper_x",
    "right_leg_upper_y",
    "left_leg_lower_y",
]
RECORDS = [
    ("L0.5_G1.3_0", 0.5, 2.48e-4, "fit"),
    ("L3_G1.3_1", 3.0, 2.48e-4, "fit"),
    ("L10_G1.3_2", 10.0, 2.48e-4, "fit"),
    ("L10_G0.9_3", 10.0, 1.71e-4, "holdout"),
]
EDGES = np.geomspace(5.0, 200.0, 25)
STRENGTH = 9.0  # dB
MODES = (16.0, 45.0, 101.0, 173.0)


HELD_OUT = [84.0, 82.0, 61.0, 35.0, 29.0, 24.0, 8.0, 3.0, -6.0, -14.0]
CLOSED = [0.87, 0.86, 0.64, 0.38, 0.33, 0.27, 0.09, 0.05, -0.03, -0.1]


def made_up_ranking():
    """Rows of ranking.csv."""
    ids = [
        "dry_friction",
        "dry_friction+gap",
        "foliate_obstacle",
        "coulomb_friction",
        "hunt_crossley",
        "contact_damping",
        "gap",
        "support_offset",
        "modal_damping",
        "preload",
    ]
    fit = [212.0, 208.0, 180.0, 122.0, 96.0, 88.0, 31.0, 25.0, 18.0, 11.0]
    return [
        {
            "ids": name,
            "fit_score": one,
            "closed_fraction": None if index else 0.87,
            "tested": index < 5,
            "probability": None if index > 1 else (0.95, 0.04)[index],
        }
        for index, (name, one) in enumerate(zip(ids, fit, strict=True))
    ]


def made_up_verdict(kind="named", **changes):
    """A Verdict of one kind, with other values of some keys."""
    friction = {
        "id": "dry_friction",
        "location": "all",
        "parameters": {"mu": {"value": 0.149, "unit": "1", "low": 0.128, "high": 0.171}},
    }
    named = kind in ("named", "partly_explained")
    sets = {
        "named": [["dry_friction"]],
        "partly_explained": [["dry_friction"]],
        "ambiguous": [["dry_friction"], ["foliate_obstacle"]],
    }
    checks = [
        {
            "check": "units",
            "level": "pass",
            "record": None,
            "channel": None,
            "message": "Every channel has a unit of its kind.",
        },
        {
            "check": "clipping",
            "level": "warn",
            "record": "L10_G1.3_2",
            "channel": "apex_x",
            "message": (
                "apex_x has flat tops near 380 (SI) in record L10_G1.3_2, 0.4 % of the samples: the"
                " range of the amplifier was too small. It is left out of this record."
            ),
        },
    ]
    if kind == "not_testable":
        checks = [
            {
                "check": "content",
                "level": "refuse",
                "record": None,
                "channel": None,
                "message": "All usable records have the load 3: a verdict needs two levels.",
            }
        ]
    split = {"before_dB": 5.8, "after_dB": 1.4, "floor_dB": 1.2, "closed_fraction": 0.87}
    nothing = {"before_dB": None, "after_dB": None, "floor_dB": None, "closed_fraction": None}
    tested = kind != "not_testable"
    values = {
        "verdict": kind,
        "effects": [friction] if named else [],
        "ambiguity_set": sets.get(kind, []),
        "ranking": (
            [
                {
                    "ids": row["ids"].split("+"),
                    "heldout_score": held,
                    "closed_fraction": closed,
                }
                for row, held, closed in zip(made_up_ranking(), HELD_OUT, CLOSED, strict=True)
            ]
            if tested
            else []
        ),
        "next_measurement": (
            "Measure the in-plane motion at the apex at 3 N and a gap of 0.9 %: friction keeps it"
            " small, flat lands do not."
            if kind == "ambiguous"
            else None
        ),
        "broken_invariances": ["T2", "T5"] if tested else [],
        "regions": (
            [
                {
                    "band_Hz": [24.0, 33.0],
                    "load_rms_N": 10.0,
                    "gap_m": 2.48e-4,
                    "channel": "apex_y",
                    "discrepancy_dB": 7.4,
                    "z": 8.1,
                    "nearest_modes_Hz": [28.4],
                },
                {
                    "band_Hz": [60.0, 82.0],
                    "load_rms_N": 10.0,
                    "gap_m": 2.48e-4,
                    "channel": "apex_y",
                    "discrepancy_dB": -5.9,
                    "z": -6.3,
                    "nearest_modes_Hz": [70.2],
                },
            ]
            if tested
            else []
        ),
        "misfit": {"fit": split if tested else nothing, "holdout": split if tested else nothing},
        "p_global_before": 0.0005 if tested else None,
        "p_global_after": 0.31 if tested else None,
        "checks": checks,
        "seconds": 912.4,
        "simulations": 3120,
        "provenance": {"versions": "python 3.11 numpy 2.4", "config_digest": "0123456789abcdef"},
    }
    return Verdict.from_values(values | changes)
