"""The places of an effect: supports, and named points on the tube that an effect adds to a
configuration.
"""

import re
from collections.abc import Callable, Sequence
from itertools import count
from typing import Any

import numpy as np

from vibroimpact.config.structure import Path, UTube
from vibroimpact.geometry.centreline import Centreline, build_centreline
from vibroimpact.geometry.directions import transverse_directions, unit_vector

from .effect import Apply, Values

STOP = "clearance_stop"  # name of the support that the effect clearance adds
SHARES = (0.0625, 0.1875, 0.3125, 0.4375)  # of the limit of an element that is split
# an unnamed place on a tube by its arc length: arc_355_6mm is at 355.6 mm; a direction other than
# that of the force by its angle: arc_355_6mm_turned_m9_5deg is turned by -9.5
BETWEEN = re.compile(r"arc_([\d_]+)mm(?:_turned_(m?[\d_]+)deg)?")
ALONG = "along_tube"  # of an effect whose place on the tube is one of its parameters
TURNED = "along_tube_turned"  # the same, and its direction across the tube
MODE = re.compile(r"^mode_(\d+)$")  # the location of an effect on one mode
WHOLE_CHAIN = ("responses", "force_and_responses")  # locations of a fault of all channels
IN_WORDS = {
    ALONG: "a place along the tube",
    TURNED: "a place along the tube, in any direction",
    "tube": "the whole tube",
    "about_z": "about the z axis",
    "about_tube": "about the tube's axis",
    "along_force": "along the force",
    **{f"along_{axis}": f"along {axis}" for axis in "xyz"},
    "responses": "all responses",
    "force_and_responses": "the force and all responses",
}
TUBES: dict[str, type[UTube] | type[Path]] = {"u_tube": UTube, "path": Path}


def supports(values: Values) -> list[str]:
    """Return the places of an effect of contact: all supports together, then each by itself."""
    names = [support["name"] for support in values["supports"] if support["name"] != STOP]
    return ["all", *names] if len(names) > 1 else ["all"]


def holes(values: Values) -> list[str]:
    """Return the places of an effect that turns obstacles into others: those of `supports` that do
    not press at rest, which only the flat lands that they have can do.
    """
    free = []
    for support in values["supports"]:
        gap = support.get("gap_m")
        if support.get("preload_N") is None and (gap is None or gap > 0.0):
            free.append(support["name"])
    if len(free) == len(values["supports"]):
        return supports(values)
    return [name for name in free if name != STOP]


def masses_and_springs(values: Values) -> list[str]:
    """Return the named points of a structure that an element may be put at: the drive point first,
    then the others, one per place.
    """
    first = values["excitation"].get("point")
    seen: list[np.ndarray] = []
    names: list[str] = []
    for name in sorted(values["points"], key=lambda point: point != first):
        place = np.array(values["points"][name])
        if all(np.linalg.norm(place - other) > 1.0e-3 for other in seen):
            seen.append(place)
            names.append(name)
    return names


def stops(values: Values) -> list[str]:
    """Return the named points at which a stop may be; none on a structure other than a tube if the
    force acts along z, since supports at named points act across z.
    """
    if values["structure"]["kind"] not in TUBES:
        direction = unit_vector(values["excitation"]["direction"])
        if np.linalg.norm(direction[:2]) < ALONG_IT:
            return []
    return masses_and_springs(values)


def with_supports(values: Values, location: str, change: Callable[[Values], Values]) -> Values:
    """Return the configuration with change(support) -> {key: value} merged into the supports of a
    location.
    """
    return values | {
        "supports": [
            support | change(support) if sits_at(support, location) else support
            for support in values["supports"]
        ]
    }


def at_supports(keys_of: Callable[[dict[str, float]], Values]) -> Apply:
    """Return the `apply` of an effect that sets keys of the supports of a location.

    keys_of(parameters): {key: value} of each of them.
    """

    def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
        return with_supports(values, location, lambda support: keys_of(parameters))

    return apply


def sits_at(support: Values, location: str) -> bool:
    """Return whether a support is at a location: a name, or "all" for every support but the stop
    that an effect has added.
    """
    return location == support["name"] or (location == "all" and support["name"] != STOP)


def with_element(
    values: Values, name: str, point: str, direction: Sequence[float], **laws: Any
) -> Values:
    """Return the configuration with another local element between a point and the ground.

    laws: keys of an element. Unchanged if all are 0.
    """
    if not any(laws.values()):
        return values
    element = {"point": point, "direction": list(direction), **laws}
    return with_entry(values, "elements", name, element)


def at_a_point(name: str, laws_of: Callable[[dict[str, float]], Values]) -> Apply:
    """Return the `apply` of an effect that is a local element between a point and the ground, along
    the force.

    laws_of(parameters): {key of an element: value}.
    """

    def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
        return with_element(values, name, location, across(values, location), **laws_of(parameters))

    return apply


def with_mass(values: Values, name: str, point: str, mass_kg: float) -> Values:
    """Return the configuration with another point mass, at a named point or a place between (see
    between); unchanged if it is 0.
    """
    if mass_kg == 0.0:
        return values
    entry = {"point": point, "mass_kg": mass_kg}
    return with_entry(with_place(values, point), "masses", name, entry)


def between(arc_length_m: float, turned_deg: float | None = None) -> str:
    """Return the location of a place on a tube; turned_deg: angle from the direction of the force
    to that of the effect, see across.
    """
    place = f"arc_{1e3 * arc_length_m:.1f}mm"
    if turned_deg is not None:
        place += f"_turned_{turned_deg:.1f}deg".replace("-", "m")
    return place.replace(".", "_")


def arc_length_m(location: str) -> float | None:
    """Return the arc length in m of a place that `between` named; None of another location."""
    length = _numbers(location)[0]
    return None if length is None else 1.0e-3 * length


def turned_deg(location: str) -> float | None:
    """Return by how many degrees the direction of a location is turned from that of the force; None
    if it is not.
    """
    return _numbers(location)[1]


def _numbers(location):
    """Return (mm, deg) of a place that `between` named, None for a part that it does not give."""
    named = BETWEEN.fullmatch(location)
    texts = named.groups() if named else (None, None)
    try:
        length, angle = (
            None if text is None else float(text.replace("m", "-").replace("_", "."))
            for text in texts
        )
    except ValueError:  # a point of the model that is called so
        return None, None
    return length, angle


def place_in_words(location: str) -> str:
    """Return a location in words: an unnamed place by its position."""
    arc_length, angle = arc_length_m(location), turned_deg(location)
    if arc_length is None:
        return IN_WORDS.get(location) or MODE.sub(r"mode \1", location)
    turned = "" if angle is None else f", {angle:.0f} degrees from the force's direction"
    return f"{arc_length:.4f} m along the tube{turned}"


def at_place(location: str) -> str:
    """Return a location as it follows an effect in a sentence, after a space; empty for all of the
    structure or of its supports.
    """
    if location in ("", "all", "tube"):
        return ""
    words = place_in_words(location)
    if words.startswith(("about ", "along ")):
        return f" {words}"
    return f" {'of' if MODE.fullmatch(location) or location in WHOLE_CHAIN else 'at'} {words}"


def length_m(values: Values) -> float | None:
    """Return the length in m of a tube along its centreline, None of another structure."""
    return _centreline(values).length if values["structure"]["kind"] in TUBES else None


def with_place(values: Values, location: str) -> Values:
    """Return the configuration with a named point at a location between those that it has."""
    arc_length = arc_length_m(location)
    if location in values["points"] or arc_length is None:
        return values
    place = _centreline(values).position(arc_length)
    return values | {"points": values["points"] | {location: [float(x) for x in place]}}


def with_entry(values: Values, key: str, name: str, entry: Values) -> Values:
    """Return the configuration with an entry added to elements or masses.

    It is called name, or name_2 and so on if an effect is added to a model that has it.
    """
    taken = {other["name"] for other in values[key]}
    names = (name if number == 1 else f"{name}_{number}" for number in count(1))
    free = next(each for each in names if each not in taken)
    return values | {key: [*values[key], {"name": free, **entry}]}


def across(values: Values, point: str) -> Sequence[float]:
    """Return the direction of an element at a point: that of the force; on a tube, as the motion
    that the force drives there: carried from the drive point along the tube, perpendicular to it,
    and turned about the tube's axis if the point is one of `between` with an angle.
    """
    if values["structure"]["kind"] not in TUBES:
        return values["excitation"]["direction"]
    return [float(x) for x in _carried(values, point)]


def axes_across(values: Values, place: Sequence[float]) -> np.ndarray:
    """Return (2, 3): the two directions across a tube at a place (3,) in m; x and y of another
    structure, along which its supports act.
    """
    if values["structure"]["kind"] not in TUBES:
        return np.eye(3)[:2]
    line = _centreline(values)
    return transverse_directions(line.direction(line.locate(place, "a place")))


def start_direction(values: Values) -> np.ndarray | None:
    """Return the direction (3,) of a tube at its start, None of another structure."""
    if values["structure"]["kind"] not in TUBES:
        return None
    return _centreline(values).direction(0.0)


def with_stops(
    values: Values, point: str, stiffness: float, gap: float, normals_deg: list[float]
) -> Values:
    """Return the configuration with a support of flat stops at a named point.

    stiffness: N/m. gap: m. normals_deg: of the stops, see across_deg.
    """
    place: Values = {"point": point}
    if values["structure"]["kind"] in TUBES:
        place = {"at_m": list(values["points"][point]), "height_m": 0.002, "points": 1}
    support = {
        "name": STOP,
        **place,
        "stiffness_N_per_m": stiffness,
        "gap_m": gap,
        "profile": {"kind": "planes", "normals_deg": normals_deg},
    }
    return values | {"supports": [*values["supports"], support]}


def across_deg(values: Values, point: str) -> float:
    """Return the angle in degrees of that direction between the two axes of a support at a point:
    those of a tube turn with it, those of another structure are x and y.
    """
    direction = np.asarray(across(values, point), dtype=float)
    first, second = axes_across(values, values["points"][point]) @ direction
    return float(np.rad2deg(np.arctan2(second, first)))


ALONG_IT = 1.0e-6  # sine of the angle between a force and the tube that it pulls at


def _carried(values, point):
    """Return (3,): the direction of the force, turned with a tube from the drive point, or from
    `point` if there is none; of a force along the tube, the first direction across it.
    """
    line = _centreline(values)
    drive = values["excitation"].get("point") or point
    ends = [line.locate(values["points"][name], name) for name in (drive, point)]
    direction = np.array(values["excitation"]["direction"], dtype=float)
    first = line.direction(ends[0])
    if np.linalg.norm(np.cross(direction, first)) < ALONG_IT * np.linalg.norm(direction):
        direction = transverse_directions(first)[0]
    direction, tangent = line.carried(direction, ends[1], ends[0]), line.direction(ends[1])
    angle = np.deg2rad(turned_deg(point) or 0.0)
    return np.cos(angle) * direction + np.sin(angle) * np.cross(tangent, direction)


def stations(values: Values, count: int) -> tuple[dict[str, list[float]], float]:
    """Return ({name: place}, tributary length in m) of `count` points evenly spaced along a tube,
    ends excluded.
    """
    line = _centreline(values)
    lengths = line.length * (np.arange(count) + 0.5) / count
    return {
        f"station_{number + 1}": [float(x) for x in line.position(at)]
        for number, at in enumerate(lengths)
    }, line.length / count


def _centreline(values: Values) -> Centreline:
    """Return the Centreline of a configuration of a tube."""
    structure = values["structure"]
    return build_centreline(TUBES[structure["kind"]].model_validate(structure))
