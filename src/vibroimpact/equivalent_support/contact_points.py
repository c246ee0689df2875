"""The contact of a configuration's supports as other programs take it: points, lands and laws."""

from dataclasses import dataclass

import numpy as np

from vibroimpact.config.schema import Config
from vibroimpact.reduction.modal_model import ModalModel

from .answer import EquivalentError

# Keys of a support whose laws no format has.
WITHOUT_FORMAT = ("plate", "other_point", "preload_N", "hunt_crossley_s_per_m", "hertz_N_per_m15")


@dataclass(frozen=True, eq=False)
class ContactPoint:
    """The contact of one point.

    name: such as "left_3": support and number of the contact point, from 1. position: (3,) m.
    axes: (2, 3) unit vectors across the tube. offset: (3,) m, of the obstacle's centre.
    gap: m. stiffness: N/m. damping: N s/m. friction: Coulomb's coefficient. stick_stiffness: N/m.
    lands: (land, 3) normals of flat lands away from the centre; none for a round hole.
    extra_gap: (land,) m, of the lands beyond the gap.
    lobes: number, depth in m and angle in rad of the lobes of a round hole; 0 lobes for a circle.
    """

    name: str
    position: np.ndarray
    axes: np.ndarray
    offset: np.ndarray
    gap: float
    stiffness: float
    lands: np.ndarray
    extra_gap: np.ndarray | float = 0.0
    damping: float = 0.0
    friction: float = 0.0
    stick_stiffness: float = 0.0
    lobes: tuple[int, float, float] = (0, 0.0, 0.0)

    @property
    def axis(self) -> np.ndarray:
        """The direction (3,) of the tube, which makes a right-handed system with the axes."""
        return np.cross(*self.axes)

    def require_circle(self, program: str) -> None:
        """Raise EquivalentError unless a round hole is a circle round the tube at rest."""
        if self.lobes[0]:
            raise EquivalentError(
                f"{self.name} has rounded lobes, which {program} has not: export flat lands"
                " (broached without depth_m), or code_aster, which takes the outline"
            )
        if np.any(self.offset):
            raise EquivalentError(
                f"{self.name} is a hole off centre, which the export for {program} has not: set"
                " centre_offset_m to 0, or export code_aster"
            )

    @property
    def land_gaps(self) -> np.ndarray:
        """(land,) m: the travel of the tube along the normal of each land until it touches."""
        return self.gap + self.extra_gap + self.lands @ self.offset


@dataclass(frozen=True)
class ContactSet:
    """The contact of all supports. notes: sentences for the head of a file.

    left_out: sentences on the terms that a format does not have.
    """

    title = "Contact of supports"
    warnings = ()

    points: tuple[ContactPoint, ...]
    notes: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()


def contact_set(config: Config, model: ModalModel, gap_m: float) -> ContactSet:
    """Return the ContactSet of a configuration at a gap of the case in m.

    model: of the configuration. Raises EquivalentError for a support that no format can express.
    """
    if not np.any(model.contact_position):
        raise EquivalentError(
            "the supports of this structure have no positions in space (a chain, matrices or"
            " measured modes): give the places of their points in `points`"
        )
    for support in config.supports:
        laws = [key for key in WITHOUT_FORMAT if getattr(support, key) not in (None, 0.0)]
        if laws:
            raise EquivalentError(f"support {support.name}: {laws[0]} is in no export of contact")
    numbers = [
        int((model.support_of_point[:point] == support).sum()) + 1
        for point, support in enumerate(model.support_of_point)
    ]
    points = tuple(_point(model, point, number, gap_m) for point, number in enumerate(numbers))
    for point in points:
        if min([point.gap, *point.land_gaps]) < 0.0:
            raise EquivalentError(
                f"{point.name} touches at rest: an export of contact needs a gap that is not"
                " negative on every side"
            )
    note = f"Contact of the supports of '{config.study}' at a gap of {1e3 * gap_m:.6g} mm."
    return ContactSet(points, (note,))


def _point(model: ModalModel, point: int, number: int, gap_m: float) -> ContactPoint:
    """Return the ContactPoint with an index of the model, the number-th of its support."""
    laws, axes = model.contact_laws, model.contact_directions[point]
    own = laws.gap[point]
    return ContactPoint(
        name=f"{model.support_names[model.support_of_point[point]]}_{number}",
        position=model.contact_position[point],
        axes=axes,
        offset=model.centre_offset[point] @ axes,
        gap=float(gap_m * model.gap_factor[point] if np.isnan(own) else own),
        stiffness=float(model.contact_stiffness[point]),
        damping=float(laws.damping[point]),
        friction=float(laws.friction[point]),
        stick_stiffness=float(laws.stick_stiffness[point]),
        lands=laws.land_normal[laws.land_point == point] @ axes,
        extra_gap=laws.land_extra_gap[laws.land_point == point],
        lobes=(
            int(laws.lobes[point]),
            float(laws.lobe_depth[point]),
            float(laws.lobe_angle[point]),
        ),
    )
