"""The checks of the initial state."""

from collections.abc import Sequence

from vibroimpact.geometry.centreline import LOCATION_TOLERANCE_M

from .geometry_checks import centreline_of, off_the_tube
from .key_problem import Problem, Problems
from .name_checks import TUBES
from .stage_settings import ConfigPart


def initial_fields(structure: ConfigPart, names: Sequence[str], initial: ConfigPart) -> Problems:
    """Yield a problem unless the initial state is one that the kind of structure can have."""
    if structure.kind in (*TUBES, "identified") and (
        initial.displacement_m or initial.velocity_m_per_s
    ):
        yield Problem(
            "initial",
            "sets dofs of a chain or of matrices: give initial.displacement or initial.velocity,"
            " a field (on a tube rigid, mode or places; of measured modes mode)",
            "given",
        )
    for key, values in (("displacement", "displacement_m"), ("velocity", "velocity_m_per_s")):
        field, place = getattr(initial, key), f"initial.{key}"
        if field is None:
            continue
        if getattr(initial, values):
            yield Problem(
                place, f"is given together with initial.{values}: give one of them", field.kind
            )
        if field.kind == "mode":
            if field.point not in names:
                known = ", ".join(names) or "none"
                yield Problem(f"{place}.point", f"is not a named point: known are {known}")
        elif structure.kind not in TUBES:
            yield Problem(
                f"{place}.kind",
                f"is for tubes, structure.kind is {structure.kind}: give initial.{values}, or mode",
            )
        elif field.kind == "places":
            yield from _places(structure, f"{place}.values", field.values)


def _places(structure: ConfigPart, place: str, values: Sequence[ConfigPart]) -> Problems:
    """Yield a problem unless values are given along the whole tube, in order."""
    centreline = centreline_of(structure)
    if centreline is None:
        return
    off = [
        problem
        for index, value in enumerate(values)
        for problem in off_the_tube(centreline, f"{place}[{index}].at_m", value.at_m)
    ]
    yield from off
    if off:
        return
    lengths = [centreline.locate(value.at_m, place) for value in values]
    for index, (before, after) in enumerate(zip(lengths[:-1], lengths[1:], strict=True), start=1):
        if after <= before:
            yield Problem(
                f"{place}[{index}].at_m",
                "is not after the place before it on the tube: give them from start to end",
            )
    for index, length, end in ((0, lengths[0], 0.0), (-1, lengths[-1], centreline.length)):
        if abs(length - end) > LOCATION_TOLERANCE_M:
            name = "start" if index == 0 else "end"
            position = [round(float(x), 4) for x in centreline.position(end)]
            yield Problem(
                f"{place}[{index % len(values)}].at_m",
                f"is not the {name} of the tube: add a value there, at {position}",
            )
