"""The study's tube in OpenSees: elastic beams, gap springs, eigenvalues, Newmark integration.

The nodes follow from the dimensions of the tube alone (legs, bend, plates), not from the project's
mesh. Elements: ElasticTimoshenkoBeam or elasticBeamColumn with consistent mass; contact: two
ElasticPPGap springs in opposite senses at each contact point, across the plane. For a circular hole
and motion across the plane alone this is the project's contact: force k (|y| - gap) beyond the gap,
on both sides.
"""

from dataclasses import dataclass

import numpy as np

from .presence import opensees

NEVER_N = 1.0e12  # yield force of the gap springs, which have one and shall not use it
LAST_INCREMENT_M = 1.0e-14  # at which Newton stops: 1e-10 of the displacements
NEWTON_PASSES = 50
ACROSS = 2  # OpenSees' number of y, across the plane of the tube
NODES_FROM = 1  # number of the first node and element


@dataclass(frozen=True)
class TubeNodes:
    """Nodes of the tube: positions (node, 3) in m, contact points (contact_point,), driven node.

    Contact points and driven node are indices.
    """

    position: np.ndarray
    contact: np.ndarray
    drive: int


def tube_nodes(config, refinement=1):
    """Return the TubeNodes of a U-tube with two supports of several points.

    config: its structure and supports are read.
    refinement: number of parts of each element.

    The drive is at 45 degrees on the left half of the bend. This must be a node: elements_per_bend
    is a multiple of 4.
    """
    tube, (left, right) = config.structure, config.supports
    leg, radius = tube.leg_length_m, tube.bend_radius_m
    bend = np.pi * radius
    plates = [
        np.linspace(
            support.at_m[2] - 0.5 * support.height_m,
            support.at_m[2] + 0.5 * support.height_m,
            support.points,
        )
        for support in (left, right)
    ]
    spans, turns = tube.mesh.elements_per_span, tube.mesh.elements_per_bend
    up = np.concatenate(
        [
            np.linspace(0.0, plates[0][0], spans + 1),
            plates[0][1:],
            np.linspace(plates[0][-1], leg, spans + 1)[1:],
        ]
    )
    other = np.concatenate(
        [
            np.linspace(0.0, plates[1][0], spans + 1),
            plates[1][1:],
            np.linspace(plates[1][-1], leg, spans + 1)[1:],
        ]
    )
    down = 2.0 * leg + bend - other[::-1]
    arc = np.concatenate([up, leg + np.linspace(0.0, bend, turns + 1)[1:], down[1:]])
    fine = np.interp(
        np.arange(refinement * (len(arc) - 1) + 1) / refinement, np.arange(len(arc)), arc
    )
    places = np.concatenate([plates[0], np.sort(2.0 * leg + bend - plates[1])])
    contact = np.abs(fine[None, :] - places[:, None]).argmin(axis=1)
    return TubeNodes(
        np.array([u_tube_position(at, leg, radius) for at in fine]),
        contact,
        int(np.abs(fine - leg - 0.25 * bend).argmin()),
    )


def u_tube_position(arc_length, leg, radius):
    """Return (3,) m: the point of the U-tube at an arc length in m from the left root.

    leg, radius: length of a leg and radius of the bend, m.
    """
    angle = (arc_length - leg) / radius
    if angle <= 0.0:
        return np.array([-radius, 0.0, arc_length])
    if angle < np.pi:
        return np.array([-radius * np.cos(angle), 0.0, leg + radius * np.sin(angle)])
    return np.array([radius, 0.0, leg - (arc_length - leg - np.pi * radius)])


def opensees_frequencies(config, stiffness, count, refinement=1):
    """Return (mode,) Hz, the lowest `count` of OpenSees' tube.

    stiffness: N/m per support in x and y, shared by its points. Raises JudgeAbsent.
    """
    ops = opensees()
    nodes = clamped_tube(ops, config, refinement)
    for number, node in enumerate(nodes.contact):
        ops.uniaxialMaterial("Elastic", number + 1, stiffness / config.supports[0].points)
        tie(ops, nodes, number, node, (1, ACROSS))
    squares = ops.eigen("-fullGenLapack" if len(nodes.position) < 30 else "-genBandArpack", count)
    ops.wipe()
    return np.sqrt(squares) / (2.0 * np.pi)


def opensees_impacts(config, force, steps_per_second, gap, refinement=1):
    """Return (displacement, contact_force), each (contact_point, step), of the impacting tube.

    They are in m, and N on the tube, across its plane.

    force (step,): N across the plane at the 45 degree point; step 0 is the state of rest.
    steps_per_second: 1/s. gap: m.

    Newmark's average acceleration; damping.kind must be rayleigh; in-plane motion is fixed. Raises
    JudgeAbsent; RuntimeError when Newton's method does not converge.
    """
    ops = opensees()
    nodes = clamped_tube(ops, config, refinement)
    for node in range(1, len(nodes.position) - 1):
        ops.fix(NODES_FROM + node, 1, 0, 1, 0, 1, 0)
    stiffness = config.supports[0].stiffness_N_per_m / config.supports[0].points
    for number, node in enumerate(nodes.contact):
        above, below = 2 * number + 1001, 2 * number + 1002
        ops.uniaxialMaterial("ElasticPPGap", above, stiffness, NEVER_N, gap)
        ops.uniaxialMaterial("ElasticPPGap", below, stiffness, -NEVER_N, -gap)
        ops.uniaxialMaterial("Parallel", number + 1, above, below)
        tie(ops, nodes, number, node, (ACROSS,))
    ops.rayleigh(
        config.damping.mass_coefficient_per_s, 0.0, config.damping.stiffness_coefficient_s, 0.0
    )
    ops.timeSeries("Path", 1, "-dt", 1.0 / steps_per_second, "-values", *map(float, force))
    ops.pattern("Plain", 1, 1)
    ops.load(NODES_FROM + nodes.drive, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)
    return _march(ops, nodes, len(force) - 1, 1.0 / steps_per_second)


def _march(ops, nodes, steps, dt):
    """Return (displacement, contact_force), each (contact_point, step)."""
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", LAST_INCREMENT_M, NEWTON_PASSES)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    displacement, force = np.zeros((2, len(nodes.contact), steps + 1))
    for step in range(1, steps + 1):
        if ops.analyze(1, dt) != 0:
            raise RuntimeError(f"OpenSees: Newton did not settle in step {step}")
        for number, node in enumerate(nodes.contact):
            displacement[number, step] = ops.nodeDisp(int(NODES_FROM + node), ACROSS)
            force[number, step] = -ops.basicForce(_spring_number(nodes, number))[0]
    ops.wipe()
    return displacement, force


def clamped_tube(ops, config, refinement):
    """Return the TubeNodes of a configuration, after building its clamped tube in OpenSees.

    ops: the module openseespy.opensees.
    """
    nodes = tube_nodes(config, refinement)
    section, material = config.structure.section, config.structure.material
    outer = 0.5 * section.outer_diameter_m
    inner = 0.5 * section.outer_diameter_m - section.wall_thickness_m
    area, second_moment = np.pi * (outer**2 - inner**2), 0.25 * np.pi * (outer**4 - inner**4)
    young = material.young_modulus_Pa
    shear = 0.5 * material.young_modulus_Pa / (1.0 + material.poisson_ratio)
    sheared, mass = section.shear_coefficient * area, material.density_kg_per_m3 * area
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for number, position in enumerate(nodes.position):
        ops.node(NODES_FROM + number, *map(float, position))
    for end in (0, len(nodes.position) - 1):
        ops.fix(NODES_FROM + end, 1, 1, 1, 1, 1, 1)
    ops.geomTransf("Linear", 1, 0.0, 1.0, 0.0)
    for number in range(len(nodes.position) - 1):
        ends = (NODES_FROM + number, NODES_FROM + number, NODES_FROM + number + 1)
        if config.structure.theory == "timoshenko":
            constants = (
                young,
                shear,
                area,
                2.0 * second_moment,
                second_moment,
                second_moment,
                sheared,
                sheared,
            )
            ops.element("ElasticTimoshenkoBeam", *ends, *constants, 1, "-mass", mass, "-cMass")
        else:
            constants = (area, young, shear, 2.0 * second_moment, second_moment, second_moment)
            ops.element("elasticBeamColumn", *ends, *constants, 1, "-mass", mass, "-cMass")
    return nodes


def _spring_number(nodes, number):
    """Return the number of a contact point's grounded node and of its spring."""
    return NODES_FROM + len(nodes.position) + number


def tie(ops, nodes, number, node, directions):
    """Tie a contact point to the ground with material number + 1 along `directions`."""
    ground = _spring_number(nodes, number)
    ops.node(ground, *map(float, nodes.position[node]))
    ops.fix(ground, 1, 1, 1, 1, 1, 1)
    materials = [number + 1] * len(directions)
    ops.element(
        "zeroLength",
        ground,
        ground,
        int(NODES_FROM + node),
        "-mat",
        *materials,
        "-dir",
        *directions,
    )
