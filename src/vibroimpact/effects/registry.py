"""The catalogue: every effect by its id. A new effect needs one line here, its import."""

from collections.abc import Iterable
from types import ModuleType

from . import (
    added_mass,
    clearance,
    contact_damping,
    contact_stiffness,
    coulomb_friction,
    cubic_stiffness,
    dry_friction,
    fluid_added_mass_damping,
    foliate_hexafoil,
    foliate_lands,
    foliate_obstacle,
    foliate_trefoil,
    force_misalignment,
    gap,
    hertz,
    hunt_crossley,
    lateral_stinger,
    modal_damping,
    mode_frequency_error,
    one_sided_stop,
    plate_flexibility,
    preload,
    quadratic_drag,
    quadratic_stiffness,
    root_stiffness,
    saturation_stiffness,
    sensor_delay,
    sensor_gain,
    shaker_interaction,
    support_offset,
)
from .effect import Effect

# The modules imported above, in their order: alphabetical, as the import sorter keeps it.
EFFECTS: dict[str, Effect] = {
    module.EFFECT.id: module.EFFECT
    for module in tuple(globals().values())
    if isinstance(module, ModuleType)
}


def effects_in_words(ids: Iterable[str]) -> str:
    """Return effects in words: dry friction and Hertz contact."""
    return " and ".join(
        EFFECTS[name].name if name in EFFECTS else str(name).replace("_", " ") for name in ids
    )
