"""Which names are right for a campaign, given its truth."""

from __future__ import annotations

from typing import Any

EXACT_ALIASES = {"gap": "sensor_gain", "sensor_gain": "gap"}  # of all supports, of all channels
STRAY_GAIN = 0.06  # relative: a channel that is off by more has a gain that may be named
NO_NAMES = ("nothing", "out_of_catalogue", "other_law")  # kinds whose hidden effects have none
FAULTS_WITH_NAMES = ("sensor_gain", "sensor_delay")


def right_names(truth: dict[str, Any]) -> list[list[str]]:
    """Return the lists of ids, each sorted, that are a right and whole answer: what is hidden, its
    exact alias, and either with a gain of a channel that is far off by chance. Empty where nothing
    is to be named.

    truth: content of its file; gains {channel: factor} of the sensors, where it has them.
    """
    kind, names = truth["kind"], sorted(name for name, _ in truth["effects"])
    if kind in NO_NAMES or (kind == "fault" and not set(names) <= set(FAULTS_WITH_NAMES)):
        names = []
    found = [names] if names else []
    for place, (name, parameters) in enumerate(truth["effects"] if names else ()):
        if name in EXACT_ALIASES and "all" in parameters.values():
            others = [own for at, (own, _) in enumerate(truth["effects"]) if at != place]
            found.append(sorted([*others, EXACT_ALIASES[name]]))
    if any(abs(gain - 1.0) > STRAY_GAIN for gain in truth.get("gains", ())):
        found += [sorted({*row, "sensor_gain"}) for row in found or [[]]]
    return found
