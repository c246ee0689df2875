"""R11: an oscillator against elastic stops under white noise, with an exact stationary law.

m x'' + c x' + k x + Kc (excess over the gap g) = w, white. The joint density is exp(-(m v²/2 +
U(x)) / T), T = pi S0 / c, whatever the damping. Source: the stationary solution of the
Fokker-Planck equation (Caughey 1963). In units m = k = g = 1 the law depends on s0 = sqrt(T), the
RMS displacement without stops over the gap, on r = Kc / k, and on whether there is a stop on one
side or on both.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy.integrate import quad
from scipy.special import erfc

from evidence.validation.check import Check
from vibroimpact.identify.linear.support_groups import support_directions
from vibroimpact.identify.secant import secant_support
from vibroimpact.identify.statistical_linearisation import statistical_linearisation
from vibroimpact.reduction.modal_model import ModalModel

SOURCE = "exact, Fokker-Planck"
# Relative; 0.005 for all other quantities.
LARGEST_STANDARD_ERROR = {"contact probability": 0.01, "mean displacement": 0.01}
STANDARD_ERRORS = 3.0
LINEARISATION_TOLERANCE = 1.0e-3


@dataclass(frozen=True)
class StopLaw:
    """Stationary statistics in units of m = k = g = 1.

    They are mean displacement, RMS displacement about it, contact probability, RMS stop force,
    upcrossings of +g per time, and the stiffness T / sigma_x² of the linear oscillator with the
    same RMS displacement.
    """

    displacement_mean: float
    displacement_rms: float
    contact_probability: float
    force_rms: float
    upcrossing_rate: float
    equivalent_stiffness: float


@dataclass(frozen=True)
class StopCase:
    """An oscillator against stops: s0 and r, and the units of its run.

    omega: rad/s, without stops.
    gap: m.
    sides: 2 for stops on both sides, 1 for one at +gap.
    """

    sigma: float
    ratio: float
    omega: float
    gap: float
    sides: int = 2

    @property
    def label(self) -> str:
        """What names the case in a table."""
        one = ", one stop" if self.sides == 1 else ""
        return f"s0 = {self.sigma:g}, r = {self.ratio:g}{one}"


def exact_law(sigma: float, ratio: float, sides: int = 2) -> StopLaw:
    """Return the StopLaw for sigma = s0 and ratio = Kc / k, by quadrature of exp(-U / T).

    sides: 2 for stops on both sides, 1 for one at +1.
    """
    temperature = sigma**2
    far = 1.0 + 12.0 * sigma
    left = [(-far, -1.0), (-1.0, 0.0)] if sides == 2 else [(-far, 0.0)]

    def excess(x: float) -> float:
        return max(x - 1.0, 0.0) - (max(-x - 1.0, 0.0) if sides == 2 else 0.0)

    def weight(x: float) -> float:
        return float(np.exp(-(0.5 * x**2 + 0.5 * ratio * excess(x) ** 2) / temperature))

    def integral(function: Callable[[float], float]) -> float:
        return sum(
            quad(lambda x: function(x) * weight(x), *part, epsabs=0.0, epsrel=1e-12, limit=400)[0]
            for part in (*left, (0.0, 1.0), (1.0, far))
        )

    total = integral(lambda x: 1.0)
    mean = integral(lambda x: x) / total if sides == 1 else 0.0
    square = integral(lambda x: (x - mean) ** 2) / total
    return StopLaw(
        displacement_mean=mean,
        displacement_rms=np.sqrt(square),
        contact_probability=integral(lambda x: float(excess(x) != 0.0)) / total,
        force_rms=np.sqrt(ratio**2 * integral(lambda x: excess(x) ** 2) / total),
        # mean of positive velocity, sigma_v = s0, times the density at the gap
        upcrossing_rate=sigma / np.sqrt(2.0 * np.pi) * weight(1.0) / total,
        equivalent_stiffness=temperature / square,
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


def law_checks(records: Sequence[xr.Dataset], case: StopCase, model: ModalModel) -> list[Check]:
    """Return the Checks of records of one StopCase, one record per seed, against the exact law.

    Two Checks per quantity: the error, within 3 standard errors plus the step's, and the standard
    error itself against its limit.

    records: with the statistics of record_variables.VARIABLES; the first support is the stop.
    """
    law = exact_law(case.sigma, case.ratio, case.sides)
    checks = []
    for quantity, (reference, read, unit) in _measured(law, case, model).items():
        values = np.array([read(record) for record in records], dtype=float)
        spread = values.std(ddof=1) / np.sqrt(len(values)) / abs(reference)
        of_step = step_error(case.ratio, case.omega / records[0].attrs["steps_per_second"])
        label = f"{quantity}, {case.label}"
        tolerance = STANDARD_ERRORS * spread + of_step
        checks.append(Check("R11", label, unit, reference, SOURCE, values.mean(), tolerance))
        limit = LARGEST_STANDARD_ERROR.get(quantity, 0.005)
        checks.append(
            Check("R11", f"standard error of {label}", "1", 0.0, "asked", spread, limit, scale=1.0)
        )
    return checks


def _measured(
    law: StopLaw, case: StopCase, model: ModalModel
) -> dict[str, tuple[float, Callable[[xr.Dataset], float], str]]:
    """Return {quantity: (reference, function of a record, unit)} in units of m = k = g = 1."""
    gap, mass_force = case.gap, case.omega**2 * case.gap  # N for a mass of 1 kg
    (direction,) = support_directions(model, "all")

    def mean(record: xr.Dataset) -> float:
        return record["displacement_mean"].values[0, 0] if case.sides == 1 else 0.0

    def stiffness(record: xr.Dataset) -> float:
        return 1.0 + secant_support(record, model, direction).k / case.omega**2

    rms = "RMS displacement" if case.sides == 2 else "RMS displacement about the mean"
    found: dict[str, tuple[float, Callable[[xr.Dataset], float], str]] = {
        rms: (
            law.displacement_rms,
            lambda r: np.sqrt(r["displacement_square"].values[0, 0] - mean(r) ** 2) / gap,
            "gap",
        ),
        "contact probability": (
            law.contact_probability,
            lambda r: r["contact_fraction"].values[0],
            "1",
        ),
        "RMS stop force": (
            law.force_rms,
            lambda r: r["rms_force"].values[0] / mass_force,
            "k gap",
        ),
        "upcrossings of the gap": (
            law.upcrossing_rate,
            lambda r: r["impact_rate"].values[0] / case.sides / case.omega,
            "omega",
        ),
        "equivalent stiffness, by secant": (law.equivalent_stiffness, stiffness, "k"),
    }
    if case.sides == 1:
        found["mean displacement"] = (law.displacement_mean, lambda r: mean(r) / gap, "gap")
    return found


def linearisation_check(case: StopCase, load_rms_N: float, rate: float, model: ModalModel) -> Check:
    """Return the Check of the library's Gaussian statistical linearisation between two stops.

    load_rms_N: of white noise at `rate` steps per second, that is of a PSD up to half of it.
    """
    found = statistical_linearisation(model, load_rms_N, case.gap, (1.0e-6, 0.5 * rate))
    return Check(
        "R11",
        f"equivalent stiffness, by statistical linearisation, {case.label}",
        "k",
        gaussian_linearisation(case.sigma, case.ratio)[1],
        "closed form",
        1.0 + found.k / case.omega**2,
        LINEARISATION_TOLERANCE,
    )
