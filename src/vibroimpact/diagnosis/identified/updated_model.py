"""A completed structure as a configuration of the ordinary study: measured modes with their
elements, under a random force in the band.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import yaml

from vibroimpact.io.records import plain_values
from vibroimpact.structure.contact.local_elements import COLUMNS

from .trial import Trial

# Shapes hold one direction per channel; its direction in space does not matter.
AXIS, DIRECTION, OPPOSITE = "x", [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]
STEPS_PER_CYCLE = 200  # of the highest mode or of the band's end
START_UP_PERIODS = 40  # of the lowest frequency of the band
DURATION_PERIODS = 600  # of the lowest mode
DECIMATION = 25  # of two stages: steps are a multiple of it
Places = Mapping[str, Mapping[str, float]]


def configuration_text(
    trial: Trial, places: Places, band_Hz: Sequence[float], loads: Sequence[float], sentence: str
) -> str:
    """Return the YAML text of the configuration of a Trial, with loads in N RMS; sentence: its
    first line, a comment.

    Points carry the channels' names with underscores; a place that is neither a channel nor the
    difference of two is a separate point.
    """
    modes = trial.modes
    first = modes.frequency[~modes.residual].min()
    highest, lowest = max(band_Hz[1], modes.frequency.max()), max(band_Hz[0], 0.1 * first)
    rate = int(np.ceil(STEPS_PER_CYCLE * highest / DECIMATION)) * DECIMATION
    values = {
        "study": "identified_updated",
        "structure": {"kind": "identified", "modes": _modes(trial, places)},
        "elements": [*_elements(trial, places)],
        "excitation": {
            "kind": "band_limited",
            "point": _point(modes.names[modes.drive]),
            "direction": DIRECTION,
            "band_Hz": [lowest, band_Hz[1]],
        },
        "integration": {
            "scheme": "exact",
            "steps_per_second": rate,
            "start_up_s": float(np.ceil(START_UP_PERIODS / lowest)),
            "imperfection": 0.0,
        },
        "grid": {
            "load_rms_N": sorted({float(f"{load:.6g}") for load in loads}),
            "gap_m": [1.0],
            "seeds": 1,
        },
        "record": {
            "duration_s": float(np.ceil(DURATION_PERIODS / first)),
            "sampling_frequency_Hz": rate // DECIMATION,
        },
    }
    plain = plain_values(values)
    text = yaml.safe_dump(plain, sort_keys=False, width=150, default_flow_style=None)
    return (
        f"# {sentence}\n# Units are in the keys; shapes are in kg^-1/2. There is no gap: gap_m is"
        f" not used.\n{text}"
    )


def _modes(trial: Trial, places: Places) -> list[dict[str, Any]]:
    """Return the entries of all modes, with the shapes of channels and of separate places."""
    modes, names = trial.modes, [_point(own) for own in trial.modes.names]
    hidden = [term for term in trial.terms if not is_relative(places.get(term.place, {}))]
    rows = zip(modes.frequency, modes.damping_ratio, modes.residual, modes.shapes, strict=True)
    return [
        {
            "frequency_Hz": frequency,
            "damping_ratio": ratio,
            "residual": residual,
            "shape": {own: {AXIS: value} for own, value in zip(names, row, strict=True)}
            | {_point(term.place): {AXIS: term.along(modes)[mode]} for term in hidden},
        }
        for mode, (frequency, ratio, residual, row) in enumerate(rows)
    ]


def location(place: str, row: Mapping[str, float] | None) -> str:
    """Return a place {channel: coefficient} in words; row: None if no channel shows it."""
    if row is None:
        return "elsewhere: no channel shows the place; its share in every mode was fitted"
    ends = sorted(row, key=lambda name: row[name])
    if not is_relative(row):
        told = " ".join(f"{weight:+g} {name}" for name, weight in row.items())
        return f"{place}: along {told}"
    if len(ends) == 2:
        return f"{place}: between {ends[0]} and {ends[1]}"
    return f"{place}: at {ends[0]}, to the ground"


def is_relative(row: Mapping[str, float]) -> bool:
    """Return whether a place {channel: coefficient} is the displacement of a point or of one
    against another, which an element can join.
    """
    return sorted(row.values()) in ([1.0], [-1.0], [-1.0, 1.0])


def _point(name: str) -> str:
    """Return a channel's or place's name as the name of a point."""
    plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return plain if plain[0].isalpha() else f"p{plain}"


def _elements(trial: Trial, places: Places) -> Iterator[dict[str, Any]]:
    """Yield the entries of all elements: between two points, or a point and the ground."""
    for number, term in enumerate(trial.terms):
        row, ends = places.get(term.place, {}), {"point": _point(term.place)}
        direction = DIRECTION
        if is_relative(row):
            # the displacement counts from the channel with -1 to the one with +1
            signs = {weight: _point(name) for name, weight in row.items()}
            ends = {"point": signs[max(signs)]}
            ends |= {"other_point": signs[-1.0]} if len(signs) == 2 else {}
            direction = DIRECTION if 1.0 in signs else OPPOSITE
        table = term.effect.columns(term.values)
        for index in range(term.effect.elements):
            laws = {COLUMNS[column]: float(values[index]) for column, values in table.items()}
            name = f"{term.effect_id}_{number + 1}_{index + 1}"
            yield {"name": name, **ends, "direction": direction, **laws}
