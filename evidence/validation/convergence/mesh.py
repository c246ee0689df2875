"""Frequencies of the tube on bilateral springs against the mesh, in both beam theories.

Legs, bend, or both are refined. Expected orders in the element length: for the legs 4 with
Euler-Bernoulli (cubic elements, consistent mass) and 2 with Timoshenko, whose shear angle is
constant along an element; for the bend 2 in both, because a chord is shorter than its arc by the
share theta²/24, theta being the angle of an element.
"""

import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from evidence.validation.check import Check
from vibroimpact.config.reading import changed_config
from vibroimpact.structure.tube import build_structure

from .rate import extrapolated, fitted_order, successive_changes

CASE = "convergence: mesh"
THEORIES = ("euler_bernoulli", "timoshenko")
STIFFNESS = (1.0, 4.0e6, 1.0e9)  # N/m per support
MODES = 7
# Refined part -> (elements per span, elements per bend) from coarse to fine, doubling.
MESHES = {
    "legs": tuple((count, 80) for count in (4, 8, 16, 32)),
    "bend": tuple((20, count) for count in (10, 20, 40, 80, 160)),
    "both": tuple((count, 4 * count) for count in (5, 10, 20, 40)),
}
ORDERS = {
    ("legs", "euler_bernoulli"): 4.0,
    ("legs", "timoshenko"): 2.0,
    ("bend", "euler_bernoulli"): 2.0,
    ("bend", "timoshenko"): 2.0,
    ("both", "euler_bernoulli"): 2.0,
    ("both", "timoshenko"): 2.0,
}
CURVE = ("refined", "theory", "stiffness_N_per_m", "mode")
SHEAR = {("legs", "timoshenko")}
SOURCE = "order of the element; chords in place of arcs"
ORDER_TOLERANCE = 0.1  # absolute
# Relative change of a frequency below which round-off dominates: the matrices have entries of 1e4
# to 1e12 times the first eigenvalue.
ROUND_OFF = 4.0e-9
STATED_MESH = 1.0e-3  # relative: stated accuracy of the stand-in with 20 and 80 elements


def frequencies_on_springs(structure, k, count=MODES):
    """Return (count,) lowest frequencies in Hz of the finite-element tube on bilateral springs.

    k: N/m per support, the same in both directions.
    """
    rows = sparse.csr_array(structure.contact_rows().reshape(-1, structure.dofs))
    weight = sparse.diags_array(k * np.repeat(structure.contact.weight, 2))
    stiffness = structure.stiffness + rows.T @ weight @ rows
    squares = linalg.eigsh(
        stiffness.tocsc(),
        count,
        structure.mass.tocsc(),
        sigma=0.0,
        return_eigenvectors=False,
        v0=np.ones(structure.dofs),
    )
    return np.sqrt(np.sort(squares)) / (2.0 * np.pi)


def mesh_rows(config, refined=tuple(MESHES), theories=THEORIES, stiffness=STIFFNESS):
    """Return one row per refined part, theory, mesh, support stiffness and mode.

    Row keys: refined, theory, elements_per_span, elements_per_bend, size (element length over that
    of the coarsest mesh), stiffness_N_per_m, mode (from 1), frequency_Hz, change (|frequency / that
    of the next finer mesh - 1|, NaN for the finest).
    """
    rows = []
    for part in refined:
        for theory in theories:
            meshes = MESHES[part]
            tubes = [
                build_structure(
                    changed_config(
                        config,
                        {
                            "structure.theory": theory,
                            "structure.mesh.elements_per_span": spans,
                            "structure.mesh.elements_per_bend": bends,
                        },
                    )
                )
                for spans, bends in meshes
            ]
            for k in stiffness:
                table = np.array([frequencies_on_springs(tube, k) for tube in tubes])
                change = np.full(table.shape, np.nan)
                for mode in range(MODES):
                    change[:-1, mode] = successive_changes(table[:, mode]) / table[-1, mode]
                rows += [
                    {
                        "refined": part,
                        "theory": theory,
                        "elements_per_span": spans,
                        "elements_per_bend": bends,
                        "size": 0.5**level,
                        "stiffness_N_per_m": k,
                        "mode": mode + 1,
                        "frequency_Hz": table[level, mode],
                        "change": change[level, mode],
                    }
                    for level, (spans, bends) in enumerate(meshes)
                    for mode in range(MODES)
                ]
    return rows


def mesh_orders(rows):
    """Return one row per refined part, theory, stiffness and mode: the fitted order of convergence.

    Row keys: refined, theory, stiffness_N_per_m, mode, order (NaN for fewer than 2 changes above
    round-off), points (number of changes). For legs with Timoshenko, the change of the
    Euler-Bernoulli tube is subtracted first and the order is that of the shear; the sum of a second
    and a fourth order has none.
    """
    change = {_place(row): row["change"] for row in rows}
    curves = {}
    for row in rows:
        value = row["change"]
        if (row["refined"], row["theory"]) in SHEAR:
            value = value - change[_place({**row, "theory": "euler_bernoulli"})]
        curves.setdefault(_place(row)[:4], []).append((row["size"], value))
    orders = []
    for curve, points in curves.items():
        usable = [(size, value) for size, value in points if value > ROUND_OFF][
            -3:
        ]  # a coarse mesh is not yet in its asymptotic range
        order = fitted_order(*zip(*usable, strict=True)) if len(usable) > 1 else np.nan
        orders.append(
            dict(zip(CURVE, curve, strict=True)) | {"order": order, "points": len(usable)}
        )
    return orders


def mesh_checks(rows):
    """Return the Checks of the orders, and of the study's mesh against the limit of refinement.

    An order is that of the mode farthest from the expected one.
    """
    checks = []
    orders = mesh_orders(rows)
    for part, theory, k in dict.fromkeys(
        (row["refined"], row["theory"], row["stiffness_N_per_m"]) for row in orders
    ):
        expected = ORDERS[part, theory]
        found = [
            row["order"]
            for row in orders
            if _is(row, refined=part, theory=theory, stiffness_N_per_m=k) and row["points"] > 1
        ]
        farthest = max(found, key=lambda order: abs(order - expected))
        name = (
            f"order in the element length, {part} refined,"
            f" {theory}{' (shear part)' if (part, theory) in SHEAR else ''}, k = {k:g} N/m"
        )
        checks.append(Check(CASE, name, "1", expected, SOURCE, farthest, ORDER_TOLERANCE, 1.0))
        if part == "bend":
            checks.append(
                Check(
                    CASE,
                    f"largest relative error of modes 1 to {MODES} at 20 and 80 elements, {theory},"
                    f" k = {k:g} N/m",
                    "1",
                    0.0,
                    "Richardson extrapolation",
                    _stated_mesh_error(rows, theory, k),
                    STATED_MESH,
                    1.0,
                )
            )
    return checks


def _stated_mesh_error(rows, theory, k):
    """Return the largest relative error over the modes of 80 bend elements.

    The reference is the limit of refining the bend.
    """
    errors = []
    for mode in range(1, MODES + 1):
        own = [
            row
            for row in rows
            if _is(row, refined="bend", theory=theory, stiffness_N_per_m=k, mode=mode)
        ]
        limit = extrapolated([row["frequency_Hz"] for row in own], 2.0)
        errors += [
            abs(row["frequency_Hz"] / limit - 1.0) for row in own if row["elements_per_bend"] == 80
        ]
    return float(max(errors))


def _is(row, **values):
    """Return True when the row has these values."""
    return all(row[name] == value for name, value in values.items())


def _place(row):
    """Return what identifies a row: the four keys of its curve, then its size."""
    return tuple(row[name] for name in (*CURVE, "size"))
