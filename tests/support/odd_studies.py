"""Odd studies for the figures: tubes in other planes, many supports, holes of every profile."""

from tests.support.tiny_study import tiny_values

LONG_NAMES = (
    "upper_antivibration_bar",
    "broached_plate_of_the_cold_leg",
    "flow_distribution_baffle",
)
HOLES = (
    {"kind": "circular"},
    {"kind": "lobes", "count": 4, "depth_m": 5.0e-4, "angle_deg": 45.0},
    {"kind": "lobes", "count": 3, "depth_m": 2.0e-3},
    {"kind": "planes", "normals_deg": [0.0, 90.0, 180.0, 270.0]},
    {"kind": "planes", "normals_deg": [90.0, -90.0]},
    {"kind": "planes", "normals_deg": [30.0]},
)


def support(name, at_m, **keys):
    """A support of the configuration."""
    return {
        "name": name,
        "at_m": at_m,
        "height_m": 0.02,
        "points": 3,
        "stiffness_N_per_m": 4e6,
    } | keys


def in_holes():
    """The U-tube in holes of six profiles."""
    supports = [
        support(f"hole_{n}", [-0.3, 0.0, 0.1 + 0.1 * n], profile=hole)
        for n, hole in enumerate(HOLES)
    ]
    supports[5]["gap_m"] = 2.0e-4
    supports[4]["centre_offset_m"] = [0.0, 5.0e-5]
    return tiny_values(supports=supports)


def many_supports(count=12):
    """The U-tube in many plates of long names on both legs."""
    supports = [
        support(f"{LONG_NAMES[n % 3]}_{n}", [-0.3 if n % 2 else 0.3, 0.0, 0.1 + 0.1 * (n // 2)])
        for n in range(count)
    ]
    return tiny_values(supports=supports)


def along(start_m, direction, segments, points, supports, **ends):
    """A tube on another path."""
    values = tiny_values()
    tube = values["structure"]
    values["structure"] = {
        "kind": "path",
        "section": tube["section"],
        "material": tube["material"],
        "start_m": start_m,
        "start_direction": direction,
        "segments": segments,
        "mesh": tube["mesh"],
        **ends,
    }
    values["supports"] = [support(name, at_m) for name, at_m in supports.items()]
    values["points"] = points
    names = list(points)
    values["excitation"] |= {"point": names[0], "direction": [1.0, 0.0, 0.0]}
    values["record"]["sensors"] = {"points": names, "directions": ["x", "y"]}
    values["record"]["shape_line"]["direction"] = "x"
    values["identification"] |= {"response_point": names[1]}
    values["identification"]["lscf"] |= {"references": names[:2]}
    values["identification"]["broadband"] |= {"point": names[0]}
    return values


def in_the_y_z_plane():
    """A U in the plane x = 0, driven out of its plane."""
    return along(
        [0.0, -0.3, 0.0],
        [0.0, 0.0, 1.0],
        [
            {"kind": "straight", "length_m": 0.7},
            {"kind": "bend", "radius_m": 0.3, "angle_deg": 180.0, "toward": [0.0, 1.0, 0.0]},
            {"kind": "straight", "length_m": 0.7},
        ],
        {"shaker": [0.0, -0.2121, 0.9121], "apex": [0.0, 0.0, 1.0], "leg": [0.0, 0.3, 0.5]},
        {"left": [0.0, -0.3, 0.35], "right": [0.0, 0.3, 0.35]},
    )


def straight():
    """A straight tube along z, held at its start and free at its end."""
    return along(
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [{"kind": "straight", "length_m": 1.5}],
        {"shaker": [0.0, 0.0, 1.2], "tip": [0.0, 0.0, 1.5]},
        {f"plate_{n}": [0.0, 0.0, 0.2 * n] for n in range(1, 6)},
        end={"kind": "free"},
    )


def in_space():
    """A tube with bends in two planes."""
    return along(
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [
            {"kind": "straight", "length_m": 0.6},
            {"kind": "bend", "radius_m": 0.2, "angle_deg": 90.0, "toward": [0.0, 1.0, 0.0]},
            {"kind": "straight", "length_m": 0.5},
            {"kind": "bend", "radius_m": 0.2, "angle_deg": 90.0, "toward": [1.0, 0.0, 0.0]},
            {"kind": "straight", "length_m": 0.4},
        ],
        {"shaker": [0.0, 0.0, 0.5], "corner": [0.0, 0.3, 0.8]},
        {"low": [0.0, 0.0, 0.3], "high": [0.0, 0.5, 0.8]},
    )
