"""A structure known by its measured modes: frequencies, damping ratios and shapes scaled by the
drive point, and the models made of them.

The response per force is sum over modes of shape drive / (s² + 2 zeta omega s + omega²), times s²
for accelerations. What lies outside the band is kept as residual modes, one or more below and
above, whose frequency and damping mean nothing by themselves: they stand for the mass line and the
flexibility of the modes that were not measured, and keep the model a model of masses and springs
that can be simulated.
"""

from dataclasses import dataclass, replace

import numpy as np

from vibroimpact.contact.laws import LocalLaws
from vibroimpact.units import TIME_DERIVATIVES

from .modal_model import ModalModel


@dataclass(frozen=True, eq=False)
class IdentifiedModes:
    """frequency (mode,) Hz undamped; damping_ratio (mode,); shapes (mode, channel) kg^-1/2 (per
    unit modal amplitude in kg^1/2 m).

    drive: index of the channel at the point and in the direction of the force, which scales the
    shapes; kinds (channel,): displacement, velocity, acceleration, or generic, which is taken for a
    displacement; names (channel,); residual (mode,) bool.
    """

    frequency: np.ndarray
    damping_ratio: np.ndarray
    shapes: np.ndarray
    drive: int
    kinds: tuple
    names: tuple
    residual: np.ndarray

    @property
    def omega(self):
        """Return (mode,) rad/s."""
        return 2.0 * np.pi * self.frequency

    @property
    def damping(self):
        """Return (mode,) 2 zeta omega in 1/s."""
        return 2.0 * self.damping_ratio * self.omega

    @property
    def modes(self):
        """Return the number of modes."""
        return self.frequency.size

    def receptance(self, frequency):
        """Return (mode, line) modal displacement per modal force in s² at frequency (line,) Hz."""
        laplace = 2j * np.pi * np.asarray(frequency, float)
        return 1.0 / (laplace**2 + laplace * self.damping[:, None] + self.omega[:, None] ** 2)

    def observed(self, frequency):
        """Return (channel, line): what turns the displacement of each channel into what it
        measures.
        """
        laplace = 2j * np.pi * np.asarray(frequency, float)
        return np.stack([laplace ** TIME_DERIVATIVES.get(kind, 0) for kind in self.kinds])

    def frf(self, frequency, participation=None):
        """Return (channel, line) response per unit force at frequency (line,) Hz: of the drive, or
        with participation (mode,) of any force.
        """
        participation = self.shapes[:, self.drive] if participation is None else participation
        return self.observed(frequency) * (
            (self.shapes * participation[:, None]).T @ self.receptance(frequency)
        )

    def sorted(self):
        """Return the modes in ascending frequency."""
        order = np.argsort(self.frequency)
        return replace(
            self,
            **{
                name: getattr(self, name)[order]
                for name in ("frequency", "damping_ratio", "shapes", "residual")
            },
        )


def modal_model(modes, participation, laws=None, constant_force=0.0):
    """Return the ModalModel of IdentifiedModes, driven at their drive, with local elements.

    participation (mode, element): relative displacement of each element per unit modal amplitude;
    laws: their LocalLaws, none when left out; constant_force N at the drive. Sensors: every
    channel, as displacement.
    """
    order = np.argsort(modes.frequency)
    participation, channels, elements = (
        participation[order],
        modes.shapes.shape[1],
        participation.shape[1],
    )
    empty, shapes = np.zeros, modes.shapes[order]
    return ModalModel(
        omega=modes.omega[order],
        damping=modes.damping[order],
        contact_shapes=empty((modes.modes, 0, 2)),
        contact_directions=empty((0, 2, 3)),
        contact_weight=empty(0),
        support_of_point=empty(0, int),
        support_names=(),
        contact_stiffness=empty(0),
        gap_factor=empty(0),
        centre_offset=empty((0, 2)),
        contact_position=empty((0, 3)),
        drive_shapes=shapes[:, [modes.drive]],
        sensor_shapes=shapes,
        sensor_names=tuple(modes.names),
        sensor_positions=empty((channels, 3)),
        sensor_directions=np.tile([0.0, 0.0, 1.0], (channels, 1)),
        line_shapes=empty((modes.modes, 0)),
        line_positions=empty((0, 3)),
        line_arc_length=empty(0),
        stress_shapes=empty((modes.modes, 0, 2)),
        section_names=(),
        full_mode_frequencies=modes.frequency[order],
        element_shapes=participation,
        element_names=tuple(f"element_{number + 1}" for number in range(elements)),
        local_laws=laws or LocalLaws.neutral(elements),
        constant_force=constant_force * shapes[:, modes.drive],
    )
