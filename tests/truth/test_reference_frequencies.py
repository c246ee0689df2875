"""The testbed's tables of frequencies, on the truth generator's own elements. Source:
reference/testbed.md, two independent codes agreeing.
"""

import numpy as np
import pytest

from evidence.truth.geometry import TUBES
from evidence.truth.planes import Planes
from evidence.truth.reduction import reduce_rig
from evidence.truth.rig import Rig

# k [N/m per plate] -> out-of-plane and in-plane frequencies in Hz, Timoshenko, five contact points
TIMOSHENKO = {
    1.0: ((15.97, 45.03, 104.68, 171.12), (28.96, 104.45, 171.75)),
    1.0e4: ((16.78, 46.24, 106.61, 173.17), (30.11, 106.38, 173.95)),
    1.0e5: ((20.96, 53.84, 120.96, 190.06), (37.06, 120.45, 191.78)),
    1.0e6: ((26.71, 68.81, 165.43, 275.63), (50.31, 161.98, 279.23)),
    4.0e6: ((27.99, 72.83, 179.92, 316.52), (53.94, 175.26, 320.16)),
    1.0e9: ((33.33, 85.21, 206.12, 368.72), (64.58, 198.91, 372.01)),
}
FIRST_BY_POINTS = {
    4.0e6: {1: 27.751, 2: 28.215, 3: 28.069, 5: 27.993, 9: 27.954},
    1.0e9: {1: 28.186, 2: 33.621, 3: 33.516, 5: 33.331, 9: 33.173},
}


def bilateral(tube, stiffness, points, plane, element_length=0.036):
    """Frequencies in Hz of the tube with each plate a bilateral layer of `stiffness` N/m on
    `points` points.
    """
    planes = Planes(Rig.bare(tube), element_length)
    direction = (0.0, 1.0, 0.0) if plane == "y" else (1.0, 0.0, 0.0)
    tube = tube.with_changes(contact_nodes=points)
    rows = [
        planes.rows(s, direction)[plane]
        for side in ("left", "right")
        for s in tube.plate_nodes(side)
    ]
    return planes.modes(plane, 500.0, [(row, stiffness / points) for row in rows])[0]


@pytest.mark.parametrize("stiffness", TIMOSHENKO)
def test_stand_in_with_bilateral_plates(stiffness):
    for plane, expected in zip(("y", "x"), TIMOSHENKO[stiffness], strict=True):
        found = bilateral(TUBES["stand_in"], stiffness, 5, plane)[: len(expected)]
        np.testing.assert_allclose(found, expected, rtol=1.0e-3)


def test_with_stiff_shear_the_euler_bernoulli_line_comes_back():
    # The rotary inertia stays, which is what is left of the difference.
    stiff = Planes(Rig.bare(TUBES["stand_in"].with_changes(shear_coefficient=50.0))).modes(
        "y", 200.0
    )[0]
    soft = Planes(Rig.bare(TUBES["stand_in"])).modes("y", 200.0)[0]
    assert np.all(stiff > soft)
    np.testing.assert_allclose(stiff[:4], [15.98, 45.10, 105.12, 172.23], rtol=1.0e-3)


def test_contact_compliance_is_that_of_the_finite_elements():
    # Modes to 15 kHz plus the residual give the static compliance of the plate's nodes; the
    # residual alone is below 1 % of 1 / k.
    tube = TUBES["stand_in"]
    reduced = reduce_rig(Rig.bare(tube), [("apex", (0.0, 1.0, 0.0))])
    contacts = reduced.contacts
    rows = contacts.lift_y[0].T @ contacts.shape_y[:4]
    modal = (rows / reduced.omega2[: reduced.split]) @ rows.T
    planes = Planes(Rig.bare(tube), 0.02)
    free = planes.free["y"]
    fine = np.array([planes.rows(s, (0.0, 1.0, 0.0))["y"][free] for s in tube.plate_nodes("left")])
    exact = fine @ np.linalg.solve(planes.stiffness["y"][np.ix_(free, free)], fine.T)
    # Within the plate the compliance of a smooth and of an edge-to-edge load both count.
    for load in (np.ones(7), np.linspace(-1.0, 1.0, 7)):
        found = load @ (modal[:7, :7] + contacts.residual_y[0, :7, :7]) @ load
        assert found == pytest.approx(load @ exact @ load, rel=2.0e-4)
    assert np.linalg.eigvalsh(contacts.residual_y[0]).max() * tube.plate_stiffness / 7 < 0.01


def test_modes_reach_15_khz_twice_the_model():
    frequency = reduce_rig(Rig.bare(TUBES["stand_in"]), [("apex", (0.0, 1.0, 0.0))]).frequency
    assert 14000.0 < frequency.max() <= 15000.0
