"""A tube with other lengths than its configuration states, of the legs, the bend, a segment, or all
of them; the check of the linear model tries them.

Everything on the tube stays at the same share of its part, because places are usually stated from
the same wrong length: a sensor in the middle of a leg is in the middle of the real leg.
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.effects.effect import Values
from vibroimpact.geometry.centreline import build_centreline

Key = tuple[str | int, ...]  # path to a number in plain values


def parts(structure: ConfigPart) -> dict[str, list[Key]]:
    """Return {name: [Key]}: the lengths of a checked structure of kind u_tube or path that may be
    wrong, as paths of keys in its plain values, those of the whole tube first.
    """
    single: dict[str, list[Key]]
    if structure.kind == "u_tube":
        single = {"legs": [("leg_length_m",)], "bend": [("bend_radius_m",)]}
    else:
        single = {
            f"segment {number}": [("segments", number, LENGTH_KEY[segment.kind])]
            for number, segment in enumerate(structure.segments)
        }
    everything = [key for keys in single.values() for key in keys]
    return {"tube": everything} | (single if len(single) > 1 else {})


LENGTH_KEY = {"straight": "length_m", "bend": "radius_m"}


def scaled(values: Values, keys: Sequence[Key], factor: float) -> Values:
    """Return a configuration in plain values with lengths of its structure, by their keys, times a
    factor; its points and supports are not moved.
    """
    return values | {"structure": _scaled(values["structure"], keys, factor)}


def _scaled(values, keys, factor):
    out = dict(values)
    for key in {key[0] for key in keys}:
        own = [rest[1:] for rest in keys if rest[0] == key]
        if () in own:
            out[key] = values[key] * factor
        else:
            out[key] = [
                _scaled(row, [rest[1:] for rest in own if rest[0] == number], factor)
                for number, row in enumerate(values[key])
            ]
    return out


class Moved:
    """The map of points of a tube to those of one with other lengths; both are checked structures
    with the same number of segments.
    """

    def __init__(self, structure: ConfigPart, other: ConfigPart) -> None:
        self.before, self.after = build_centreline(structure), build_centreline(other)

    def __call__(self, point: Sequence[float] | np.ndarray) -> list[float]:
        """Return [x, y, z] m of a point (3,) in m, at the same share of its segment."""
        arc = self.before.locate(np.asarray(point, float), "a point")
        ends, moved = (
            [0.0, *(piece.end for piece in line.segments)] for line in (self.before, self.after)
        )
        return self.after.position(float(np.interp(arc, ends, moved))).tolist()

    def campaign(self, campaign: xr.Dataset) -> xr.Dataset:
        """Return a campaign Dataset with channels and forces on the other tube."""
        return campaign.assign(
            {
                name: (campaign[name].dims, np.array([self(row) for row in campaign[name].values]))
                for name in ("channel_point", "force_channel_point")
            }
        )

    def values(self, values: Values) -> Values:
        """Return a configuration in plain values with its points and supports on the other tube."""
        return values | {
            "points": {name: self(point) for name, point in values["points"].items()},
            "supports": [
                support | ({"at_m": self(support["at_m"])} if support["at_m"] else {})
                for support in values["supports"]
            ],
        }
