"""Small readers of exported contact: file text -> function of (point, u (3,)) that returns the
force (3,) of the support on the tube displaced by u, in the file's units.
"""

import ast

import numpy as np


def normal_force(direction, gap, stiffness, u):
    """Of a flat land: -k (n·u - gap) n where it is touched."""
    return -stiffness * max(0.0, float(direction @ u) - gap) * np.asarray(direction)


def circle_force(axes, gap, stiffness, d):
    """Of a circle round the origin across the axes (2, 3)."""
    across = axes @ d
    r = np.hypot(*across)
    return -stiffness * (r - gap) * (across / r) @ axes if r > gap else np.zeros(3)


def abaqus(text):
    blocks, name = [], None
    for line in text.splitlines():
        if line.startswith("**"):
            name = line[3:]
        elif line.startswith("*"):
            keyword, *options = line[1:].split(", ")
            blocks.append((keyword, dict(o.split("=") for o in options if "=" in o), [], name))
        else:
            blocks[-1][2].append([part for part in line.split(", ") if part.strip(", ")])
    nodes = [row[0] for keyword, _, data, _ in blocks if keyword == "NODE" for row in data]
    places = {
        row[0]: row[1:] for keyword, _, data, _ in blocks if keyword == "NODE" for row in data
    }
    assert len(nodes) == len(set(nodes))
    frames, elements, sections, laws = {}, {}, {}, {}
    for keyword, options, data, point in blocks:
        if keyword == "ORIENTATION":
            frames[options["NAME"]] = np.array(data[0], dtype=float).reshape(2, 3)
        elif keyword == "ELEMENT":
            assert options["TYPE"] == "CONN3D2"
            _, ground, tube = data[0]
            assert places[ground] == places[tube]
            elements[options["ELSET"]] = point
        elif keyword == "CONNECTOR SECTION":
            kind, frame = (row[0].rstrip(",") for row in data)
            sections[options["ELSET"]] = (kind, frame, options["BEHAVIOR"])
        elif keyword == "CONNECTOR BEHAVIOR":
            law = options["NAME"]
        elif keyword == "CONNECTOR ELASTICITY":
            assert options["COMPONENT"] == "1"
            laws[law] = np.array(data, dtype=float).T

    def force(point, u):
        total = np.zeros(3)
        for group, (kind, frame, behavior) in sections.items():
            if elements[group] != point:
                continue
            forces, displacements = laws[behavior]
            assert np.all(np.diff(displacements) > 0.0)
            axes = frames[frame]
            if kind == "RADIAL-THRUST":
                across = axes @ u
                r = np.hypot(*across)
                total -= np.interp(r, displacements, forces) * (across / r) @ axes
            else:
                assert kind == "CARTESIAN"
                total -= np.interp(axes[0] @ u, displacements, forces) * axes[0]
        return total

    return force


class RecordedOpenSees:
    """Takes the calls of an exported OpenSees program and keeps what gives the forces."""

    def __init__(self):
        self.fixed, self.materials, self.elements = set(), {}, []

    def node(self, tag, *place):
        assert len(place) == 3

    def fix(self, tag, *held):
        assert held == (1,) * 6
        self.fixed.add(tag)

    def uniaxialMaterial(self, kind, tag, *values):
        assert tag not in self.materials
        self.materials[tag] = (kind, values)

    def stress(self, tag, strain):
        kind, values = self.materials[tag]
        if kind == "Parallel":
            return sum(self.stress(part, strain) for part in values)
        stiffness, strength, gap = values
        assert kind == "ElasticPPGap" and abs(strength) > 1e15
        beyond = max(0.0, strain - gap) if strength > 0.0 else min(0.0, strain - gap)
        return stiffness * beyond

    def element(self, kind, tag, ground, node, *options):
        assert ground in self.fixed
        self.elements.append((kind, node, options))


def opensees(text):
    names = {}
    exec(compile(text, "exported", "exec"), names)  # noqa: S102
    calls = RecordedOpenSees()
    names["add_contacts"](calls, {name: name for name in names["POINTS"]})

    def force(point, u):
        total = np.zeros(3)
        for kind, node, options in calls.elements:
            if node != point:
                continue
            if kind == "CoupledZeroLength":
                first, second, material = options
                across = np.zeros(3)
                across[[first - 1, second - 1]] = u[[first - 1, second - 1]]
                r = np.linalg.norm(across)
                sign = -1.0 if across.sum() < 0.0 else 1.0  # as CoupledZeroLength::update
                total -= calls.stress(material, sign * r) * across / (sign * r)
            else:
                assert kind == "zeroLength" and options[:1] + options[2:5] == (
                    "-mat",
                    "-dir",
                    1,
                    "-orient",
                )
                normal = np.array(options[5:8])
                total -= calls.stress(options[1], normal @ u) * normal
        return total

    return force


def local_axes(axis, roll):
    """The three axes of an obstacle of code_aster: nautical angles of NORM_OBST, and ANGL_VRIL."""
    alpha, beta, gamma = (
        np.arctan2(axis[1], axis[0]),
        -np.arctan2(axis[2], np.hypot(*axis[:2])),
        roll,
    )
    rotations = [
        [[np.cos(alpha), np.sin(alpha), 0], [-np.sin(alpha), np.cos(alpha), 0], [0, 0, 1]],
        [[np.cos(beta), 0, -np.sin(beta)], [0, 1, 0], [np.sin(beta), 0, np.cos(beta)]],
        [[1, 0, 0], [0, np.cos(gamma), np.sin(gamma)], [0, -np.sin(gamma), np.cos(gamma)]],
    ]
    return np.array(rotations[2]) @ np.array(rotations[1]) @ np.array(rotations[0])


def code_aster(text, places):
    """places: {point: position}, as the mesh has them."""
    obstacles, terms = {}, []
    for node in ast.parse(text).body:
        name = node.targets[0].id
        if isinstance(node.value, ast.Call):
            obstacles[name] = {k.arg: ast.literal_eval(k.value) for k in node.value.keywords}
        else:
            for call in node.value.elts:
                keys = {k.arg: k.value for k in call.keywords}
                keys["OBSTACLE"] = ast.Constant(keys["OBSTACLE"].id)
                terms.append({name: ast.literal_eval(value) for name, value in keys.items()})

    def force(point, u):
        total = np.zeros(3)
        for term in terms:
            if term["GROUP_NO_1"].lower() != point.lower():
                continue
            axes = local_axes(np.array(term["NORM_OBST"]), np.radians(term["ANGL_VRIL"]))
            y, z = axes[1:] @ (places[point] + u - np.array(term["ORIG_OBST"]))
            gap, obstacle = term["JEU"], obstacles[term["OBSTACLE"]]
            if obstacle["TYPE"] == "PLAN_Z":
                depth, inward = abs(z) - gap, -np.sign(z) * axes[2]
            elif obstacle["TYPE"] == "CERCLE":
                depth, inward = np.hypot(y, z) - gap, -(y * axes[1] + z * axes[2]) / np.hypot(y, z)
            else:
                angle, radius = np.array(obstacle["VALE"]).reshape(-1, 2).T
                own = np.degrees(np.arctan2(z, y)) % 360.0
                depth = np.hypot(y, z) - np.interp(own, angle, radius)
                inward = -(y * axes[1] + z * axes[2]) / np.hypot(y, z)
            total += term["RIGI_NOR"] * max(0.0, depth) * inward
        return total

    force.terms = terms
    return force
