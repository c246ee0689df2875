"""A structure known by its measured modes, and the models made of them.

The modes have frequencies, damping ratios, and shapes scaled by the drive point. The response per
unit force is the sum over modes of

    shape drive / (s² + 2 zeta omega s + omega²),

times s² for accelerations. Residual modes below and above the band stand for the mass line and for
the flexibility of the modes that were not measured. Their own frequency and damping have no
meaning. With them the model remains one of masses and springs that can be simulated.
"""

from dataclasses import dataclass, replace

import numpy as np

from vibroimpact.io.units import TIME_DERIVATIVES
from vibroimpact.structure.contact.laws import LocalLaws

from .modal_model import ModalModel


@dataclass(frozen=True, eq=False)
class IdentifiedModes:
    """Measured modes.

    frequency: (mode,) Hz, undamped.
    damping_ratio: (mode,).
    shapes: (mode, channel) in kg^-1/2, per unit modal amplitude in kg^1/2 m.
    drive: index of the channel at the point and along the direction of the force; it scales the
        shapes.
    kinds: (channel,) displacement, velocity, acceleration, or generic, taken as a displacement.
    names: (channel,).
    residual: (mode,) bool.
    """

    frequency: np.ndarray
    damping_ratio: np.ndarray
    shapes: np.ndarray
    drive: int
    kinds: tuple[str, ...]
    names: tuple[str, ...]
    residual: np.ndarray

    @property
    def omega(self) -> np.ndarray:
        """Return (mode,) rad/s."""
        return 2.0 * np.pi * self.frequency

    @property
    def damping(self) -> np.ndarray:
        """Return (mode,) 2 zeta omega in 1/s."""
        return 2.0 * self.damping_ratio * self.omega

    @property
    def modes(self) -> int:
        """Return the number of modes."""
        return self.frequency.size

    def receptance(self, frequency: np.ndarray) -> np.ndarray:
        """Return (mode, line) modal displacement per modal force in s² at frequency (line,) Hz."""
        laplace = 2j * np.pi * np.asarray(frequency, float)
        return 1.0 / (laplace**2 + laplace * self.damping[:, None] + self.omega[:, None] ** 2)

    def sensor_factors(self, frequency: np.ndarray) -> np.ndarray:
        """Return (channel, line): (i omega)^n, the signal of the sensor per unit displacement.

        n is 0, 1 or 2 for displacement, velocity and acceleration; frequency (line,) in Hz.
        """
        laplace = 2j * np.pi * np.asarray(frequency, float)
        return np.stack([laplace ** TIME_DERIVATIVES.get(kind, 0) for kind in self.kinds])

    def frf(self, frequency: np.ndarray, participation: np.ndarray | None = None) -> np.ndarray:
        """Return (channel, line) response per unit force at frequency (line,) Hz.

        participation: (mode,) shapes along the force; those of the drive by default.
        """
        participation = self.shapes[:, self.drive] if participation is None else participation
        displacement = (self.shapes * participation[:, None]).T @ self.receptance(frequency)
        return self.sensor_factors(frequency) * displacement

    def of(self, chosen: np.ndarray) -> "IdentifiedModes":
        """Return some of the modes: their numbers in a new order, or (mode,) bool."""
        return replace(
            self,
            frequency=self.frequency[chosen],
            damping_ratio=self.damping_ratio[chosen],
            shapes=self.shapes[chosen],
            residual=self.residual[chosen],
        )


def modal_model(
    modes: IdentifiedModes,
    participation: np.ndarray,
    laws: LocalLaws | None = None,
    constant_force: float = 0.0,
) -> ModalModel:
    """Return the ModalModel of measured modes with local elements, driven at their drive point.

    Every channel is a sensor, read as a displacement.

    participation: (mode, element) relative displacement of each element per unit modal amplitude.
    laws: LocalLaws of the elements; no force by default.
    constant_force: N at the drive point.
    """
    order = np.argsort(modes.frequency)
    modes, participation, shapes = modes.of(order), participation[order], modes.shapes[order]
    channels, elements = shapes.shape[1], participation.shape[1]
    return ModalModel(
        omega=modes.omega,
        damping=modes.damping,
        drive_shapes=shapes[:, [modes.drive]],
        sensor_shapes=shapes,
        sensor_names=tuple(modes.names),
        sensor_positions=np.zeros((channels, 3)),
        sensor_directions=np.tile([0.0, 0.0, 1.0], (channels, 1)),
        full_mode_frequencies=modes.frequency,
        element_shapes=participation,
        element_names=tuple(f"element_{number + 1}" for number in range(elements)),
        local_laws=laws or LocalLaws.neutral(elements),
        constant_force=constant_force * shapes[:, modes.drive],
    )
