"""The next measurement if two effects explain a campaign equally well."""

from collections.abc import Collection, Iterable

# Two ids, and the measurement that separates them.
SENTENCES = """
gap sensor_gain
Measure the clearance by itself (feeler gauge or shims), or calibrate the force and one response
channel: gains common to force and responses are a clearance scaled.

hertz contact_stiffness
Repeat at a load five times higher: a Hertz contact stiffens with the indentation, a linear one does
not.

hunt_crossley contact_damping
Repeat at a load five times higher and at a fifth of it: Hunt-Crossley damping grows with the
indentation, viscous damping does not.

added_mass mode_frequency_error
Measure the mode shapes at more points: a mass bends the shapes of all modes where it sits, a
frequency error bends none.

dry_friction foliate_obstacle
Turn the force by 45 degrees: a lobed hole answers by direction, friction in a round hole does not.

coulomb_friction saturation_stiffness
A slow sine up and down through the peak at two levels, and a static load cycle at the place:
friction has a loop, a spring that saturates has none.

support_offset preload
Measure the rest position in the support without force, and repeat at another gap: an offset moves
the centre, a preload bends the tube.
"""


def next_measurement(sets: Collection[Iterable[str]]) -> str | None:
    """Return the sentence for an ambiguity set, lists of ids; None for fewer than two of them."""
    ids = {effect for row in sets for effect in row}
    if len(sets) < 2:
        return None
    for pair, *sentence in map(str.splitlines, SENTENCES.strip().split("\n\n")):
        if ids.issuperset(pair.split()):
            return " ".join(sentence)
    return (
        "Repeat at a lower and a higher load and at a second gap, with sensors across and along"
        f" the force near the supports: {', '.join(sorted(ids))} scale differently with both."
    )
