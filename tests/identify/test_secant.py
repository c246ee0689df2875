"""Secant stiffness and damping of simulated contacts: linear supports, preload, oblique stops."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from vibroimpact.identify.linear.support_groups import SupportDirection
from vibroimpact.identify.secant import secant_support, symmetric
from vibroimpact.structure.contact.laws import ContactLaws

SUPPORT = np.repeat([0, 1], 5)
WEIGHT = np.full(10, 0.2)


def model(**changes):
    """Two supports with five contact points each."""
    values = {
        "support_of_point": SUPPORT,
        "contact_weight": WEIGHT,
        "contact_laws": ContactLaws.neutral(10),
        "centre_offset": np.zeros((10, 2)),
        "constant_force": np.zeros(3),
    }
    return SimpleNamespace(**values | changes)


def direction(along):
    rows, along = np.arange(10), np.tile(along, (10, 1))
    return SupportDirection("all", "n", (), np.zeros((0, 10)), rows, along)


def moments(force, displacement, velocity):
    """The moments of signals (point, direction, time), as a record has them."""
    fu, fv = np.mean(force * displacement, -1), np.mean(force * velocity, -1)
    two, one = ("contact_point", "direction"), ("contact_point",)
    values = {
        "force_displacement": (two, fu),
        "contact_power": (two, fv),
        "displacement_square": (two, np.mean(displacement**2, -1)),
        "velocity_square": (two, np.mean(velocity**2, -1)),
        "displacement_product": (one, np.mean(displacement.prod(axis=1), -1)),
        "velocity_product": (one, np.mean(velocity.prod(axis=1), -1)),
        "displacement_mean": (two, np.mean(displacement, -1)),
        "force_mean": (two, np.mean(force, -1)),
    }
    return xr.Dataset(values, attrs={"gap_m": 1.0e-3})


@pytest.fixture
def motion():
    """Displacement and velocity (point, direction, time) of waves without correlation."""
    time = np.arange(4000) / 4000.0
    phase = np.random.default_rng(3).uniform(0.0, 2.0 * np.pi, (10, 2, 1))
    rate = 2.0 * np.pi * np.array([7.0, 11.0])[:, None]
    return np.cos(rate * time + phase), -rate * np.sin(rate * time + phase)


def linear(motion, k, c):
    """The force per point of supports with k and c (2,), the total of a support."""
    share = (WEIGHT * np.array(k)[SUPPORT])[:, None, None]
    loss = (WEIGHT * np.array(c)[SUPPORT])[:, None, None]
    return share * motion[0] + loss * motion[1]


@pytest.mark.parametrize("along", [(1.0, 0.0), (0.0, 1.0)])
def test_a_linear_support_has_its_stiffness_and_damping(motion, along):
    record = moments(linear(motion, (3e5, 3e5), (40.0, 40.0)), *motion)
    found = secant_support(record, model(), direction(along))
    assert (found.k, found.c) == pytest.approx((3e5, 40.0), rel=1e-9)
    assert found.k_standard_error == pytest.approx(0.0, abs=1e-4)


def test_unequal_supports_scatter_about_their_mean(motion):
    record = moments(linear(motion, (2e5, 3e5), (0.0, 0.0)), *motion)
    found = secant_support(record, model(), direction((0.0, 1.0)))
    assert found.k == pytest.approx(2.5e5) and found.k_standard_error == pytest.approx(0.5e5)


def test_a_preload_is_no_stiffness(motion):
    moved = motion[0] + 2.0
    force = linear(motion, (3e5, 3e5), (0.0, 0.0)) - 5.0e6
    loaded = model(constant_force=np.ones(3))
    record = moments(force, moved, motion[1])
    assert secant_support(record, loaded, direction((1.0, 0.0))).k == pytest.approx(3e5)
    assert secant_support(record, model(), direction((1.0, 0.0))).k < 1.0e5


def test_an_oblique_stop_has_the_stiffness_along_its_normal(motion):
    normal = np.array([np.cos(0.5), np.sin(0.5)])
    along = np.einsum("pdt,d->pt", motion[0], normal)
    speed = np.einsum("pdt,d->pt", motion[1], normal)
    force = (3e5 * along + 40.0 * speed)[:, None] * normal[:, None] * WEIGHT[:, None, None]
    found = secant_support(moments(force, *motion), model(), direction(normal))
    assert (found.k, found.c) == pytest.approx((3e5, 40.0), rel=1e-9)


def test_one_sided_stops_and_offsets_are_not_symmetric():
    points, normals = np.zeros(2, int), np.array([[1.0, 0.0], [-1.0, 0.0]])
    two = ContactLaws.neutral(10).with_columns(land_point=points, land_normal=normals)
    one = ContactLaws.neutral(10).with_columns(land_point=points[:1], land_normal=normals[:1])
    assert symmetric(model(), 1e-3) and symmetric(model(contact_laws=two), 1e-3)
    assert not symmetric(model(contact_laws=one), 1e-3)
    assert not symmetric(model(centre_offset=np.full((10, 2), 1e-5)), 1e-3)
