"""A tube of other lengths than its configuration states: the legs, the bend, a segment, or all of
it, with everything on it in the same place as a share of its part.

Who states a wrong length also states places by it: a sensor in the middle of a leg is in the middle
of the leg that is there.
"""

import numpy as np

from vibroimpact.geometry.centreline import build_centreline


def parts(structure):
    """Return {name: [(key,)...]}: the lengths of a checked structure of kind u_tube or path that
    may be wrong, as paths of keys in its plain values, those of all of it first.
    """
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


def scaled(values, keys, factor):
    """Return plain values of a configuration with lengths of its structure, by their keys, times a
    factor; what else it holds stays where it is.
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
    """Where the points of a tube are on one of other lengths; both are checked structures with as
    many segments.
    """

    def __init__(self, structure, other):
        self.before, self.after = build_centreline(structure), build_centreline(other)

    def __call__(self, point):
        """Return [x, y, z] m of a point (3,) in m, at the same share of its segment."""
        arc = self.before.locate(np.asarray(point, float), "a point")
        ends = [
            [0.0, *(piece.end for piece in line.segments)] for line in (self.before, self.after)
        ]
        return self.after.position(float(np.interp(arc, *ends))).tolist()

    def campaign(self, campaign):
        """Return a campaign Dataset with channels and forces where they are then."""
        return campaign.assign(
            {
                name: (campaign[name].dims, np.array([self(row) for row in campaign[name].values]))
                for name in ("channel_point", "force_channel_point")
            }
        )

    def values(self, values):
        """Return plain values of a configuration with its points and supports where they are
        then.
        """
        return values | {
            "points": {name: self(point) for name, point in values["points"].items()},
            "supports": [
                support | ({"at_m": self(support["at_m"])} if support["at_m"] else {})
                for support in values["supports"]
            ],
        }
