"""The model file of a campaign: what its user knows of the beam, as vibroimpact reads it."""

from pathlib import Path

import numpy as np
import yaml

from evidence.truth.geometry import Tube

POINTS = 5  # contact points of a support in the model


def plain(values):
    """(…) as a list of floats, without negative zeros."""
    return (np.asarray(values, float) + 0.0).round(9).tolist()


def structure(beam):
    """The section `structure` of a beam."""
    solid = beam.wall >= 0.5 * beam.outer_diameter
    section = {"outer_diameter_m": beam.outer_diameter, "wall_thickness_m": beam.wall}
    if solid:
        section = {"kind": "round", "diameter_m": beam.outer_diameter}
    common = {
        "theory": "timoshenko",
        "section": section | {"shear_coefficient": beam.shear_coefficient},
        "material": {
            "young_modulus_Pa": beam.young,
            "poisson_ratio": beam.poisson,
            "density_kg_per_m3": beam.density,
        },
    }
    if isinstance(beam, Tube):
        shape = {"kind": "u_tube", "leg_length_m": beam.leg, "bend_radius_m": beam.bend_radius}
        return shape | common | {"root": {"kind": "clamped"}}
    return {
        "kind": "path",
        **common,
        "start_m": [0.0, 0.0, 0.0],
        "start_direction": plain(beam.position(1.0)),
        "segments": [{"kind": "straight", "length_m": beam.length}],
        "start": {"kind": beam.ends[0]},
        "end": {"kind": beam.ends[1]},
    }


def profile(beam, holder):
    """The section `profile` of a support. The library counts angles from x, or from y where the
    beam runs along x; here they count from the in-plane direction towards y.
    """
    if holder.profile == "circle":
        return {"kind": "circular"}
    angles = np.rad2deg(holder.angle) + 360.0 / holder.lobes * np.arange(holder.lobes)
    if abs(beam.tangent(holder.arc)[0]) > 0.5:
        angles = 90.0 - angles
    return {"kind": "planes", "normals_deg": plain(np.sort(angles % 360.0))}


def supports(beam):
    """The section `supports` of a beam."""
    return [
        {
            "name": holder.name,
            "at_m": plain(beam.position(holder.arc)),
            "height_m": holder.height,
            "points": POINTS,
            "stiffness_N_per_m": holder.stiffness,
            "gap_factor": holder.gap_factor,
            "profile": profile(beam, holder),
        }
        for holder in beam.holders
    ]


def model_of(plan):
    """The configuration of a plan's model: plain values."""
    beam, places = plan.beam, plan.beam.places
    names = {"shaker" if name == "drive" else name: at for name, at in places.items()}
    load, gap = (sorted({level[column] for level in plan.levels}) for column in (0, 1))
    return {
        "study": "campaign_model",
        "seed": 1,
        "structure": structure(beam),
        "damping": {
            "kind": "modal",
            "first_ratios": [beam.first_damping, beam.first_damping],
            "other_ratio": beam.other_damping,
        },
        "supports": supports(beam),
        "points": {name: plain(beam.position(at)) for name, at in names.items()},
        "excitation": {
            "kind": "band_limited",
            "point": "shaker",
            "direction": plain(plan.drive_direction),
            "band_Hz": plain(plan.band),
        },
        "grid": {
            "load_rms_N": plain(load),
            "gap_m": [float(0.01 * percent * beam.outer_diameter) for percent in gap],
            "seeds": 1,
        },
        "record": {
            "duration_s": 10.0,
            "sensors": {
                "points": [name for name in names if name != "shaker"][:4],
                "directions": ["x", "y", "z"],
            },
            "shape_line": {"points": 27, "direction": "y"},
        },
    }


def write_model(plan, path):
    """Write the model of a plan as YAML."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(
        yaml.safe_dump(model_of(plan), sort_keys=False, default_flow_style=None), encoding="utf-8"
    )
