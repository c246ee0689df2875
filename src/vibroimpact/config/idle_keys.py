"""Stated keys without effect given the others: each is a sentence with the remedy.

They are sought before a study runs, not when a configuration is read: laws that are moved through 0
are valid.
"""

from collections.abc import Iterator
from typing import Any

from .name_checks import TUBES
from .problems import shown
from .quantities import Section
from .schema import Config, Spectra

OUT = "leave it out"
FORCES = {  # of an element: a term, and the keys that it needs
    "stiffness_N_per_m": None,
    "quadratic_N_per_m2": None,
    "cubic_N_per_m3": None,
    "damping_N_s_per_m": None,
    "drag_N_s2_per_m2": None,
    "slip_limit_N": "stick_stiffness_N_per_m",
    "stick_stiffness_N_per_m": "slip_limit_N",
    "saturation_stiffness_N_per_m": "saturation_limit_N",
    "saturation_limit_N": "saturation_stiffness_N_per_m",
}
BESIDE = FORCES | {"damping_limit_N": "damping_N_s_per_m", "drag_partner": "drag_N_s2_per_m2"}


def idle_keys(config: Config) -> Iterator[str]:
    """Yield a sentence for each stated key without effect, and for each element without force."""
    for index, support in enumerate(config.supports):
        yield from _of_support(f"supports[{index}]", support, config.structure.kind in TUBES)
    yield from _of_elements(config)
    yield from _of_structure(config)
    yield from _of_motion(config)
    yield from _of_outputs(config)


def _idle(place: str, section: Section, keys: str, why: str, remedy: str = OUT) -> Iterator[str]:
    """Yield a sentence for each of the keys that the section has with another value than its
    default, and not 0: that asks for nothing.
    """
    fields = type(section).model_fields
    for key in filter(fields.__contains__, keys.split()):
        value, field = getattr(section, key), fields[key]
        if value and not field.is_required() and value != field.get_default():
            name = f"{place}.{key}".removeprefix(".")
            yield f"{name} = {shown(value)} has no effect: {why}: {remedy}"


def _of_support(place: str, support: Any, on_a_tube: bool) -> Iterator[str]:
    if on_a_tube:
        yield from _idle(place, support, "point other_point", "the support is on a tube, at at_m")
    else:
        why = "the support is of one contact point, on no tube"
        yield from _idle(place, support, "points height_m", why)
    if support.gap_m is not None or support.preload_N is not None:
        given = "gap_m" if support.gap_m is not None else "preload_N"
        yield from _idle(place, support, "gap_factor", f"{given} is given in place of the gap")
    if support.friction == 0.0:
        why = "friction is 0"
        yield from _idle(place, support, "stick_stiffness_ratio", why, f"give friction, or {OUT}")


def _of_elements(config: Config) -> Iterator[str]:
    elements = {element.name: element for element in config.elements}
    partners = {each.drag_partner for each in config.elements if each.drag_N_s2_per_m2}
    for index, element in enumerate(config.elements):
        place = f"elements[{index}]"
        for key, other in BESIDE.items():
            if other is not None and not getattr(element, other):
                yield from _idle(place, element, key, f"{other} is 0", f"give {other}, or {OUT}")
        exerted = any(
            getattr(element, key) and (other is None or getattr(element, other))
            for key, other in FORCES.items()
        )
        if not exerted and element.name not in partners:
            yield (
                f"{place} = '{element.name}' exerts no force: give a stiffness, a damping, a"
                f" drag, or both keys of the slider or of the saturating spring; or {OUT}"
            )
        partner = elements.get(element.drag_partner or "")
        if partner is not None and (why := _apart(element, partner)):
            yield (
                f"{place}.drag_partner = '{partner.name}' {why}: the two rates are those of one"
                " motion in a plane: give an element at the same point in another direction"
            )


def _apart(element: Any, partner: Any) -> str:
    """Return why an element is not a partner of another's drag, "" if it is."""
    if (element.point, element.other_point) != (partner.point, partner.other_point):
        return f"acts at another point, '{partner.point}'"
    one, other = element.direction, partner.direction
    lengths = sum(x * x for x in one) * sum(x * x for x in other)
    along = sum(x * y for x, y in zip(one, other, strict=True)) ** 2
    return "acts along the same line" if along > (1.0 - 1e-9) * lengths else ""


def _of_structure(config: Config) -> Iterator[str]:
    structure: Any = config.structure  # the kinds have other keys
    bends = structure.kind == "u_tube" or any(
        segment.kind == "bend" for segment in getattr(structure, "segments", ())
    )
    if structure.kind in TUBES and not bends:
        why = "the tube has no bend"
        yield from _idle("structure.mesh", structure.mesh, "elements_per_bend", why)
    if structure.kind not in TUBES:
        line, why = config.record.shape_line, "the structure is no tube"
        yield from _idle("record.shape_line", line, "points direction", why)
    if structure.kind in TUBES:
        place, section = "structure.section", structure.section
        if structure.theory == "euler_bernoulli":
            why = "theory euler_bernoulli has no shear deformation"
            yield from _idle(place, section, "shear_coefficient shear_coefficients", why)
        if not structure.fluid:
            yield from _idle(place, section, "enclosed_area_m2", "there is no fluid")
    if structure.kind == "identified":
        yield from _idle("", config, "damping", "measured modes bring their own")


def _of_motion(config: Config) -> Iterator[str]:
    force = config.excitation
    if getattr(force, "turn_deg", None) == 0.0:
        yield from _idle("excitation", force, "turn_about", "turn_deg is 0")
    if config.initial is not None and getattr(force, "obstacles", "moving") == "moving":
        why = "obstacles fixed in space (base_motion) alone see the base"
        yield from _idle(
            "initial", config.initial, "base_displacement_m base_velocity_m_per_s", why
        )
    if not config.supports and not config.elements:
        why = "there are no supports or elements to hold"
        yield from _idle("basis", config.basis, "constrained_modes_to_Hz", why)


def _of_outputs(config: Config) -> Iterator[str]:
    if config.overlay.campaign is not None:
        why = "the campaign is a measured one"
        yield from _idle("overlay", config.overlay, "gap_ratio noise seed", why)
    if not config.supports:
        why = "there are no supports, whose offset it is"
        yield from _idle("integration", config.integration, "imperfection", why)
    if config.record.every_step:
        why = "record.every_step records every step instead"
        yield from _idle("record", config.record, "keep_time_series sampling_frequency_Hz", why)
        yield from _idle("spectra", config.spectra, " ".join(Spectra.model_fields), why)
        why = "runs that keep every step have none"
        yield from _idle("integration", config.integration, "imperfection", why)
