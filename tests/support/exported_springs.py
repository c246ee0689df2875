"""Small readers of exported springs: file text -> {point: (position (3,), K (3, 3), C (3, 3))}.

K and C are the stiffness and damping matrices to ground in global axes, in the file's units.
"""

import ast
import csv
import io
import json

import numpy as np

AXES = np.eye(3)


def nastran(text):
    """Large-field cards: 8 characters of name, then fields of 16."""
    cards, names, name = [], [], None
    for line in text.splitlines():
        if line.startswith("$"):
            name = line[2:]
            continue
        fields = [line[first : first + 16].strip() for first in range(8, 72, 16)]
        if line[:8].strip() == "*":
            cards[-1][1].extend(fields)
        else:
            cards.append((line[:8].strip().rstrip("*"), fields))
            names.append(name)
    frames, places, properties, found = {0: AXES}, {}, {}, {}
    for kind, fields in cards:
        number = int(fields[0])
        if kind == "CORD2R":
            origin, z, x = np.array(fields[2:11], dtype=float).reshape(3, 3)
            third = (z - origin) / np.linalg.norm(z - origin)
            second = np.cross(third, x - origin)
            second /= np.linalg.norm(second)
            frames[number] = np.array([np.cross(second, third), second, third])
        elif kind == "GRID":
            assert fields[1] == "0" and fields[5] == "0"
            places[number] = np.array(fields[2:5], dtype=float)
        elif kind == "PBUSH":
            rows = {fields[at]: fields[at + 1 : at + 7] for at in (1, 9) if len(fields) > at}
            properties[number] = {
                letter: [float(value or 0.0) for value in row] for letter, row in rows.items()
            }
    for (kind, fields), name in zip(cards, names, strict=True):
        if kind == "CBUSH":
            assert fields[3] == ""  # no second grid: to ground
            values = properties[int(fields[1])]
            axes = frames[int(fields[7])]
            K, C = (
                sum(v * np.outer(axis, axis) for v, axis in zip(values[key], axes, strict=False))
                if key in values
                else np.zeros((3, 3))
                for key in ("K", "B")
            )
            found[name] = (places[int(fields[2])], K, C)
    return found


def abaqus(text):
    """Keyword lines and their data lines."""
    blocks = []
    name = None
    for line in text.splitlines():
        if line.startswith("**"):
            name = line[3:]
        elif line.startswith("*"):
            keyword, *options = line[1:].split(", ")
            blocks.append((keyword, dict(o.split("=") for o in options), [], name))
        else:
            blocks[-1][2].append(line.split(", "))
    places, elements, frames, found = {}, {}, {"": AXES}, {}
    for keyword, options, data, name in blocks:
        if keyword == "NODE":
            places = {row[0]: np.array(row[1:], dtype=float) for row in data}
        elif keyword == "ORIENTATION":
            first, second = np.array(data[0], dtype=float).reshape(2, 3)
            frames[options["NAME"]] = np.array([first, second, np.cross(first, second)])
        elif keyword == "ELEMENT":
            elements[options["ELSET"]] = data[0][1]
        else:
            place = places[elements[options["ELSET"]]]
            axis = frames[options.get("ORIENTATION", "")][int(data[0][0]) - 1]
            _, K, C = found.setdefault(name, (place, np.zeros((3, 3)), np.zeros((3, 3))))
            (K if keyword == "SPRING" else C).__iadd__(float(data[1][0]) * np.outer(axis, axis))
    return found


def code_aster(text):
    """The commands are Python calls; the places are in comments."""
    call = next(n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.Assign)).value
    given = {item.arg: item.value for item in call.keywords}
    places = {}
    for line in text.splitlines():
        if line.startswith("#   ") and ": (" in line:
            name, place = line[4:].split(": ")
            places[name] = np.array(ast.literal_eval(place))

    def factors(name):
        for item in given[name].elts if name in given else []:
            yield {entry.arg: ast.literal_eval(entry.value) for entry in item.keywords}

    frames = {
        item["GROUP_MA"]: np.array(item["VALE"]).reshape(2, 3) for item in factors("ORIENTATION")
    }
    found = {}
    for item in factors("DISCRET"):
        name = item["GROUP_MA"]
        axes = AXES
        if item["REPERE"] == "LOCAL":
            axes = np.vstack([frames[name], np.cross(*frames[name])])
        _, K, C = found.setdefault(name, (places[name], np.zeros((3, 3)), np.zeros((3, 3))))
        matrix = K if item["CARA"] == "K_TR_D_N" else C
        matrix += axes.T @ np.diag(item["VALE"][:3]) @ axes
    return {name.lower(): value for name, value in found.items()}


class RecordedOpenSees:
    """Takes the calls of an exported OpenSees program and keeps them."""

    def __init__(self):
        self.places, self.fixed, self.materials, self.found = {}, set(), {}, {}

    def node(self, tag, *place):
        self.places[tag] = np.array(place)

    def fix(self, tag, *held):
        assert held == (1,) * 6
        self.fixed.add(tag)

    def uniaxialMaterial(self, kind, tag, k, c):
        assert kind == "Elastic"
        self.materials[tag] = (k, c)

    def element(self, kind, tag, ground, node, *options):
        assert kind == "zeroLength" and ground in self.fixed
        at = {name: options.index(name) for name in ("-mat", "-dir", "-orient", "-doRayleigh")}
        materials = options[at["-mat"] + 1 : at["-dir"]]
        directions = options[at["-dir"] + 1 : at["-orient"]]
        first, second = np.reshape(options[at["-orient"] + 1 : at["-doRayleigh"]], (2, 3))
        axes = (first, second, np.cross(first, second))
        K, C = (
            sum(
                self.materials[m][part] * np.outer(axes[d - 1], axes[d - 1])
                for m, d in zip(materials, directions, strict=True)
            )
            for part in (0, 1)
        )
        self.found[node] = (self.places[ground], K, C)


def opensees(text):
    """The program is run with an object that keeps its calls; nodes have the points' names."""
    names = {}
    exec(compile(text, "exported", "exec"), names)  # noqa: S102
    calls = RecordedOpenSees()
    names["add_supports"](calls, {name: name for name in names["POINTS"]})
    return calls.found


def _from_rows(rows):
    found = {}
    for row in rows:
        place = np.array([row["x"], row["y"], row["z"]], dtype=float)
        axis = np.array([row[f"direction_{letter}"] for letter in "xyz"], dtype=float)
        _, K, C = found.setdefault(row["point"], (place, np.zeros((3, 3)), np.zeros((3, 3))))
        K += float(row["k"]) * np.outer(axis, axis)
        C += float(row["c"] or 0.0) * np.outer(axis, axis)
    return found


def csv_table(text):
    """One row per point and direction, after warnings in lines that begin with #."""
    rows = [line for line in io.StringIO(text) if not line.startswith("#")]
    return _from_rows(csv.DictReader(rows))


def json_table(text):
    """The rows under "springs"."""
    return _from_rows(json.loads(text)["springs"])


READERS = {
    "nastran": nastran,
    "abaqus": abaqus,
    "code_aster": code_aster,
    "opensees": opensees,
    "csv": csv_table,
    "json": json_table,
}
