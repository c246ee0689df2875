"""Polyreference least-squares complex frequency estimator: poles of a right matrix fraction fitted
to spectra, for many orders at once.

Source: Verboven, PhD thesis, Vrije Universiteit Brussel 2002; Peeters, Van der Auweraer, Guillaume,
Leuridan, Shock and Vibration 11 (2004) 395. Both fit frequency response functions; here the spectra
may also be half spectra of the output alone.
"""

import numpy as np


class NormalEquations:
    """The normal equations of the estimator up to one order, of which those of every lower order
    are a leading part.

    The model is values_o(f) A(z) = B_o(z) for every output o, z = exp(i pi f / f_max), with real
    polynomials: A (reference, reference), B_o (reference,). frequency: (frequency,) Hz, ascending;
    values: (output, reference, frequency) complex half spectra or frequency responses. time_step =
    1 / (2 f_max) in s.
    """

    def __init__(self, frequency, values, max_order):
        self.time_step = 1.0 / (2.0 * frequency[-1])
        self.references = values.shape[1]
        powers = np.exp(2j * np.pi * self.time_step * np.outer(np.arange(max_order + 1), frequency))
        # Columns are ordered (power, reference), so that a lower order is a leading part.
        size = (max_order + 1) * self.references
        self._numerator = (powers @ powers.conj().T).real
        self._cross, self._denominator = [], np.zeros((size, size))
        for output in values:
            weighted = (powers[:, None, :] * output[None, :, :]).reshape(size, -1)
            self._cross.append((powers.conj() @ weighted.T).real)
            self._denominator += (weighted.conj() @ weighted.T).real

    def reduced(self, order):
        """Return the matrix ((order+1) reference, (order+1) reference) left for A once every B_o is
        eliminated.
        """
        rows, columns = order + 1, (order + 1) * self.references
        cross = np.concatenate([part[:rows, :columns] for part in self._cross], axis=1)
        solved = np.linalg.solve(self._numerator[:rows, :rows], cross)
        matrix = self._denominator[:columns, :columns].copy()
        for index in range(len(self._cross)):
            part = slice(index * columns, (index + 1) * columns)
            matrix -= cross[:, part].T @ solved[:, part]
        return matrix

    def poles(self, order):
        """Return (poles, participation) of one order: complex (pole,) in rad/s with positive
        imaginary part, and (pole, reference).

        The highest coefficient of A is held at one, which keeps physical poles stable and makes
        spurious ones decay fast.
        """
        matrix = self.reduced(order)
        inner = order * self.references
        companion = np.zeros((inner, inner))
        companion[: inner - self.references, self.references :] = np.eye(inner - self.references)
        # The participation v of a pole solves v^T A(z) = 0: the companion matrix is that of the
        # transposed polynomial.
        companion[inner - self.references :] = np.linalg.solve(
            matrix[:inner, :inner], matrix[:inner, inner:]
        ).T
        roots, vectors = np.linalg.eig(companion)
        kept = roots.imag > 0.0
        return np.log(roots[kept]) / self.time_step, vectors[: self.references, kept].T
