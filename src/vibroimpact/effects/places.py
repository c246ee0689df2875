"""Where an effect may sit: supports, and named points on the tube that an effect adds to a
configuration.
"""

import numpy as np

from vibroimpact.config.structure import Path, UTube
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.geometry.directions import transverse_directions

STOP = "clearance_stop"  # name of the support that the effect clearance adds
SHARES = (0.0625, 0.1875, 0.3125, 0.4375)  # of a limit
TUBES = {"u_tube": UTube, "path": Path}


def supports(values):
    """Return the places of an effect of contact: all supports together, then each by itself."""
    names = [support["name"] for support in values["supports"] if support["name"] != STOP]
    return ["all", *names] if len(names) > 1 else ["all"]


def driven(values):
    """Return the name of the drive point."""
    return [values["excitation"]["point"]]


def masses_and_springs(values):
    """Return the named points of a structure that an element may be put at: the drive point first,
    then the others, one per place.
    """
    first, seen, names = values["excitation"].get("point"), [], []
    for name in sorted(values["points"], key=lambda point: point != first):
        place = np.array(values["points"][name])
        if all(np.linalg.norm(place - other) > 1.0e-3 for other in seen):
            seen.append(place)
            names.append(name)
    return names


def with_supports(values, location, change):
    """Return the configuration with change(support) -> {key: value} merged into the supports of a
    location.
    """
    return values | {
        "supports": [
            support | change(support) if sits_at(support, location) else support
            for support in values["supports"]
        ]
    }


def sits_at(support, location):
    """Return whether a support is at a location: by its name, or at all, which the stop that an
    effect has added is not of.
    """
    return location == support["name"] or (location == "all" and support["name"] != STOP)


def with_element(values, name, point, direction, **laws):
    """Return the configuration with a local element more between a point and the ground; laws: keys
    of an element; unchanged where all are 0.
    """
    if not any(laws.values()):
        return values
    element = {"name": name, "point": point, "direction": list(direction), **laws}
    return values | {"elements": [*values["elements"], element]}


def side_by_side(values, name, point, direction, **laws):
    """Return the configuration with SHARES of a local element side by side, all equally stiff: a
    law that bends at once, as it is where it bends little by little.

    laws: keys of an element, its limit in N and its stiffness.
    """
    limits = {key for key in laws if key.endswith("limit_N")}
    for number, share in enumerate(SHARES):
        parts = {
            key: value * share if key in limits else value / len(SHARES)
            for key, value in laws.items()
        }
        values = with_element(values, f"{name}_{number + 1}", point, direction, **parts)
    return values


def across(values, point):
    """Return the direction of an element at a point: that of the force."""
    return values["excitation"]["direction"]


def across_deg(values, point):
    """Return the angle in degrees, in a tube's section at a point, of the direction of the force:
    see supports for the axes, which turn with the tube.
    """
    line = _centreline(values)
    first, second = transverse_directions(
        line.direction(line.locate(values["points"][point], point))
    ) @ np.array(across(values, point))
    return float(np.rad2deg(np.arctan2(second, first)))


def stations(values, count):
    """Return ({name: place}, tributary length in m) of `count` points evenly spaced along a tube,
    ends excluded.
    """
    line = _centreline(values)
    lengths = line.length * (np.arange(count) + 0.5) / count
    return {
        f"station_{number + 1}": [float(x) for x in line.position(at)]
        for number, at in enumerate(lengths)
    }, line.length / count


def _centreline(values):
    """Return the Centreline of a configuration of a tube."""
    structure = values["structure"]
    return build_centreline(TUBES[structure["kind"]].model_validate(structure))
