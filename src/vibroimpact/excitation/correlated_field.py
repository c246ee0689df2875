"""A random field along an arc length, correlated as exp(-|s - s'| / correlation length): the
covariance of integrals over it, and independent forces that reproduce it.

The correlation is that of a Markov process. The correlation of a stretch with all before it passes
through one number per integral, its weighted part so far, and the double integral over two
stretches is a product. Nothing needs to be resolved on the scale of the correlation length.
"""

from collections.abc import Iterable
from functools import lru_cache

import numpy as np

# Points of a piece at which the functions of the integrals are given, from 0 to 1.
POINTS = 0.5 * (1.0 + np.polynomial.legendre.leggauss(4)[0])
DEPTH = 40.0  # correlation lengths after which exp(-x) is left out: 4e-18
ORDER = 40  # of the quadrature over them


def field_covariance(
    pieces: Iterable[tuple[float, float, np.ndarray]], correlation_length: float
) -> np.ndarray:
    """Return (function, function) the covariance of the integrals of functions times the field.

    The field has a variance of 1. Functions are cubic polynomials in each piece; with them the
    result is exact to round-off.

    pieces: (begin in m, end in m, values (point, function)) in ascending order; they do not
        overlap, and between them the functions are 0. The points are at the shares POINTS of the
        piece.
    correlation_length: m.
    """
    covariance: np.ndarray | float = 0.0
    before: np.ndarray | float = 0.0  # integral so far, each place weighted by its correlation
    last = 0.0
    for begin, end, values in pieces:
        length = end - begin
        within, lead, tail = _piece_integrals(length / correlation_length)
        before = before * np.exp(-(begin - last) / correlation_length)
        shared = np.outer(length * lead @ values, before * np.ones(values.shape[1]))
        covariance = covariance + length**2 * values.T @ within @ values + shared + shared.T
        before = before * np.exp(-length / correlation_length) + length * tail @ values
        last = end
    return np.asarray(covariance)


@lru_cache(maxsize=4096)
def _piece_integrals(length: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (within, lead, tail) of a piece of a length in correlation lengths.

    With l_i the cubic that is 1 at point i and 0 at the others, and x from 0 to 1:

    within (point, point): double integral of l_i(x) l_j(y) exp(-length |x - y|)
    lead (point,): integral of l_i(x) exp(-length x)
    tail (point,): integral of l_i(x) exp(-length (1 - x))
    """
    nodes, weights = np.polynomial.legendre.leggauss(ORDER)
    reach = min(1.0, DEPTH / length)
    distance, weights = 0.5 * reach * (1.0 + nodes), 0.5 * reach * weights
    decay = weights * np.exp(-length * distance)
    # inner integral over x from 0 to 1 - distance, a polynomial of degree 6
    inner_nodes, inner_weights = np.polynomial.legendre.leggauss(4)
    x = 0.5 * (1.0 + inner_nodes) * (1.0 - distance[:, None])  # (distance, x)
    share = decay[:, None] * 0.5 * inner_weights * (1.0 - distance[:, None])
    one = np.einsum("dx,dxi,dxj->ij", share, _cubics(x), _cubics(x + distance[:, None]))
    lead = decay @ _cubics(distance)
    return one + one.T, lead, lead[::-1]


def _cubics(x: np.ndarray) -> np.ndarray:
    """Return (..., point) the cubics that are 1 at one of POINTS and 0 at the others."""
    factors = [[(x - other) / (own - other) for other in POINTS if other != own] for own in POINTS]
    return np.stack([row[0] * row[1] * row[2] for row in factors], axis=-1)


def independent_parts(covariance: np.ndarray, allowed: np.ndarray) -> np.ndarray:
    """Return (function, part): factors of independent parts whose squares add to the covariance.

    A Cholesky factor in the order of the functions. A function whose variance the parts before it
    explain, up to the allowed share, adds no part.

    covariance: (function, function).
    allowed: (function,) largest part of each variance that may be missing.
    """
    rest, parts = covariance.copy(), []
    for row in range(len(rest)):
        if rest[row, row] <= allowed[row]:
            continue
        part = rest[:, row] / np.sqrt(rest[row, row])
        parts.append(part)
        rest -= np.outer(part, part)
    return np.array(parts).reshape(-1, len(covariance)).T
