"""The plain peer: the same implicit Newmark step as a numba loop over one run, the way one would
first write it.
"""

import numpy as np
from numba import njit


@njit(cache=True, fastmath=True)
def march_plain(
    shapes, drive_shape, coefficients, compliance, stiffness, gap, offset, drive, q, v, passes
):
    """Advance (q, v) in place through the force record drive (step + 1,); return steps with
    contact.

    shapes (row, mode), rows x then y of each point; coefficients (6, mode) of newmark.newmark_map,
    without the loss; compliance (row, row); stiffness (point,); offset (row,); ``passes``
    fixed-point passes per step.
    """
    rows, modes = shapes.shape
    points = rows // 2
    force, new, free, u = np.zeros(rows), np.zeros(rows), np.zeros(rows), np.zeros(rows)
    touched = 0
    for n in range(drive.size - 1):
        f = drive[n] + drive[n + 1]
        for r in range(rows):
            free[r] = 0.0
        for i in range(modes):
            ahead = (
                coefficients[3, i] * q[i]
                + coefficients[4, i] * v[i]
                + coefficients[5, i] * drive_shape[i] * f
            )
            for r in range(rows):
                free[r] += shapes[r, i] * ahead
        for r in range(rows):
            new[r] = force[r]
        for _ in range(passes):
            for r in range(rows):
                total = free[r]
                for s in range(rows):
                    total += compliance[r, s] * (force[s] + new[s])
                u[r] = total
            for p in range(points):
                d1, d2 = u[2 * p] - offset[2 * p], u[2 * p + 1] - offset[2 * p + 1]
                distance = np.sqrt(d1 * d1 + d2 * d2)
                if distance > gap:
                    k = -stiffness[p] * (distance - gap) / distance
                    new[2 * p], new[2 * p + 1] = k * d1, k * d2
                    touched += 1
                else:
                    new[2 * p] = new[2 * p + 1] = 0.0
        for i in range(modes):
            total = drive_shape[i] * f
            for r in range(rows):
                total += shapes[r, i] * (force[r] + new[r])
            velocity = (
                coefficients[0, i] * v[i] + coefficients[1, i] * q[i] + coefficients[2, i] * total
            )
            q[i] = (
                coefficients[3, i] * q[i] + coefficients[4, i] * v[i] + coefficients[5, i] * total
            )
            v[i] = velocity
        for r in range(rows):
            force[r] = new[r]
    return touched
