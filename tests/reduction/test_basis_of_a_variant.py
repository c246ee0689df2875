"""Variants that differ at their ends, reduced on the basis of the structure as given."""

import copy
from pathlib import Path

import numpy as np
import pytest
import yaml

from vibroimpact.config.reading import check_config
from vibroimpact.reduction.reduced_model import build_model, reduced_basis
from vibroimpact.structure.tube import build_structure

ROOT = Path(__file__).parents[2]
SMOKE = yaml.safe_load((ROOT / "config" / "smoke.yaml").read_text())


def u_tube(root):
    """The smoke study with another root: a kind, or springs (N/m, N m/rad)."""
    values = copy.deepcopy(SMOKE)
    names = ("translation_N_per_m", "rotation_N_m_per_rad")
    springs = {"kind": "springs", **dict(zip(names, root, strict=False))}
    values["structure"]["root"] = {"kind": root} if isinstance(root, str) else springs
    return check_config(values, "the test")


def receptance(model):
    """(sensor, frequency) below 600 Hz, m/N."""
    omega = 2.0 * np.pi * np.linspace(5.0, 600.0, 400)
    modal = 1.0 / (model.omega[:, None] ** 2 - omega**2 + 1j * omega * model.damping[:, None])
    return model.sensor_shapes.T @ (model.drive_shapes[:, :1] * modal)


@pytest.mark.parametrize("root", [(1e9, 1e6), (1e8, 60.0), (1e6, 400.0), (1e4, 10.0)])
def test_clamps_that_give_way_need_no_basis_of_their_own(root):
    basis, soft = reduced_basis(u_tube("clamped")), u_tube(root)
    own, on_it = build_model(soft), build_model(soft, basis=basis)
    first = own.frequencies[own.frequencies < 1000.0]
    assert on_it.frequencies[: len(first)] == pytest.approx(first, rel=1e-2)
    assert on_it.modes == basis.shapes.shape[1] + 12
    apart = receptance(on_it) - receptance(own)
    assert np.linalg.norm(apart) < 3e-3 * np.linalg.norm(receptance(own))


@pytest.mark.parametrize("given", ["pinned", (1e7, 1e4)])
@pytest.mark.parametrize("root", ["clamped", (1e6, 400.0)])
def test_other_ends_have_a_basis_of_their_own(given, root):
    assert reduced_basis(u_tube(given)).shapes_of(build_structure(u_tube(root))) is None
