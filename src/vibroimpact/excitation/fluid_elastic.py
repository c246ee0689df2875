"""The fluid-elastic force of a flow on one tube of a rigid bundle, with the memory of its wake.

Per length and direction, in a flow of density rho and velocity V across a tube of diameter D,

    F = -rho V²/2 (a0 u + (a1 D/V + d) u' + sum_j b_j z_j),   z_j' = -(gamma_j V/D + r_j) z_j + u'.

One set of coefficients serves all velocities and places. The lags z_j make it a system of ordinary
differential equations: eigenvalues, motion in time and energy balance share it, and no frequency is
assumed, which contact would change.
"""

from dataclasses import dataclass, fields

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart

LAGS_PER_DECADE = 3  # of the force of Connors' law: its damping ripples by 1e-3 then
FITTED = 400  # frequencies of that fit


@dataclass(frozen=True, eq=False)
class FluidLaws:
    """The force on each row of a model at a velocity:

    -(stiffness x + damping x' + sum lag_stiffness z), z' = -lag_rate z + x'.

    A row's motion x is an amplitude along a field, scaled so that half the density is in it, and
    not a displacement: the coefficients are those of a unit of it.

    velocity: (fluid_row,) m/s there.
    stiffness: (fluid_row,) m²/s². damping: (fluid_row,) m²/s.
    lag_stiffness: (fluid_row, lag) m²/s². lag_rate: (fluid_row, lag) 1/s.
    """

    velocity: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    lag_stiffness: np.ndarray
    lag_rate: np.ndarray

    @classmethod
    def neutral(cls) -> "FluidLaws":
        """Return the laws of no row."""
        return cls(*(np.zeros((0, 0) if "lag" in own.name else 0) for own in fields(cls)))

    def __post_init__(self) -> None:
        """Raise ValueError unless all is finite and of one length."""
        for own in fields(self):
            values = getattr(self, own.name)
            if len(values) != len(self.velocity) or not np.isfinite(values).all():
                raise ValueError(
                    f"fluid law {own.name} = {np.asarray(values).tolist()} must be finite, one for"
                    f" each of {len(self.velocity)} rows"
                )


@dataclass(frozen=True, eq=False)
class FluidForce:
    """Coefficients of the force.

    stiffness, damping: a0, a1. amplitudes, rates (lag,): b, gamma. diameter: D in m.
    frozen_damping: d in s. fixed_rates (lag,): r in 1/s; none for 0.
    """

    stiffness: float
    damping: float
    amplitudes: tuple[float, ...]
    rates: tuple[float, ...]
    diameter: float
    frozen_damping: float = 0.0
    fixed_rates: tuple[float, ...] = ()

    def laws(self, velocity: np.ndarray) -> FluidLaws:
        """Return the FluidLaws of rows at velocities (fluid_row,) in m/s."""
        squared, per_s = velocity**2, velocity / self.diameter
        rate = np.outer(per_s, np.asarray(self.rates, float))
        return FluidLaws(
            velocity,
            self.stiffness * squared,
            self.damping * velocity * self.diameter + self.frozen_damping * squared,
            np.outer(squared, np.asarray(self.amplitudes, float)),
            rate + np.asarray(self.fixed_rates, float) if self.fixed_rates else rate,
        )


def fluid_force(own: ConfigPart, diameter: float) -> FluidForce:
    """Return the FluidForce of a section `flow.coupling`; diameter of the tube in m."""
    if own.kind == "quasi_steady":  # the lift follows with a first-order lag mu D/V
        slope = own.lift_slope
        return FluidForce(-slope, own.drag, (slope,), (1.0 / own.delay,), diameter)
    if own.kind == "negative_damping":  # C_d = -4 V_r/K² of Connors' law, frozen at a frequency
        frozen = -4.0 / (own.frequency_Hz * own.constant**2)
        return FluidForce(0.0, 0.0, (), (), diameter, frozen)
    if own.kind == "connors":
        return _connors(own, diameter)
    return FluidForce(own.stiffness, own.damping, own.amplitudes, own.rates, diameter)


def _connors(own: ConfigPart, diameter: float) -> FluidForce:
    """Return lags with the damping of Connors' law, C_d = -4 V_r/K², at every frequency of a band.

    p C_d is then the constant -8 pi i / K². A force that only looks back can not have it without a
    stiffness that drifts with the logarithm of the frequency; a0 makes it 0 in the middle.
    """
    low, high = 2.0 * np.pi * np.asarray(own.band_Hz)
    wanted = -8.0 * np.pi / own.constant**2
    count = 2 + int(np.ceil(LAGS_PER_DECADE * np.log10(high / low)))
    rates = np.geomspace(low / 2.0, 2.0 * high, count)

    def shares(omega: np.ndarray) -> np.ndarray:
        return 1j * omega[:, None] / (1j * omega[:, None] + rates)

    omega = np.geomspace(low, high, FITTED)
    amplitudes = np.linalg.lstsq(shares(omega).imag, np.full(FITTED, wanted), rcond=None)[0]
    middle = np.sqrt(low * high)
    stiffness = -float(shares(np.array([middle])).real[0] @ amplitudes)
    zeros = (0.0,) * count
    return FluidForce(stiffness, 0.0, tuple(amplitudes), zeros, diameter, 0.0, tuple(rates))


def outside_fit(coupling: ConfigPart, velocity: float, mode_Hz: float, diameter: float) -> str:
    """Return that the coefficients are extrapolated for a mode, "" if they are not.

    velocity: m/s. mode_Hz: frequency of the mode. diameter: m.
    """
    fitted = getattr(coupling, "reduced_velocity", None)
    reduced = velocity / (mode_Hz * diameter)
    if fitted is None or fitted[0] <= reduced <= fitted[1]:
        return ""
    return (
        f"flow.coupling.reduced_velocity = {list(fitted)}: at {velocity:g} m/s the mode of"
        f" {mode_Hz:.4g} Hz has a reduced velocity of {reduced:.3g}, and the force is extrapolated:"
        " fit it there"
    )
