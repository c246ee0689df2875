"""Effects that can be hidden in a rig: one function per id, which changes a Rig in place.

Parameters are in SI and named as in the catalogue. EFFECTS are in the catalogue. OTHER_LAWS follow
a law that the model has not, of a family that it has. STRANGERS are of no family. `place` is a name
of the beam's places or an arc length [m]; `plates` is "both" (or "all"), or the name of one;
`direction` is an axis or a vector.
"""

import numpy as np

from evidence.truth.rig import Element, LooseMass, SlidingMass

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
# The catalogue states the coefficient per contact point of a plate with five points; a Plate has
# the total.
HERTZ_POINTS = 5


def selected(rig, plates):
    """The plates of a rig that an effect acts on."""
    return [plate for plate in rig.plates if plates in ("both", "all", plate.side)]


def vector(direction):
    """(3,) of an axis or a vector."""
    return AXES[direction] if isinstance(direction, str) else tuple(map(float, direction))


def gap(rig, factor=1.25, plates="both"):
    """Radial clearance factor times the nominal."""
    for plate in selected(rig, plates):
        plate.gap_factor *= factor


def contact_stiffness(rig, factor=0.4, plates="both"):
    """Stiffness of the plates factor times the nominal."""
    for plate in selected(rig, plates):
        plate.stiffness *= factor


def contact_damping(rig, damping=200.0, plates="both"):
    """Kelvin-Voigt damping [N s/m per plate]; the force never pulls."""
    for plate in selected(rig, plates):
        plate.damping += damping


def hunt_crossley(rig, alpha=5.0, plates="both"):
    """Force k p max(0, 1 + alpha dp/dt), alpha [s/m]."""
    for plate in selected(rig, plates):
        plate.hunt_crossley += alpha


def hertz(rig, coefficient=2.0e8, plates="both"):
    """Force proportional to p^1.5; coefficient [N/m^1.5] per point of a plate with five."""
    for plate in selected(rig, plates):
        plate.hertz = HERTZ_POINTS * coefficient


def dry_friction(rig, mu=0.2, slip_speed=0.0, plates="both"):
    """Coulomb friction mu of the plates.

    A Dahl bristle, or tanh(v / slip_speed [m/s]) where slip_speed is positive.
    """
    for plate in selected(rig, plates):
        plate.friction = mu
        if slip_speed:
            plate.friction_law, plate.slip_speed = "tanh", slip_speed


def support_offset(rig, offset_x=0.0, offset_y=1.0e-4, plates="both"):
    """Centre of the plates away from the tube [m]."""
    for plate in selected(rig, plates):
        plate.offset = (plate.offset[0] + offset_x, plate.offset[1] + offset_y)


def foliate_obstacle(rig, lobes=4, depth=2.0e-4, angle=0.3, shape="lobes", plates="both"):
    """Hole with `lobes` lands, the first at the angle [rad].

    shape "lobes": arcs with recesses of depth [m] between them; "lands": flat lands.
    """
    for plate in selected(rig, plates):
        plate.profile, plate.lobes, plate.depth, plate.angle = shape, lobes, depth, angle


def preload(rig, force_x=0.0, force_y=5.0, plates="both"):
    """Dead load [N] on the tube at the plates."""
    for plate in selected(rig, plates):
        plate.preload = (plate.preload[0] + force_x, plate.preload[1] + force_y)


def plate_flexibility(rig, mass=0.5, stiffness=2.0e6, plates="both"):
    """Plates of a mass [kg] on a spring [N/m] in x and y."""
    for plate in selected(rig, plates):
        plate.plate_mass, plate.plate_stiffness = mass, stiffness


def root_stiffness(rig, translation=1.0e8, rotation=2.0e4):
    """Both roots on springs [N/m], [N m/rad]."""
    rig.root = (translation, rotation)


def modal_damping(rig, factor=1.8):
    """All damping ratios times factor."""
    rig.damping_factor *= factor


def mode_frequency_error(rig, mode=1, factor=0.97):
    """Frequency of one mode (from 1) times factor."""
    rig.mode_factor[mode] = factor


def added_mass(rig, mass=0.08, place="bend45_right"):
    """A mass [kg] at a place."""
    rig.masses.append((place, mass))


def lateral_stinger(rig, stiffness=2.0e3, damping=0.0, direction="x"):
    """Spring [N/m] and dashpot [N s/m] to ground at the drive, along an axis."""
    rig.springs.append(("drive", vector(direction), stiffness))
    if damping:
        rig.elements.append(Element("linear", "drive", vector(direction), (0.0, damping)))


def fluid_added_mass_damping(rig, mass=0.15, damping=5.0):
    """Mass [kg/m] and damping [N s/m²] of a surrounding fluid, across the tube."""
    rig.fluid = (rig.fluid[0] + mass, rig.fluid[1] + damping)


def cubic_stiffness(rig, stiffness=2.0e10, place="apex", direction="y"):
    """Spring stiffness u³ [N/m³] between a place and the ground."""
    rig.elements.append(Element("cubic", place, vector(direction), (stiffness,)))


def quadratic_stiffness(rig, stiffness=5.0e6, place="apex", direction="y"):
    """Spring stiffness u² [N/m²] between a place and the ground."""
    rig.elements.append(Element("quadratic", place, vector(direction), (stiffness,)))


def saturation_stiffness(rig, stiffness=5.0e3, limit=2.0, place="apex", direction="y"):
    """Spring [N/m] whose force saturates smoothly at the limit [N]."""
    rig.elements.append(Element("saturation", place, vector(direction), (stiffness, limit)))


def quadratic_drag(rig, drag=20.0):
    """Force -drag |v| v [N s²/m² per metre of tube], across it."""
    rig.drag += drag


def coulomb_friction(rig, force=1.0, place="apex", direction="y"):
    """Friction of a limit [N] between a place and the ground: a Dahl bristle, 10 um long."""
    rig.elements.append(Element("coulomb", place, vector(direction), (force, force / 1.0e-5)))


def clearance(rig, half_gap=5.0e-4, stiffness=5.0e4, place="apex", direction="y"):
    """Two stops [N/m] at half_gap [m] on either side of a place."""
    rig.elements.append(Element("clearance", place, vector(direction), (half_gap, stiffness)))


def force_misalignment(rig, angle=0.3):
    """The force turned by angle [rad] about the tube's axis, from y towards the outer side."""
    rig.drive_angle += angle


def loose_mass(rig, mass=0.05, clearance=2.0e-4, place="apex"):
    """A mass [kg] that rattles inside the tube within a clearance [m]."""
    rig.loose.append(LooseMass(place, mass, clearance))


def hysteretic_root(rig, stiffness=3.0e3, limit=0.3, translation=1.0e9, rotation=1.2e4):
    """Roots on springs whose rotation [N m/rad] is partly hysteretic (Bouc-Wen).

    stiffness [N m/rad]: the part that slips at the limit [N m].
    """
    rig.root = (translation, rotation)
    for root in ("left_root", "right_root"):
        for axis in ("rx", "ry"):
            rig.elements.append(Element("bouc_wen", root, axis, (stiffness, limit)))


def drifting_gap(rig, rate=0.01, plates="both"):
    """Gap that grows by the relative rate [1/s] over all records in sequence."""
    for plate in selected(rig, plates):
        plate.gap_rate += rate


def one_sided_stop(rig, distance=4.0e-4, stiffness=2.0e5, place="apex", direction="y"):
    """A stop [N/m] on one side of a place at a distance [m]."""
    rig.elements.append(Element("one_sided", place, vector(direction), (stiffness, distance)))


def unmeasured_force(rig, rms=0.5, place="right_leg_upper", direction="y"):
    """A second random force [N RMS per N RMS of the drive] that is not measured."""
    rig.unmeasured = (place, vector(direction), rms)


def tilted_plate(rig, slope=0.012, direction="y", plates="left"):
    """Plates whose axis is tilted by the slope [rad] against the tube: an edge touches first."""
    for plate in selected(rig, plates):
        plate.tilt = tuple(slope * np.array(vector(direction)[:2]))


def dahl_friction(rig, mu=0.2, stick_ratio=0.2, plates="both"):
    """Friction of a Dahl bristle of stick_ratio times the contact stiffness."""
    for plate in selected(rig, plates):
        plate.friction, plate.friction_law, plate.stick_ratio = mu, "dahl", stick_ratio


def velocity_friction(rig, mu=0.2, slip_speed=2.0e-3, plates="both"):
    """Friction mu tanh(v / slip_speed [m/s])."""
    for plate in selected(rig, plates):
        plate.friction, plate.friction_law, plate.slip_speed = mu, "tanh", slip_speed


def lugre_friction(
    rig, mu=0.2, static_ratio=1.4, stribeck_speed=5.0e-3, stick_time=2.0e-5, plates="both"
):
    """LuGre friction: static_ratio times mu at rest, mu above stribeck_speed [m/s].

    stick_time: damping over stiffness of the bristle, s.
    """
    for plate in selected(rig, plates):
        plate.friction, plate.friction_law, plate.static_ratio = mu, "lugre", static_ratio
        plate.stribeck_speed, plate.stick_time = stribeck_speed, stick_time


def iwan_friction(rig, mu=0.2, stick_ratio=0.7, plates="both"):
    """Friction of four Jenkins elements, the first of which slides at a tenth of the limit."""
    for plate in selected(rig, plates):
        plate.friction, plate.friction_law, plate.stick_ratio = mu, "iwan", stick_ratio


def spring_damper_friction(rig, mu=0.2, stick_ratio=0.5, stick_time=5.0e-5, plates="both"):
    """Friction of a spring and damper in parallel that slide at the limit.

    stick_time: damping over stiffness, s.
    """
    for plate in selected(rig, plates):
        plate.friction, plate.friction_law = mu, "spring_damper"
        plate.stick_ratio, plate.stick_time = stick_ratio, stick_time


def flores_contact(rig, restitution=0.7, plates="both"):
    """Contact damping after Flores: k p (1 + 8 (1 - e) / (5 e) rate over rate at first touch)."""
    for plate in selected(rig, plates):
        plate.approach_damping = 8.0 * (1.0 - restitution) / (5.0 * restitution)


def lankarani_nikravesh_contact(rig, restitution=0.7, plates="both"):
    """Contact damping after Lankarani and Nikravesh: k p (1 + 3 (1 - e²) / 4 rate over that at
    first touch).
    """
    for plate in selected(rig, plates):
        plate.approach_damping = 0.75 * (1.0 - restitution**2)


def flat_lands(rig, count=3, angle=0.3, plates="both"):
    """Hole of `count` flat lands at the gap, the first at the angle [rad]."""
    for plate in selected(rig, plates):
        plate.profile, plate.lobes, plate.angle = "lands", count, angle


def sine_lobes(rig, count=5, depth=2.0e-4, angle=0.3, land=0.1, plates="both"):
    """Hole of `count` lands of half angle `land` [rad] with sine-squared recesses of depth [m]."""
    for plate in selected(rig, plates):
        plate.profile, plate.lobes, plate.depth = "lobes", count, depth
        plate.angle, plate.land_half_angle = angle, land


def breathing_crack(rig, place=0.3, depth=0.5, plane="y"):
    """A crack that opens with one sign of bending: a share `depth` of the bending stiffness of one
    diameter of beam is lost while it is open.
    """
    tube = rig.tube
    length = tube.outer_diameter
    compliance = depth / (1.0 - depth) * length / tube.section["EI"]
    rig.elements.append(Element("breathing", place, f"bend_{plane}", (compliance,)))


def self_excitation(rig, negative=2.0, speed=0.3, place="apex", direction="y"):
    """Force a v - b v³ with a = negative [N s/m], zero again at the speed [m/s]."""
    parameters = (negative, negative / speed**2)
    rig.elements.append(Element("self_excited", place, vector(direction), parameters))


def sliding_mass(rig, mass=0.15, limit=2.0, place="apex", direction="y"):
    """A mass [kg] on a rod along the direction, that slides above a friction limit [N]."""
    rig.sliders.append(SlidingMass(place, vector(direction), mass, limit))


def loosening_support(rig, at=10.0, over=2.0, growth=0.8, plates="both"):
    """Gap that grows by a share from a time of the campaign [s] on, over a duration [s]."""
    for plate in selected(rig, plates):
        plate.loosened = (at, over, growth)


def frequency_drift(rig, rate=3.0e-4):
    """All modal frequencies change by the relative rate [1/s] over all records in sequence."""
    rig.frequency_drift += rate


def parametric_stiffness(
    rig, stiffness=3.0e3, frequency=20.0, phase=0.0, place="apex", direction="y"
):
    """Spring to ground whose stiffness [N/m] swings about zero with a frequency [Hz]."""
    rig.elements.append(
        Element("parametric", place, vector(direction), (stiffness, frequency, phase))
    )


def wrong_section(rig, diameter=1.0, wall=1.0):
    """Diameter and wall of the beam times factors, of which the model knows nothing."""
    tube = rig.tube
    rig.tube = tube.with_changes(
        outer_diameter=diameter * tube.outer_diameter, wall=wall * tube.wall
    )


def wrong_length(rig, factor=1.03):
    """Length of a straight beam, or of both legs, times a factor that the model does not know. The
    drive stays at the same share of it, as channels do.
    """
    tube = rig.tube
    names = ("leg",) if hasattr(tube, "leg") else ("length", "drive")
    rig.tube = tube.with_changes(**{name: factor * getattr(tube, name) for name in names})


EFFECTS = {
    function.__name__: function
    for function in (
        gap,
        contact_stiffness,
        contact_damping,
        hunt_crossley,
        hertz,
        dry_friction,
        support_offset,
        foliate_obstacle,
        preload,
        plate_flexibility,
        root_stiffness,
        modal_damping,
        mode_frequency_error,
        added_mass,
        lateral_stinger,
        fluid_added_mass_damping,
        cubic_stiffness,
        quadratic_stiffness,
        saturation_stiffness,
        quadratic_drag,
        coulomb_friction,
        clearance,
        one_sided_stop,
        force_misalignment,
    )
}
OTHER_LAWS = {
    function.__name__: function
    for function in (
        dahl_friction,
        velocity_friction,
        lugre_friction,
        iwan_friction,
        spring_damper_friction,
        flores_contact,
        lankarani_nikravesh_contact,
        flat_lands,
        sine_lobes,
    )
}
STRANGERS = {
    function.__name__: function
    for function in (
        breathing_crack,
        self_excitation,
        sliding_mass,
        loosening_support,
        frequency_drift,
        parametric_stiffness,
        wrong_section,
        wrong_length,
        loose_mass,
        hysteretic_root,
        drifting_gap,
        unmeasured_force,
        tilted_plate,
    )
}
IN_RIG = EFFECTS | OTHER_LAWS | STRANGERS
FAMILIES = {
    "friction": (
        "dry_friction",
        "dahl_friction",
        "velocity_friction",
        "lugre_friction",
        "iwan_friction",
        "spring_damper_friction",
    ),
    "contact stiffness": ("contact_stiffness", "hertz", "plate_flexibility"),
    "contact damping": (
        "contact_damping",
        "hunt_crossley",
        "flores_contact",
        "lankarani_nikravesh_contact",
    ),
    "clearance and position": ("gap", "support_offset", "preload"),
    "shape of the hole": ("foliate_obstacle", "flat_lands", "sine_lobes"),
    "spring": (
        "root_stiffness",
        "lateral_stinger",
        "cubic_stiffness",
        "quadratic_stiffness",
        "saturation_stiffness",
        "clearance",
        "one_sided_stop",
    ),
    "mass": ("added_mass", "mode_frequency_error"),
    "damping": ("modal_damping", "fluid_added_mass_damping", "coulomb_friction"),
    "drag": ("quadratic_drag",),
    "sensor": ("sensor_gain", "sensor_delay"),
    "force": ("force_misalignment",),
}


def family_of(name):
    """The family of an effect or law, None for a stranger or a fault."""
    return next((family for family, names in FAMILIES.items() if name in names), None)
