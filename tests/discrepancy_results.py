"""Made-up results of the discrepancy workflow, to draw figures and the report from: friction hidden
in a tube that has none in its model.
"""

import numpy as np
import xarray as xr

from vibroimpact.verdict.content import Verdict

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


def made_up_map(strength, seed=1):
    """A map Dataset whose discrepancy grows with load near 28 and 70 Hz, by strength dB at most."""
    draw = np.random.default_rng(seed)
    frequency = np.arange(2.0, 260.0, 0.25)
    centre = np.sqrt(EDGES[:-1] * EDGES[1:])
    bump = np.exp(-0.5 * (np.log(centre / 28.0) / 0.18) ** 2) - 0.8 * np.exp(
        -0.5 * (np.log(centre / 70.0) / 0.15) ** 2
    )
    weight = (
        np.array([0.0, 0.5, 1.0, 0.9])[:, None, None]
        * np.array([1.0, 0.3, 0.9, 0.8, 0.3, 0.8, 0.5])[None, :, None]
    )
    seed_sd = np.full((4, 7, 24), 0.6) + 0.3 * draw.random((4, 7, 24))
    discrepancy = strength * weight * bump + seed_sd * draw.standard_normal((4, 7, 24))
    counted = np.ones((4, 7, 24), bool)
    counted[:2, [1, 4]] = False  # in the plane nothing moves at low levels
    hidden = np.interp(np.log(frequency), np.log(centre), bump) * weight  # per dB of strength
    response = sum(
        1.0 / ((1.0 - (frequency / mode) ** 2) ** 2 + (0.05 * frequency / mode) ** 2) / (1 + index)
        for index, mode in enumerate(MODES)
    )
    amplitude = 0.3 + np.random.default_rng(5).random(7)
    psd = (
        np.array([load for _, load, _, _ in RECORDS])[:, None, None] ** 2
        * amplitude[None, :, None]
        * frequency**2
        * 1e-4
        * response
    )
    psd = psd * 10.0 ** (
        0.1 * (STRENGTH - strength) * hidden
    )  # what the model, as given or completed, knows of it
    turned = 10.0 ** (0.1 * strength * hidden)
    scatter = np.exp(0.15 * draw.standard_normal(psd.shape))
    level = 10.0 * np.log10(
        np.array(
            [
                [
                    [
                        np.mean(psd[r, c][(frequency >= low) & (frequency < high)]) * (high - low)
                        for low, high in zip(EDGES[:-1], EDGES[1:], strict=True)
                    ]
                    for c in range(7)
                ]
                for r in range(4)
            ]
        )
    )
    dims = ("record", "channel", "band")
    return xr.Dataset(
        {
            "measured_dB": (dims, level + discrepancy),
            "simulated_dB": (dims, level),
            "sd_dB": (dims, 1.3 * seed_sd),
            "D": (dims, discrepancy),
            "z": (dims, discrepancy / (1.3 * seed_sd)),
            "band_Hz": (("band", "edge"), np.stack([EDGES[:-1], EDGES[1:]], axis=1)),
            "counted": (dims, counted.astype(np.int8)),
            "record_name": ("record", np.array([record[0] for record in RECORDS], dtype=object)),
            "load_rms": ("record", np.array([record[1] for record in RECORDS])),
            "gap": ("record", np.array([record[2] for record in RECORDS])),
            "split": ("record", np.array([record[3] for record in RECORDS], dtype=object)),
            "channel_name": ("channel", np.array(CHANNELS, dtype=object)),
            "psd_frequency": ("frequency", frequency),
            "psd_measured": (("record", "channel", "frequency"), psd * turned * scatter),
            "psd_simulated_mean": (("record", "channel", "frequency"), psd),
            "psd_simulated_low": (("record", "channel", "frequency"), psd * 0.7),
            "psd_simulated_high": (("record", "channel", "frequency"), psd * 1.4),
        }
    )


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


def made_up_candidates():
    """Contents of candidates/*.json, best first."""
    mu = np.geomspace(0.02, 0.6, 13)
    gap = np.linspace(1.5e-4, 4e-4, 9)
    return [
        {
            "ids": ["dry_friction"],
            "profile": [
                {
                    "parameter": "mu",
                    "unit": "1",
                    "values": mu.tolist(),
                    "left": (1.1 + 9.0 * np.log(mu / 0.15) ** 2).tolist(),
                    "simulated": [0.1, 0.15, 0.3],
                }
            ],
        },
        {
            "ids": ["gap"],
            "profile": [
                {
                    "parameter": "gap",
                    "unit": "m",
                    "values": gap.tolist(),
                    "left": (1.3 + 9e8 * (gap - 2.6e-4) ** 2).tolist(),
                }
            ],
        },
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
