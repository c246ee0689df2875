"""Claims on the operational deflection shape: rank, node, phase, and its dependence on damping."""

import numpy as np

from evidence.validation.study_curves import median
from vibroimpact.identify.linear.responses import frf

from .claim import Claim, graded, text

RANK_GROWTH, RANK_FALL = 2.0, 0.75
MOSTLY_REAL = 0.10  # quadrature part of the shape's norm
SAME_SHAPE = 0.99  # MAC


def rank(curves, model):
    """Return the Claim that the response is of rank one at both ends of the load range only."""
    ratio = np.median(curves.singular[:, :, 1] / curves.singular[:, :, 0], axis=1)
    third = np.median(curves.singular[:, :, 2] / curves.singular[:, :, 0], axis=1)
    top = int(np.argmax(ratio))
    full = bool(ratio[top] > RANK_GROWTH * ratio[0] and ratio[-1] < RANK_FALL * ratio[top])
    return Claim(
        "the response is of rank one at both ends and of more in between",
        "4.2",
        "second singular value over the first, around the main peak",
        f"{text([ratio[0]])} at {curves.load[0]:.3g} N, {text([ratio[top]])} at"
        f" {curves.load[top]:.3g} N, {text([ratio[-1]])} at {curves.load[-1]:.3g} N",
        f"maximum inside, above {RANK_GROWTH:g} times the low end, highest load below {RANK_FALL:g}"
        " of it",
        graded(full, bool(ratio[top] > RANK_GROWTH * ratio[0])),
        f"the third follows, {text([third[0]], 2)} to {text([third.max()], 2)}; even in the"
        f" transition the first shape holds {100 / (1 + ratio[top] ** 2 + third[top] ** 2):.1f} %"
        " of the power",
    )


def node_place(shape, arc_length, half):
    """Return the arc length in m of the node between root and apex, NaN without one.

    shape, arc_length (point,): complex, and m. half: arc length of the apex, m.

    It is the highest change of sign.
    """
    real = np.real(shape * np.exp(-0.5j * np.angle(np.sum(shape**2))))
    left = arc_length <= half
    change = np.flatnonzero(np.diff(np.sign(real[left])) != 0)
    if not change.size:
        return np.nan
    i = change[-1]
    return float(
        np.interp(0.0, np.sort(real[i : i + 2]), arc_length[i : i + 2][np.argsort(real[i : i + 2])])
    )


def node_places(curves):
    """Return (load,) m: arc length of the node, median over seeds, NaN without one."""
    half = 0.5 * (curves.arc_length[0] + curves.arc_length[-1])
    return median(
        [[node_place(shape, curves.arc_length, half) for shape in seeds] for seeds in curves.shape]
    )


def node(curves, model):
    """Return the Claim that the node of the shape appears and rises with load.

    curves: at the smallest gap.
    """
    places = node_places(curves)
    seen = np.flatnonzero(np.isfinite(places))
    rising = bool(seen.size > 2 and np.all(np.diff(places[seen]) > -0.005))
    value = (
        f"none below {curves.load[seen[0]]:.3g} N, {places[seen[0]]:.3f} m there,"
        f" {places[seen[-1]]:.3f} m at {curves.load[seen[-1]]:.3g} N (arc length from the root)"
        if seen.size
        else "no node at any load"
    )
    plate = float(np.mean(model.contact_position[model.support_of_point == 0][:, 2]))
    return Claim(
        "the vibration node of the shape rises with load",
        "4.2",
        "sign change of the shape between root and apex, smallest gap",
        value,
        "absent at the lowest load, then never lower by more than 5 mm",
        graded(bool(seen.size and seen[0] > 0 and rising), rising),
        (
            f"it comes up the leg and ends near the plate's mid-height, {plate:.2f} m"
            if rising
            else "it does not rise steadily"
        ),
    )


def quadrature(shape):
    """Return the share of the imaginary part in the norm of a shape (point,).

    The shape is first rotated to be as real as possible.
    """
    turned = shape * np.exp(-0.5j * np.angle(np.sum(shape**2)))
    return float(np.linalg.norm(turned.imag) / np.linalg.norm(turned))


def phase(curves, model):
    """Return the Claim that shapes are mostly real and de-phase in the transition."""
    share = np.array([np.median([quadrature(shape) for shape in seeds]) for seeds in curves.shape])
    top = int(np.argmax(share))
    grows = share[top] > 3.0 * share[0] and top > 0
    return Claim(
        "shapes are mostly real and de-phase in the transition",
        "4.2",
        "quadrature part of the shape's norm",
        f"{text([share[0]], 2)} at {curves.load[0]:.3g} N, {text([share[top]], 2)} at"
        f" {curves.load[top]:.3g} N, {text([share[-1]], 2)} at {curves.load[-1]:.3g} N",
        f"below {MOSTLY_REAL:g} everywhere, maximum inside and above 3 times the low end",
        graded(
            bool(share.max() < MOSTLY_REAL and grows and share[-1] < share[top]),
            bool(share.max() < 2 * MOSTLY_REAL),
        ),
        "the first singular vector stays real at all loads, its quadrature part grows"
        f" {share[top] / share[0]:.1f} times; the de-phasing that an animation shows is in the"
        " further singular vectors",
    )


def no_damping(curves, model):
    """Return the Claim that the shape does not depend on damping.

    The measure is the MAC of the linear tube's shapes with and without the identified c.
    """
    k, c = median(curves.stiffness["broadband"]), median(curves.support_damping["broadband"])
    known = np.flatnonzero(np.isfinite(k) & np.isfinite(c))
    macs, swept = [], []
    for i in known:
        frequency = np.array([median(curves.pole_frequency["lscf"])[i]])
        shapes = [
            frf(model, k[i], damping, frequency, model.line_shapes)[:, 0] for damping in (0.0, c[i])
        ]
        softer = frf(model, 0.75 * k[i], c[i], frequency, model.line_shapes)[:, 0]
        macs.append(_mac(*shapes))
        swept.append(_mac(shapes[1], softer))
    worst = min(macs)
    unresolved = not np.isfinite(curves.support_damping["ods"]).any()
    return Claim(
        "the shape carries no damping",
        "4.2",
        "MAC of the linear tube's shape without and with the identified support damping",
        f"worst {worst:.5f} over {len(known)} loads; a stiffness 25 % lower changes it to"
        f" {min(swept):.5f}",
        f"above {SAME_SHAPE:g}, and no c reported from shapes",
        graded(worst > SAME_SHAPE and unresolved, worst > SAME_SHAPE),
        (
            "ods reports k and leaves c unresolved at every load"
            if unresolved
            else "ods reports a c at some loads"
        )
        + "; c turns the shape's phase as little as a quarter of k moves it, which noise hides",
    )


def _mac(one, other):
    return float(
        abs(np.vdot(one, other)) ** 2 / (np.vdot(one, one).real * np.vdot(other, other).real)
    )
