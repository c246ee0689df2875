"""The lands of the supports, at which the kernel counts the sliding work separately."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

SAME_LAND = 0.99  # cosine between the normals of a land at the points of a support: 8 degrees


def law_lands(model: ModalModel, round_points: Sequence[int]) -> tuple[np.ndarray, int]:
    """Return (place of each law in Tally.land_work (law,), number of places).

    The laws are those of kernels.tables.Laws: of round_points, then one per flat land. The places
    are the lands of the first support, of the second and so on, as many for each as the support
    with most lands has; with lobes the place is that of the first land. A law without lands has
    place -1. There are no places if no support has two lands.
    """
    laws, support_of = model.contact_laws, model.support_of_point
    normals: list[list[np.ndarray]] = [[] for _ in model.support_names]
    numbers = [0 for _ in round_points]
    for point, normal in zip(laws.land_point, laws.land_normal, strict=True):
        own = normals[support_of[point]]
        same = [number for number, other in enumerate(own) if normal @ other > SAME_LAND]
        numbers.append(same[0] if same else len(own))
        if not same:
            own.append(normal)
    most = int(max([*map(len, normals), *laws.lobes], default=0))
    points = np.array([*round_points, *laws.land_point], np.int64)
    if most < 2:
        return np.full(len(points), -1, np.int64), 0
    places = support_of[points] * most + np.array(numbers, np.int64)
    has_lands = np.isin(points, laws.land_point) | (laws.lobes[points] > 0)
    return np.where(has_lands, places, -1).astype(np.int64), most * len(normals)
