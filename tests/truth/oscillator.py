"""One-degree-of-freedom systems in the truth generator's own march, for the reference cases."""

import numpy as np

from evidence.truth import kernel
from evidence.truth.reduction import exact_propagator
from evidence.truth.rig import LAWS


def simulate(
    mass,
    stiffness,
    force,
    step,
    *,
    damping=0.0,
    start=(0.0, 0.0),
    stops=(),
    laws=(),
    sliders=(),
    stride=1,
):
    """(sample,) displacement m and stop force N on the mass of m x'' + c x' + k x = force (step,)
    with one degree of freedom along y.

    stops: (stiffness N/m, gap m, sides 1 or 2, {column of kernel's table: value} or nothing) of one
    flat stop towards +y, or two; laws: (name, parameters) of local elements; sliders: (kg, N, N/m,
    N/m) of sliding masses; start: x, v.
    """
    modes, row = 8, 1.0 / np.sqrt(mass)
    omega2, rate = np.ones(2 * modes), np.zeros(2 * modes)
    omega2[0], rate[0] = stiffness / mass, damping / mass
    shape = np.zeros((kernel.ROWS, modes))
    shape[0, 0] = row
    plates = np.zeros((len(stops), kernel.PLATE_COLUMNS))
    for table, (contact, gap, sides, *more) in zip(plates, stops, strict=True):
        for column, value in more[0].items() if more else ():
            table[column] = value
        table[[kernel.STIFFNESS, kernel.GAP, kernel.PROFILE, kernel.LOBES, kernel.ANGLE]] = (
            contact,
            gap,
            1,
            sides,
            0.5 * np.pi,
        )
    lift = np.zeros((len(stops), kernel.SHAPES, kernel.NODES))
    share = np.zeros((len(stops), kernel.NODES))
    lift[:, 0, 0], share[:, 0] = 1.0, 1.0
    none = np.zeros((len(stops), kernel.NODES, kernel.NODES))
    contacts = kernel.Contacts(
        lift,
        np.zeros_like(lift),
        share,
        none,
        none,
        np.zeros_like(share),
        np.zeros_like(share),
        shape,
        np.zeros_like(shape),
    )
    rows_of_mass = np.zeros(2 * modes)
    rows_of_mass[0] = row
    rows = np.tile(rows_of_mass, (len(laws), 1))
    empty = np.zeros((0, 2 * modes))
    local = kernel.Locals(
        np.array([LAWS[name] for name, _ in laws], np.int64),
        np.array([[*p, *[0.0] * (4 - len(p))] for _, p in laws]).reshape(-1, 4),
        rows,
        np.zeros((0, 4)),
        empty,
        empty,
        np.array(list(sliders), float).reshape(-1, 4),
        np.tile(rows_of_mass, (len(sliders), 1)),
        np.zeros(0),
        empty,
        empty,
    )
    state = kernel.State(
        np.zeros(2 * modes),
        np.zeros(2 * modes),
        *np.zeros((2, len(stops), kernel.NODES)),
        np.zeros((len(stops), kernel.NODES, kernel.PARTS)),
        *np.zeros((3, len(stops), kernel.NODES)),
        np.zeros(len(laws)),
        np.zeros((len(stops), 4)),
        np.zeros((0, 4)),
        np.zeros((len(sliders), 3)),
    )
    drive = np.zeros(2 * modes)
    drive[0] = row
    state.q[0] = start[0] / row
    state.v[0] = (
        start[1] - 0.5 * step * force[0] / mass
    ) / row  # the first kick is a whole one: half of it belongs before the start
    sensors = np.zeros((kernel.ROWS, 2 * modes))
    sensors[0, 0] = row
    out = np.zeros((len(force) // stride + 1, kernel.ROWS))
    reaction = np.zeros((len(force) // stride + 1, 2 * len(stops)))
    failed = kernel.march(
        modes,
        exact_propagator(omega2, rate, step),
        contacts,
        plates,
        local,
        drive,
        force,
        np.zeros(2 * modes),
        np.zeros(0),
        np.zeros(2 * modes),
        np.ones(1),
        sensors,
        step,
        stride,
        0.0,
        state,
        out,
        reaction,
        np.zeros(len(stops)),
    )
    assert failed == -1
    samples = -(-len(force) // stride)
    return out[:samples, 0], reaction[:samples, 1::2].sum(axis=1)
