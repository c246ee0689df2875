"""The checks of names: every point, element and support that a configuration names is there."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from .key_problem import Problem, Problems, near_or_known
from .stage_settings import ConfigPart

TUBES = ("u_tube", "path")


def names_twice(supports: ConfigPart, elements: ConfigPart, masses: ConfigPart) -> Problems:
    """Yield a problem unless supports, elements and masses have names of their own."""
    for kind, entries in (("supports", supports), ("elements", elements), ("masses", masses)):
        for name, times in Counter(entry.name for entry in entries).items():
            if times > 1:
                yield Problem(kind, f"names {times} {kind}: give each a name of its own", name)


def drag_partners(elements: ConfigPart) -> Problems:
    """Yield a problem unless elements that share the speed of a drag are there."""
    names = [element.name for element in elements]
    for index, element in enumerate(elements):
        if element.drag_partner is not None and (
            element.drag_partner == element.name or names.count(element.drag_partner) != 1
        ):
            others = ", ".join(name for name in names if name != element.name)
            yield Problem(
                f"elements[{index}].drag_partner",
                f"is not one other element: give one of {others or 'none, there is no other'}",
            )


def named_points(names: Sequence[str], given: Mapping[str, ConfigPart]) -> Problems:
    """Yield a problem unless points that force, sensors, supports, elements and masses name are
    there.
    """
    for place, name in _points_of(given):
        if name not in names:
            remedy = near_or_known(name, names) if names else "points is empty, add it there"
            yield Problem(place, f"is not one of the named points: {remedy}")


def names_of_points(structure: ConfigPart, points: Mapping[str, Sequence[float]]) -> list[str]:
    """Return the names of the points that a structure has."""
    if structure.kind == "chain":
        return [mass.name for mass in structure.masses]
    if structure.kind == "matrices":
        return list(structure.points)
    if structure.kind == "identified":
        return sorted({name for mode in structure.modes for name in mode.shape})
    return list(points)


def _points_of(given: Mapping[str, ConfigPart]) -> Iterator[tuple[str, str]]:
    """Yield (place, point) of everything that sections name."""
    force, sensors = given.get("excitation"), getattr(given.get("record"), "sensors", None)
    if (point := getattr(force, "point", None)) is not None:
        yield "excitation.point", point
    for key in ("also", "constant"):
        yield from _attached_points(f"excitation.{key}", getattr(force, key, ()))
    for i, name in enumerate(sensors.points if sensors else ()):
        yield f"record.sensors.points[{i}]", name
    for part in ("supports", "elements", "masses"):
        yield from _attached_points(part, given.get(part, ()))


def _attached_points(part: str, entries: Sequence[ConfigPart]) -> Iterator[tuple[str, str]]:
    """Yield (place, point) of everything that is attached to a point, or between two."""
    for i, entry in enumerate(entries):
        for key in ("point", "other_point"):
            if getattr(entry, key, None) is not None:
                yield f"{part}[{i}].{key}", getattr(entry, key)


def identified_points(record: ConfigPart, identification: ConfigPart) -> Problems:
    """Yield a problem unless points to identify from are recorded."""
    named = [
        ("identification.response_point", identification.response_point),
        ("identification.broadband.point", identification.broadband.point),
    ]
    named += [
        (f"identification.lscf.references[{i}]", name)
        for i, name in enumerate(identification.lscf.references)
    ]
    for place, name in named:
        if record.sensors is None or name not in record.sensors.points:
            yield Problem(place, "is not recorded: add it to record.sensors.points")


def identification_needs(
    structure: ConfigPart,
    excitation: ConfigPart,
    record: ConfigPart,
    supports: ConfigPart,
    identification: ConfigPart,
) -> Problems:
    """Yield a problem unless the supports of a tube are identified under a broadband force."""
    tube, force = structure.kind in TUBES, excitation.kind
    broadband = force in ("band_limited", "measured", "turbulence")
    for wrong, told in (
        (not supports, "looks for the equivalent support, and there are no supports"),
        (not tube, f"reads the equivalent support of a tube, structure.kind is {structure.kind}"),
        (tube and not broadband, f"needs a broadband force, excitation.kind is {force}"),
    ):
        if wrong:
            yield Problem("identification", f"{told}: leave identification out", "given")
    if record.every_step:
        yield Problem(
            "record.every_step", "keeps no spectra to identify from: leave identification out"
        )


def grouped_supports_are_there(supports: ConfigPart, identification: ConfigPart) -> Problems:
    """Yield a problem unless groups name supports that are there, each once."""
    if isinstance(identification.groups, str):
        return
    names = [support.name for support in supports]
    taken: dict[str, int] = {}
    for index, group in enumerate(identification.groups):
        for place, name in enumerate(group):
            key = f"identification.groups[{index}][{place}]"
            if name not in names:
                yield Problem(key, f"is no support: {near_or_known(name, names)}")
            elif name in taken:
                yield Problem(key, f"is in group {taken[name]} already: a support is in one group")
            taken.setdefault(name, index)


def point_supports(other: ConfigPart, supports: ConfigPart) -> Problems:
    """Yield a problem unless supports of a structure other than a tube are at its points."""
    for index, support in enumerate(supports):
        if support.point is None or support.at_m is not None:
            yield Problem(
                f"supports[{index}]",
                f"is on a structure of kind {other.kind}: give point, and no at_m",
                support.name,
            )


def same_stop_twice(other: ConfigPart, supports: ConfigPart) -> Problems:
    """Yield a problem unless supports at one point of a structure differ."""
    for index, support in enumerate(supports):
        for known in supports[:index]:
            if support.model_copy(update={"name": known.name}) == known:
                yield Problem(
                    f"supports[{index}]",
                    f"is '{known.name}' again: leave it out, or add up the stiffness of the two",
                    support.name,
                )


def places_of_points(
    other: ConfigPart, names: Sequence[str], points: Mapping[str, Sequence[float]]
) -> Problems:
    """Yield a problem unless places are those of points that a structure other than a tube has."""
    for name in points:
        if name not in names:
            yield Problem(
                f"points.{name}",
                f"is the place of no named point of the structure: known are {', '.join(names)}",
            )


def chain_names(structure: ConfigPart) -> Problems:
    """Yield a problem unless masses have names, and springs name them."""
    if structure.kind != "chain":
        return
    names = [mass.name for mass in structure.masses]
    for name, times in Counter(names).items():
        if times > 1:
            yield Problem(
                "structure.masses", f"names {times} masses: give each a name of its own", name
            )
    if "ground" in names:
        place = f"structure.masses[{names.index('ground')}].name"
        yield Problem(place, "is the name of the earth in springs: give the mass another name")
    for index, spring in enumerate(structure.springs):
        if len(set(spring.between)) == 1:
            yield Problem(
                f"structure.springs[{index}].between",
                "joins one place to itself, it has no effect: give two masses, or one and ground",
            )
        for end in spring.between:
            if end not in (*names, "ground"):
                yield Problem(
                    f"structure.springs[{index}].between",
                    f"is no mass: give one of {', '.join(names)}, or ground",
                    end,
                )


def sensors(record: ConfigPart) -> Problems:
    """Yield a problem unless sensors are named once."""
    if record.sensors is None:
        return
    for key, row in (("points", record.sensors.points), ("directions", record.sensors.directions)):
        for name, times in Counter(row).items():
            if times > 1:
                yield Problem(
                    f"record.sensors.{key}", f"stands {times} times: give each once", name
                )


def sensors_of_a_tube(tube: ConfigPart, record: ConfigPart) -> Problems:
    """Yield a problem unless a tube has sensors, the shape line among their directions."""
    if record.sensors is None:
        yield Problem(
            "record.sensors", "is needed on a tube: name the points and directions to record"
        )
    elif record.shape_line.direction not in record.sensors.directions:
        yield Problem(
            "record.shape_line.direction",
            "is not a direction of the sensors: add it to record.sensors.directions"
            f" {list(record.sensors.directions)}",
        )


def driven_direction_is_recorded(
    structure: ConfigPart, excitation: ConfigPart, record: ConfigPart
) -> Problems:
    """Yield a problem unless the direction of the force is recorded."""
    if not hasattr(excitation, "direction"):
        return
    driven = "xyz"[int(np.argmax(np.abs(excitation.direction)))]
    across = structure.kind == "chain" and driven != "x"  # then the model says that nothing moves
    if record.sensors is not None and not across and driven not in record.sensors.directions:
        yield Problem(
            "record.sensors.directions",
            f"lacks '{driven}', the direction of the force, which figures and estimates read: add"
            " it",
        )
