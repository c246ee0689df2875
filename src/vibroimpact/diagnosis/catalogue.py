"""The places and values at which the effects of the catalogue are tried first."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from vibroimpact.effects import places as on_structure
from vibroimpact.effects.effect import Effect, Values

from .constants import FREQUENCY_SD, GAIN_SD, TURN_SD
from .explanations import Term
from .measurement.sensor_chain import NO_CHANNELS

AT_A_POINT = (
    "added_mass",
    "cubic_stiffness",
    "quadratic_stiffness",
    "saturation_stiffness",
    "coulomb_friction",
    "clearance",
    "one_sided_stop",
)
PLACES = 8  # along a tube, for a law that acts at a point; the place is fitted from there
ACROSS_DEG = 90.0
WAYS, TURNS = 8, 4  # directions of an offset, angles within a lobe
LOBES = {"foliate_lands": 4, "foliate_obstacle": 4, "foliate_trefoil": 3, "foliate_hexafoil": 6}
# Logarithm of a factor, within which two good codes of one structure differ: two standard
# deviations of the priors, and the errors of models without a hidden effect on development
# campaigns.
NO_EFFECT = {
    "mode_frequency_error": 2.0 * FREQUENCY_SD,
    "sensor_gain": 2.0 * GAIN_SD,
    "gap": 2.0 * GAIN_SD,  # a gain common to force and responses is a gap
    "modal_damping": 0.6,
    "contact_stiffness": 0.35,
}
NO_CONTACT_DAMPING = 1.5e-5  # s, times the contact stiffness
NO_HUNT_CROSSLEY = 0.5  # over the speed of the drive: half steps of a right model gain by 0.04
LATE_SAMPLES = 0.25  # of a delay that is named


def _ways(*sizes: float) -> list[tuple[float, float]]:
    """Return vectors of some sizes in WAYS directions."""
    angles = np.arange(WAYS) * 2.0 * np.pi / WAYS
    return [(size * np.cos(angle), size * np.sin(angle)) for size in sizes for angle in angles]


def _turned(effect_id: str, *before: float) -> list[tuple[float, ...]]:
    """Return values before an angle, which takes TURNS values within a lobe."""
    return [(*before, turn * 2.0 * np.pi / LOBES[effect_id] / TURNS) for turn in range(TURNS)]


# Multiples of the sizes of the parameters (see effects.effect.SCALES), far from the neutral
# value of the effect: values near it are found from the derivative there.
FAR: dict[str, Sequence[tuple[float, ...]]] = {
    # a fit finds a gap from 5 % above or 13 % below it
    "gap": [
        *((share,) for share in (0.4, 0.47, 0.56, 0.67, 0.8, 0.9)),
        *((share,) for share in (1.1, 1.25, 1.5, 1.8, 2.1, 2.5)),
    ],
    "added_mass": [(0.05,), (0.2,), (0.8,)],
    "contact_stiffness": [(0.02,), (0.2,), (4.0,)],
    "contact_damping": [(3.0e-4,)],
    "hunt_crossley": [(3.0,)],
    "dry_friction": [(0.3,)],
    "modal_damping": [(3.0,)],
    "mode_frequency_error": [(0.85,), (1.18,)],
    "force_misalignment": [(-0.5,), (0.5,)],
    "lateral_stinger": [(0.5, 0.0), (4.0, 0.0)],
    "shaker_interaction": [(0.1, 2.0, 0.0)],
    "cubic_stiffness": [(0.3,), (1.7,), (10.0,)],
    "quadratic_drag": [(0.5,), (3.0,)],
    "fluid_added_mass_damping": [(0.1, 2.0), (0.5, 6.0)],
    "coulomb_friction": [(0.1,), (0.5,)],
    "support_offset": _ways(0.6, 1.2),  # within the gap, and pressed
    "preload": _ways(1.5, 4.0),
    "hertz": [(4.0e-3,), (0.02,), (0.1,)],
    # from pinned ends to clamped ones
    "root_stiffness": [
        (100.0, 3.0),
        *((1.0e4, float(turn)) for turn in np.geomspace(0.2, 20.0, 9)),
    ],
    "saturation_stiffness": [(2.0, 1.0)],
    "clearance": [(0.2, 4.0), (0.6, 4.0), (0.3, 100.0)],
    "one_sided_stop": [(0.2, 4.0), (0.5, 4.0), (1.0, 4.0), (0.2, 100.0), (0.6, 100.0)],
    "foliate_lands": _turned("foliate_lands"),
    "foliate_obstacle": _turned("foliate_obstacle", 0.6),
    "foliate_trefoil": _turned("foliate_trefoil", 0.6),
    "foliate_hexafoil": _turned("foliate_hexafoil", 0.6),
}

# The same at a place that is known. A soft obstacle gains from two thirds of its right distance on.
# The sizes are those of the drive, which may be at a stiff end: springs elsewhere are far softer.
OBSTACLE = [
    *((share, 1.0) for share in (0.2, 0.3, 0.45, 0.7, 1.0, 1.5)),
    *((share, 4.0) for share in (0.45, 0.7)),
    *((near, 100.0) for near in (0.2, 0.6)),
]
AT_A_KNOWN_PLACE: dict[str, Sequence[tuple[float, ...]]] = FAR | {
    "cubic_stiffness": [(3.0e-3,), (0.03,), *FAR["cubic_stiffness"]],
    "saturation_stiffness": [(0.02, 1.0), (0.2, 1.0), *FAR["saturation_stiffness"]],
    "clearance": OBSTACLE,
    "one_sided_stop": OBSTACLE,
}


def locations(
    effect: Effect, values: Values, channels: Sequence[str], across: bool, places: int
) -> list[str]:
    """Return the places at which an effect is tried.

    values: configuration in plain values. channels: names. across: whether the structure is seen
    to move across its force. places: along a tube, for a mass: a heavy one moves all modes, and is
    found only from within a quarter of the shortest wave.
    """
    if effect.measured:
        return [*channels, *NO_CHANNELS]
    length = on_structure.length_m(values)
    if effect.id in AT_A_POINT and length is not None:
        count = _count(effect.id, places)
        turns: tuple[float | None, ...] = (None,)
        if effect.id == "one_sided_stop":
            turns = 0.0, 180.0
        elif across and effect.id != "added_mass":
            turns = None, ACROSS_DEG
        return [
            on_structure.between(length * (number + 0.5) / count, turned)
            for turned in turns
            for number in range(count)
        ]
    return effect.locations(values)


def _count(effect_id: str, places: int) -> int:
    """Return the number of places along a tube at which an effect is tried; places: of a mass."""
    return places if effect_id == "added_mass" else PLACES


def halfway(term: Term, values: Values, places: int) -> list[Term]:
    """Return a term half way to its two neighbours among the trials: to the next places along a
    tube, the next directions or the next angles of lobes; none if it has no such neighbours.
    """
    if term.effect_id in ("support_offset", "preload"):
        whole = complex(*term.values) * np.exp(np.array([-0.5j, 0.5j]) * 2.0 * np.pi / WAYS)
        return [replace(term, values=(float(own.real), float(own.imag))) for own in whole]
    if term.effect_id in LOBES:
        lobe, angle = 2.0 * np.pi / LOBES[term.effect_id], term.values[-1]
        beside = [(angle + own * lobe / TURNS) % lobe for own in (-0.5, 0.5)]
        return [replace(term, values=(*term.values[:-1], float(own))) for own in beside]
    at, length = on_structure.arc_length_m(term.location), on_structure.length_m(values)
    if at is None or length is None or term.effect_id not in AT_A_POINT:
        return []
    half = 0.5 * length / _count(term.effect_id, places)
    turned = on_structure.turned_deg(term.location)
    return [
        replace(term, location=on_structure.between(beside, turned))
        for beside in (at - half, at + half)
        if 0.0 < beside < length
    ]


def far_terms(
    effect: Effect,
    location: str,
    sizes: Mapping[str, float],
    far: Mapping[str, Sequence[tuple[float, ...]]] = FAR,
) -> Iterator[Term]:
    """Yield the terms of an effect at a place that are far from doing nothing; far: see FAR."""
    names = [parameter.name for parameter in effect.parameters]
    for row in far.get(effect.id, ()):
        share = dict(zip(names, row, strict=True))
        values = (
            float(share[each.name] * (share[each.over] if each.over else 1.0) * sizes[each.per])
            for each in effect.parameters
        )
        yield Term(effect.id, location, tuple(values))


def within_priors(term: Term, sampling: float, sizes: Mapping[str, float]) -> bool:
    """Return whether a term is no more than a good model of a measured structure is off by anyway.

    sampling: of the records, Hz. sizes: see sizes.sizes_of.
    """
    value = term.values[0]
    if term.effect_id == "sensor_delay":
        return abs(value) < LATE_SAMPLES / sampling
    if term.effect_id == "force_misalignment":
        return abs(value) < 2.0 * TURN_SD
    if term.effect_id == "contact_damping":
        return value < NO_CONTACT_DAMPING * sizes["contact_stiffness"]
    if term.effect_id == "hunt_crossley":
        return value < NO_HUNT_CROSSLEY * sizes["slowness"]
    if term.effect_id == "contact_stiffness":
        value /= sizes["contact_stiffness"]
    known = NO_EFFECT.get(term.effect_id)
    return known is not None and abs(np.log(value)) < known


def neutral_term(effect: Effect, location: str, sizes: Mapping[str, float]) -> Term | None:
    """Return the term at which an effect does nothing and has a derivative, None if there is
    none.
    """
    if effect.id == "contact_stiffness":
        return Term(effect.id, location, (sizes["contact_stiffness"],))
    neutral = effect.neutral()
    lobed = effect.id in LOBES and effect.id != "foliate_lands"
    if neutral is None or lobed or effect.id == "saturation_stiffness":
        return None
    return Term(effect.id, location, tuple(neutral.values()))


def parts(term: Term, values: Values) -> list[str]:
    """Return places whose derivatives add up to the term's derivative: all supports for "all"."""
    if term.location != "all" or term.effect.measured:
        return [term.location]
    return term.effect.locations(values)[1:] or [term.location]
