"""A completed model as a configuration of the ordinary study: measured modes with their elements,
under a random force in the band.
"""

import re

import numpy as np
import yaml

from vibroimpact.config.measured_structure import ELSEWHERE
from vibroimpact.contact.local_elements import COLUMNS
from vibroimpact.records import plain_values, write_text

from .local_laws import LAWS
from .store import trial_of

AXIS, DIRECTION = (
    "x",
    [
        1.0,
        0.0,
        0.0,
    ],
)  # shapes hold one direction per channel; which way it points in space is the sensor's affair
STEPS_PER_CYCLE = 200  # of the highest mode or of the band's end: what the ordinary study asks for
START_UP_PERIODS = 40  # of the lowest frequency of the band
DURATION_PERIODS = 600  # of the lowest mode
DECIMATION = 5


def configuration(completed, campaign, study):
    """Return the configuration of a completed model (values of conclude) as plain values.

    Points carry the channels' names with underscores; a place that no channel shows is a point of
    its own. Loads are those of the records.
    """
    trial = trial_of(completed["trial"])
    modes, names = trial.modes, [_point(name) for name in trial.modes.names]
    hidden = {
        term.place: term.along(modes) for term in trial.terms if not _between_points(study, term)
    }
    shapes = [
        {
            **{name: {AXIS: value} for name, value in zip(names, row, strict=True)},
            **{_point(place): {AXIS: share[mode]} for place, share in hidden.items()},
        }
        for mode, row in enumerate(modes.shapes)
    ]
    described = [
        {"frequency_Hz": place, "damping_ratio": ratio, "residual": residual, "shape": shape}
        for place, ratio, residual, shape in zip(
            modes.frequency, modes.damping_ratio, modes.residual, shapes, strict=True
        )
    ]
    elements = [
        element
        for number, term in enumerate(trial.terms)
        for element in _elements(term, number, study, names, modes.names)
    ]
    rate = _rate(max(study.band_Hz[1], modes.frequency.max()))
    lowest = max(study.band_Hz[0], 0.1 * modes.frequency[~modes.residual].min())
    loads = sorted({float(f"{value:.6g}") for value in campaign["load_rms"].values})
    return plain_values(
        {
            "study": f"{study.name}_updated",
            "structure": {"kind": "identified", "modes": described},
            "elements": elements,
            "excitation": {
                "kind": "band_limited",
                "point": _point(study.drive),
                "direction": DIRECTION,
                "band_Hz": [lowest, study.band_Hz[1]],
            },
            "integration": {
                "scheme": "exact",
                "steps_per_second": rate,
                "start_up_s": float(np.ceil(START_UP_PERIODS / lowest)),
                "imperfection": 0.0,
            },
            "grid": {"load_rms_N": loads, "gap_m": [1.0], "seeds": 1},
            "record": {
                "duration_s": float(
                    np.ceil(DURATION_PERIODS / modes.frequency[~modes.residual].min())
                ),
                "sampling_frequency_Hz": rate // DECIMATION**2,
            },
        }
    )


def write_configuration(completed, campaign, study, path):
    """Write the configuration as YAML; run it with `snakemake -j2 --configfile FILE`."""
    text = yaml.safe_dump(
        configuration(completed, campaign, study),
        sort_keys=False,
        width=150,
        default_flow_style=None,
    )
    write_text(
        f"# {study.name}: measured modes completed with {completed['chosen']}. Units are in the"
        " keys; shapes are in kg^-1/2.\n# There is no gap in it: gap_m is not used.\n" + text,
        path,
    )


def _point(name):
    """A channel's or place's name as the name of a point."""
    plain_name = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return plain_name if plain_name[0].isalpha() else f"p{plain_name}"


def is_relative(weights):
    """Whether a place {channel: coefficient} is the displacement of a point or of one against
    another, which an element can join.
    """
    return sorted(weights.values()) in ([1.0], [-1.0, 1.0])


def _between_points(study, term):
    """Whether a term joins points that channels show; any other place becomes a point of its own
    with its share in every mode.
    """
    return term.place != ELSEWHERE and is_relative(study.places[term.place])


def _rate(highest):
    """Steps per second: a multiple of what two stages of decimation take."""
    return int(np.ceil(STEPS_PER_CYCLE * highest / DECIMATION**2)) * DECIMATION**2


def _elements(term, number, study, points, channels):
    """The entries of a term's elements: between two points, or a point and the ground."""
    ends = (
        _ends(study.places[term.place], points, channels)
        if _between_points(study, term)
        else {"point": _point(term.place)}
    )
    table = LAWS[term.law].columns(term.values)
    for index in range(LAWS[term.law].elements):
        laws = {COLUMNS[column]: float(values[index]) for column, values in table.items()}
        yield {
            "name": f"{LAWS[term.law].id}_{number + 1}_{index + 1}",
            **ends,
            "direction": DIRECTION,
            **laws,
        }


def _ends(weights, points, channels):
    """{point, other_point} of a place that is_relative: the displacement counts from the channel
    with -1 to the one with +1.
    """
    place = dict(zip(channels, points, strict=True))
    plus = [place[name] for name, weight in weights.items() if weight == 1.0]
    minus = [place[name] for name, weight in weights.items() if weight == -1.0]
    return {"point": plus[0], **({"other_point": minus[0]} if minus else {})}
