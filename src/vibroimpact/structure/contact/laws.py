"""The local force laws of a model: contacts at the supports, and local elements.

Every law is a table with a column per parameter and a row per contact point or local element.
Neutral values switch a term off. docs/method.md writes the laws out.
"""

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np


@dataclass(frozen=True, eq=False)
class ContactLaws:
    """The terms of the contacts beyond an elastic circular obstacle.

    All arrays but the last three are (contact_point,). With p the penetration in m:

    gap: m; NaN for the case's gap times the point's gap_factor.
    damping: N s/m; the force is max(0, k p + damping dp/dt).
    hunt_crossley: s/m; the force is k p max(0, 1 + hunt_crossley dp/dt).
    hertz: N/m^1.5; if it is not 0, the force is hertz p^1.5 instead of k p.
    friction: Coulomb coefficient.
    stick_stiffness: N/m, of the elastic stick spring of the friction.
    lobes, lobe_depth (m), lobe_angle (rad): the obstacle is
        r(theta) = gap + lobe_depth (1 - cos(lobes (theta - lobe_angle))) / 2; a circle for lobes 0.
    land_point: (land,) int, the contact point of each flat land.
    land_normal: (land, 2) unit vectors away from the centre. A point with lands meets planes at the
        distance of its gap instead of the circle.
    land_extra_gap: (land,) m, of the land beyond the gap of its point.

    Raises ValueError for columns of unequal length, values out of range or a land at a point that
    does not exist.
    """

    gap: np.ndarray
    damping: np.ndarray
    hunt_crossley: np.ndarray
    hertz: np.ndarray
    friction: np.ndarray
    stick_stiffness: np.ndarray
    lobes: np.ndarray
    lobe_depth: np.ndarray
    lobe_angle: np.ndarray
    land_point: np.ndarray
    land_normal: np.ndarray
    land_extra_gap: np.ndarray

    @classmethod
    def neutral(cls, points: int) -> "ContactLaws":
        """Return the laws of `points` elastic circular contacts."""
        columns = {field.name: np.zeros(points) for field in fields(cls)}
        columns |= {
            "gap": np.full(points, np.nan),
            "land_point": np.zeros(0, int),
            "land_normal": np.zeros((0, 2)),
            "land_extra_gap": np.zeros(0),
        }
        return cls(**columns)

    def __post_init__(self) -> None:
        """Check shapes and values."""
        points = len(self.gap)
        for name in POINT_COLUMNS:
            values = getattr(self, name)
            if np.shape(values) != (points,):
                raise ValueError(
                    f"contact law {name} has shape {np.shape(values)} for {points} contact points:"
                    " give one value per point"
                )
            if (
                name not in ("gap", "lobe_angle")
                and not (np.isfinite(values) & (values >= 0.0)).all()
            ):
                raise ValueError(
                    f"contact law {name} = {values.tolist()} must be finite and not negative"
                )
        if (self.friction > 0.0)[self.stick_stiffness <= 0.0].any():
            raise ValueError(
                "contact law stick_stiffness must be positive if there is friction: give about"
                " the contact stiffness"
            )
        if np.shape(self.land_normal) != (len(self.land_point), 2) or (
            len(self.land_point) and not np.allclose(np.hypot(*self.land_normal.T), 1.0)
        ):
            raise ValueError("land_normal must hold one unit vector (2,) per land")
        if np.shape(self.land_extra_gap) != (len(self.land_point),) or not np.all(
            self.land_extra_gap >= 0.0
        ):
            raise ValueError("land_extra_gap must hold one distance of at least 0 per land")
        if not set(np.unique(self.land_point)) <= set(range(points)):
            raise ValueError(
                f"land_point {self.land_point.tolist()} names a contact point that is not among"
                f" {points}"
            )

    @property
    def plain(self) -> np.ndarray:
        """Return (contact_point,) bool: True if a point has only the elastic circle."""
        special = np.isin(np.arange(len(self.gap)), self.land_point)
        for name in ("damping", "hunt_crossley", "hertz", "friction", "lobes"):
            special |= getattr(self, name) != 0.0
        return ~special

    def with_columns(self, **columns: Any) -> "ContactLaws":
        """Return the laws with some columns replaced; a number fills a column. New lands have no
        extra gap unless it is given.
        """
        if "land_point" in columns:
            columns = {"land_extra_gap": np.zeros(len(columns["land_point"]))} | columns
        filled = {
            name: np.broadcast_to(value, np.shape(self.gap)).copy()
            for name, value in columns.items()
            if name in POINT_COLUMNS
        }
        return replace(self, **(columns | filled))


POINT_COLUMNS = tuple(
    field.name for field in fields(ContactLaws) if not field.name.startswith("land")
)


@dataclass(frozen=True, eq=False)
class LocalLaws:
    """The terms of the local elements; every array is (element,).

    With u the displacement along the element (relative if it has two ends) and v its rate, the
    force on the structure is

        -(stiffness u + quadratic u² + cubic u³ + damper + drag |v| v + slider + saturation).

    The damper is damping v, held within ±damping_limit if that is not 0.

    The slider is an elastic stick spring of stick_stiffness that slips at slip_limit. The
    saturation is clip(saturation_stiffness u, ±saturation_limit).

    stiffness, stick_stiffness, saturation_stiffness: N/m.
    quadratic: N/m².
    cubic: N/m³.
    damping: N s/m.
    drag: N s²/m².
    damping_limit, slip_limit, saturation_limit: N.
    drag_partner: int, number of the element whose rate w adds to the speed, |v| = sqrt(v² + w²); -1
        for none. A fluid brakes a motion in its plane, not along each axis separately.

    Raises ValueError for columns of unequal length or values that are not finite.
    """

    stiffness: np.ndarray
    quadratic: np.ndarray
    cubic: np.ndarray
    damping: np.ndarray
    damping_limit: np.ndarray
    drag: np.ndarray
    stick_stiffness: np.ndarray
    slip_limit: np.ndarray
    saturation_stiffness: np.ndarray
    saturation_limit: np.ndarray
    drag_partner: np.ndarray

    @classmethod
    def neutral(cls, elements: int) -> "LocalLaws":
        """Return the laws of `elements` elements that exert no force."""
        return cls(
            **{field.name: np.zeros(elements) for field in fields(cls)}
            | {"drag_partner": np.full(elements, -1)}
        )

    def __post_init__(self) -> None:
        """Check shapes and values."""
        for field in fields(self):
            values = getattr(self, field.name)
            if np.shape(values) != np.shape(self.stiffness):
                raise ValueError(
                    f"element law {field.name} has shape {np.shape(values)}, expected"
                    f" {np.shape(self.stiffness)}: one per element"
                )
            if not np.isfinite(values).all():
                raise ValueError(
                    f"element law {field.name} = {np.asarray(values).tolist()} must be finite"
                )
