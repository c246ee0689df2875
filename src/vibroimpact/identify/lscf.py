"""Polyreference least-squares complex frequency (LSCF) estimator of poles.

A right matrix fraction is fitted to spectra, for many orders at once. Sources: Verboven, PhD
thesis, Vrije Universiteit Brussel 2002; Peeters, Van der Auweraer, Guillaume and Leuridan, Shock
and Vibration 11 (2004) 395. Both fit frequency response functions; here the spectra may also be
half spectra of the output alone.
"""

import numpy as np


class NormalEquations:
    """The normal equations of the estimator up to one order.

    Those of every lower order are a leading part. The model is values_o(f) A(z) = B_o(z) for every
    output o, z = exp(i pi f / f_max), with real polynomials A (reference, reference) and B_o
    (reference,).

    time_step: 1 / (2 f_max) in s.
    references: number of references.
    """

    def __init__(self, frequency: np.ndarray, values: np.ndarray, max_order: int) -> None:
        """Accumulate the equations.

        frequency: (frequency,) Hz, ascending.
        values: (output, reference, frequency), half spectra or frequency responses.
        """
        self.time_step = 1.0 / (2.0 * frequency[-1])
        self.references = values.shape[1]
        powers = np.exp(2j * np.pi * self.time_step * np.outer(np.arange(max_order + 1), frequency))
        # Columns are ordered (power, reference), so that a lower order is a leading part.
        size = (max_order + 1) * self.references
        self._numerator = (powers @ powers.conj().T).real
        self._cross: list[np.ndarray] = []
        self._denominator = np.zeros((size, size))
        for output in values:
            weighted = (powers[:, None, :] * output[None, :, :]).reshape(size, -1)
            self._cross.append((powers.conj() @ weighted.T).real)
            self._denominator += (weighted.conj() @ weighted.T).real

    def poles(self, order: int) -> tuple[np.ndarray, np.ndarray]:
        """Return (poles (pole,) in rad/s, participation (pole, reference)) of one order.

        Poles have a positive imaginary part. The highest coefficient of A is fixed at one, which
        keeps physical poles stable and makes spurious ones decay fast.
        """
        rows, columns = order + 1, (order + 1) * self.references
        cross = np.concatenate([part[:rows, :columns] for part in self._cross], axis=1)
        solved = np.linalg.solve(self._numerator[:rows, :rows], cross)
        matrix = self._denominator[:columns, :columns].copy()  # for A: every B_o is eliminated
        for index in range(len(self._cross)):
            part = slice(index * columns, (index + 1) * columns)
            matrix -= cross[:, part].T @ solved[:, part]
        inner = order * self.references
        companion = np.zeros((inner, inner))
        companion[: inner - self.references, self.references :] = np.eye(inner - self.references)
        # The participation v of a pole solves v^T A(z) = 0, so the companion matrix is that of the
        # transposed polynomial.
        coefficients = np.linalg.solve(matrix[:inner, :inner], matrix[:inner, inner:])
        companion[inner - self.references :] = coefficients.T
        roots, vectors = np.linalg.eig(companion)
        upper = roots.imag > 0.0
        return np.log(roots[upper]) / self.time_step, vectors[: self.references, upper].T
