"""Whether a model is homogeneous of degree one: its response then depends on load over gap alone.

Scaling load and gap by one factor then scales every displacement and force by it, and leaves every
frequency, k and c as they are. Elastic contact, contact damping, Coulomb friction, flat stops,
linear elements and the stops' random offsets (fractions of the gap) keep this; laws with a fixed
length or force do not.
"""

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

# Terms of the contacts and of the local elements that are not of degree one: column -> in words.
CONTACT_TERMS = {
    "hertz": "a Hertzian contact",
    "hunt_crossley": "Hunt-Crossley damping",
    "lobe_depth": "lobes of fixed depth",
}
ELEMENT_TERMS = {
    "quadratic": "quadratic stiffness",
    "cubic": "cubic stiffness",
    "damping_limit": "a damper that stops at a fixed force",
    "drag": "quadratic drag",
    "slip_limit": "a slider of fixed force",
    "saturation_limit": "a spring that saturates at a fixed force",
}


def effects_with_a_scale(model: ModalModel) -> list[str]:
    """Return the parts that make a model inhomogeneous, one phrase each."""
    laws = model.contact_laws
    with np.errstate(invalid="ignore"):
        fixed_gap = np.isfinite(laws.gap) & (laws.gap != 0.0)
    phrases = _at_supports(model, fixed_gap, "a gap fixed in m")
    phrases += _at_supports(model, (model.centre_offset != 0.0).any(axis=1), "an offset in m")
    for column, term in CONTACT_TERMS.items():
        phrases += _at_supports(model, getattr(laws, column) != 0.0, term)
    unequal = np.isin(np.arange(len(laws.gap)), laws.land_point[laws.land_extra_gap > 0.0])
    phrases += _at_supports(model, unequal, "stops with an extra gap in m")
    for column, term in ELEMENT_TERMS.items():
        values = np.asarray(getattr(model.local_laws, column))
        phrases += [
            f"{term} of element {name}"
            for name, value in zip(model.element_names, values, strict=True)
            if value != 0.0
        ]
    if np.any(model.constant_force != 0.0):
        phrases.append("a constant force")
    if np.any(model.initial_displacement != 0.0) or np.any(model.initial_velocity != 0.0):
        phrases.append("an initial state")
    return phrases


def _at_supports(model: ModalModel, point: np.ndarray, term: str) -> list[str]:
    """Return the phrase of a term with the supports that have it at a point, or nothing."""
    names = [model.support_names[number] for number in np.unique(model.support_of_point[point])]
    if not names:
        return []
    return [f"{term} of support{'s' if len(names) > 1 else ''} {', '.join(names)}"]
