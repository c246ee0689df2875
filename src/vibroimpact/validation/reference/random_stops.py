"""R11: an oscillator between two elastic stops under white noise, with an exact stationary law.

m x'' + c x' + k x + Kc (excess over the gap g) = w, white. The joint density is exp(-(m v²/2 +
U(x)) / T), T = pi S0 / c, whatever the damping. Source: the stationary solution of the
Fokker-Planck equation (Caughey 1963). In units m = k = g = 1 the law depends on s0 = sqrt(T), the
RMS displacement without stops over the gap, and on r = Kc / k.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad
from scipy.special import erfc

from vibroimpact.validation.check import Check

SOURCE = "exact, Fokker-Planck"
LARGEST_STANDARD_ERROR = {"contact probability": 0.01}  # relative; 0.005 for all other quantities
STANDARD_ERRORS = 3.0


@dataclass(frozen=True)
class StopLaw:
    """Stationary statistics in units of m = k = g = 1.

    They are RMS displacement, contact probability, RMS stop force, and upcrossings of +g per time.
    """

    displacement_rms: float
    contact_probability: float
    force_rms: float
    upcrossing_rate: float


def exact_law(sigma: float, ratio: float) -> StopLaw:
    """Return the StopLaw for sigma = s0 and ratio = Kc / k, by quadrature of exp(-U / T)."""
    temperature = sigma**2

    def weight(x):
        return np.exp(-(0.5 * x**2 + 0.5 * ratio * max(x - 1.0, 0.0) ** 2) / temperature)

    def integral(function, low, high):
        return quad(
            lambda x: function(x) * weight(x), low, high, epsabs=0.0, epsrel=1e-12, limit=400
        )[0]

    far = 1.0 + 12.0 * sigma
    free, stopped = integral(lambda x: 1.0, 0.0, 1.0), integral(lambda x: 1.0, 1.0, far)
    total = free + stopped
    square = (integral(lambda x: x**2, 0.0, 1.0) + integral(lambda x: x**2, 1.0, far)) / total
    force = ratio**2 * integral(lambda x: (x - 1.0) ** 2, 1.0, far) / total
    return StopLaw(
        displacement_rms=np.sqrt(square),
        contact_probability=stopped / total,
        force_rms=np.sqrt(force),
        # mean of positive velocity, sigma_v = s0, times the density at the gap (half of the total
        # lies on each side)
        upcrossing_rate=sigma / np.sqrt(2.0 * np.pi) * weight(1.0) / (2.0 * total),
    )


def gaussian_linearisation(sigma: float, ratio: float) -> tuple[float, float]:
    """Return (RMS displacement, equivalent stiffness) of Gaussian statistical linearisation.

    Units are m = k = g = 1. k_eq = 1 + r erfc(1 / (s sqrt 2)), s² = T / k_eq, by bisection on s.
    Source: Roberts and Spanos 1990.
    """
    low, high = 1e-6, sigma
    for _ in range(200):
        s = 0.5 * (low + high)
        stiffness = 1.0 + ratio * erfc(1.0 / (s * np.sqrt(2.0)))
        low, high = (s, high) if s**2 * stiffness < sigma**2 else (low, s)
    return s, stiffness


def step_error(ratio: float, omega_step: float) -> float:
    """Return the relative error of the statistics due to the step: (omega_c dt)² / 3.

    omega_c is the frequency on the stop. Average acceleration lowers the frequency by (omega_c dt)²
    / 12; the mean of the noise at both ends of a step has the power cos²(omega_c dt / 2) of white
    noise, (omega_c dt)² / 4 less. It is derived, not fitted.
    """
    return (1.0 + ratio) * omega_step**2 / 3.0


def law_checks(
    records, sigma: float, ratio: float, omega: float, gap: float, stop: int = 0
) -> list[Check]:
    """Return the Checks of records of one (sigma, ratio), one per seed, against the exact law.

    records: list of record datasets (records.VARIABLES); omega rad/s and gap m: units of the run;
    stop: index of the support. Two Checks per quantity: the error, within 3 standard errors plus
    the step's, and the standard error itself against its limit.
    """
    law, mass_force = exact_law(sigma, ratio), omega**2 * gap  # N for a mass of 1 kg
    measured = {
        "RMS displacement": (
            law.displacement_rms,
            lambda r: np.sqrt(r["displacement_square"].values[stop, 0]) / gap,
            "gap",
        ),
        "contact probability": (
            law.contact_probability,
            lambda r: r["contact_fraction"].values[stop],
            "1",
        ),
        "RMS stop force": (
            law.force_rms,
            lambda r: r["rms_force"].values[stop] / mass_force,
            "k gap",
        ),
        "upcrossings of the gap": (
            law.upcrossing_rate,
            lambda r: 0.5 * r["impact_rate"].values[stop] / omega,
            "omega",
        ),
    }
    checks = []
    for quantity, (reference, read, unit) in measured.items():
        values = np.array([read(record) for record in records], dtype=float)
        spread = values.std(ddof=1) / np.sqrt(len(values)) / reference
        of_step = step_error(ratio, omega / records[0].attrs["steps_per_second"])
        label = f"{quantity}, s0 = {sigma:g}, r = {ratio:g}"
        checks.append(
            Check(
                "R11",
                label,
                unit,
                reference,
                SOURCE,
                values.mean(),
                STANDARD_ERRORS * spread + of_step,
            )
        )
        limit = LARGEST_STANDARD_ERROR.get(quantity, 0.005)
        checks.append(
            Check("R11", f"standard error of {label}", "1", 0.0, "asked", spread, limit, scale=1.0)
        )
    return checks
