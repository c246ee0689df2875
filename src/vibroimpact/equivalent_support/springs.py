"""The springs and dampers to ground that an answer means, at the contact points of the supports."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vibroimpact.identify.linear.support_groups import acting_directions
from vibroimpact.reduction.modal_model import ModalModel

from .answer import Answer, EquivalentError, GroupAnswer, Span

Pair = tuple[float | None, float | None]


@dataclass(frozen=True)
class PointSpring:
    """A spring and a damper to ground in each of the two transverse directions of a point.

    name: such as "left_3": support and number of the contact point, from 1.
    support: name of the support.
    position: (3,) m.
    axes: (2, 3) unit vectors of the two directions.
    k, c: N/m and N s/m along the two directions; None for no spring or damper.
    """

    name: str
    support: str
    position: np.ndarray
    axes: np.ndarray
    k: Pair
    c: Pair


@dataclass(frozen=True)
class SpringSet:
    """All springs of an answer, and the omissions.

    warnings: sentences that no reader of a file may miss. notes: more for its head.
    left_out: sentences on values that are not resolved and therefore not among the springs.
    """

    title = "Springs and dampers to ground"

    springs: tuple[PointSpring, ...]
    warnings: tuple[str, ...]
    notes: tuple[str, ...]
    left_out: tuple[str, ...]


def point_springs(
    answer: Answer, model: ModalModel, points: str = "each", across: str = "same"
) -> SpringSet:
    """Return the SpringSet of an answer on the structure it belongs to.

    The k and c of a support are shared by its contact points with their weights, in both
    transverse directions, as in the linear tube that the methods compare with
    (identify.linear.modes). Unresolved values are left out.

    points: "each" for every contact point, "one" for a single spring at the middle of a support.
    across: "same" gives a transverse direction that the force of the study does not move the k and
        c of the other one; "none" leaves it free. Parallel stops act along their normal alone.

    If k has only an upper bound there is no spring, and a note says so.

    Raises EquivalentError if no k is resolved or bounded, or the structure has no positions in
    space.
    """
    if not np.any(model.contact_position):
        raise EquivalentError(
            "the supports of this structure have no positions in space (a chain, matrices or"
            " measured modes): give the places of their points in `points`, or put k and c there by"
            " hand"
        )
    springs: list[PointSpring] = []
    for number, name in enumerate(model.support_names):
        groups = [group for group in answer.groups if name in group.supports]
        springs += _springs_of_support(model, number, groups, points, across)
    kept = tuple(spring for spring in springs if spring.k != (None, None))
    bounded = {name for group in answer.groups if group.bounded for name in group.supports}
    bare = set(model.support_names) - {item.support for item in kept} - bounded
    bare_words = [f"support {name} has no spring" for name in model.support_names if name in bare]
    left_out = [*answer.unresolved, *bare_words]
    if not kept and not bounded:
        raise EquivalentError(f"nothing to export: {'; '.join(left_out)}")
    bounds = [
        f"no spring along {group.direction} at {', '.join(group.supports)}: per support"
        f" {group.reason_k}"
        for group in answer.groups
        if group.bounded
    ]
    warnings = filter(None, [*answer.warnings, *bounds])
    return SpringSet(kept, tuple(warnings), _notes(answer, across), tuple(left_out))


def _springs_of_support(
    model: ModalModel, number: int, groups: list[GroupAnswer], points: str, across: str
) -> Iterator[PointSpring]:
    """Yield the springs of one support."""
    inside = np.flatnonzero(model.support_of_point == number)
    weight = model.contact_weight[inside]
    support = model.support_names[number]
    if points == "one":
        middle = int(inside[np.argmin(np.abs(np.cumsum(weight) - 0.5))])
        axes, k, c = _along(model, middle, groups, across)
        position = weight @ model.contact_position[inside]
        yield PointSpring(support, support, position, axes, k, c)
        return
    for order, (point, share) in enumerate(zip(inside, weight, strict=True), 1):
        axes, k, c = _along(model, int(point), groups, across)
        position = model.contact_position[point]
        yield PointSpring(
            f"{support}_{order}", support, position, axes, shared(k, share), shared(c, share)
        )


def shared(pair: Pair, share: float) -> Pair:
    """Return the share that one point has of the values of a support."""
    first, second = (None if value is None else share * value for value in pair)
    return first, second


def _along(
    model: ModalModel, point: int, groups: list[GroupAnswer], across: str
) -> tuple[np.ndarray, Pair, Pair]:
    """Return (axes (2, 3), k, c) of the whole support at a point."""
    acting = acting_directions(model, point)
    known = {group.direction: group for group in groups if group.moved}
    found = [known.get(word) for word in acting]
    there = [group for group in found if group is not None]
    if across == "same" and len(there) == 1:
        found = [there[0] for _ in acting]
    axes = [along @ model.contact_directions[point] for along in acting.values()]
    if len(axes) == 1:  # parallel stops: nothing across them
        axes.append(np.cross(np.cross(*model.contact_directions[point]), axes[0]))
        found.append(None)
    (k_first, c_first), (k_second, c_second) = map(_pair_of, found)
    return np.array(axes), (k_first, k_second), (c_first, c_second)


def _pair_of(group: GroupAnswer | None) -> Pair:
    """Return (k, c) of a group; without a k there is no c either."""
    if group is None or not group.k.resolved:
        return None, None
    return group.k.value, group.c.value if group.c.resolved else None


def _notes(answer: Answer, across: str) -> tuple[str, ...]:
    """Return the head of a file."""
    kind = "ESTIMATE from a law, without a simulation" if answer.kind == "estimate" else "study"
    notes = [
        f"Equivalent supports of {kind} '{answer.study}' at {answer.load_rms_N:g} N RMS and a gap"
        f" of {1e3 * answer.gap_m:.6g} mm."
    ]
    for group in filter(lambda group: group.moved, answer.groups):
        if group.bounded:
            continue
        notes.append(
            f"Group {group.group} ({', '.join(group.supports)}) along {group.direction}, per"
            f" support: k {_span_text(group.k, 'N/m')};"
            f" c {_span_text(group.c, 'N s/m')}."
            f" {group.how[:1].upper()}{group.how[1:]}."
        )
    if across == "same":
        notes.append(
            "A transverse direction that the force did not move has the k and c of the other one."
        )
    return tuple(notes)


def _span_text(span: Span, unit: str) -> str:
    if not span.resolved:
        return "unresolved"
    return f"{span.value:.6g} {unit} ({span.low:.4g} to {span.high:.4g})"
