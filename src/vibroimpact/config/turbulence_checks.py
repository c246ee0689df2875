"""The checks of a turbulent force: its stretches, its direction, its band and its spectrum."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from vibroimpact.geometry.centreline import Centreline
from vibroimpact.geometry.sections import outer_width

from .geometry_checks import ends_off_the_tube
from .key_problem import Problem, Problems
from .stage_settings import ConfigPart

LEAST_SINE = 0.05  # of the angle between force and tube: 3 degrees
ALONG_TUBE = 2000  # places at which the angle is looked at
TOLERANCE = 1e-9


def needs_a_tube(other: ConfigPart, turbulence: ConfigPart) -> Problems:
    """Yield a problem: turbulence acts along a tube, and this structure is none."""
    yield Problem(
        "excitation.kind", f"acts along a tube, structure.kind is {other.kind}: use band_limited"
    )


def field(line: Centreline, flow: ConfigPart, section: str) -> Problems:
    """Yield a problem unless the stretches of a section are on the tube and do not overlap, and its
    direction is across the tube wherever it acts.
    """
    taken = []
    for index, stretch in enumerate(flow.stretches):
        place = f"{section}.stretches[{index}]"
        off = [*ends_off_the_tube(line, place, stretch)]
        yield from off
        if off:
            continue
        begin, end = sorted(line.locate(at, "stretch") for at in (stretch.from_m, stretch.to_m))
        if end - begin < TOLERANCE:
            yield Problem(f"{place}.to_m", "is the same place as from_m: move one of them")
        taken.append((begin, end, index))
    for (_, end, one), (begin, _, other) in pairwise(sorted(taken)):
        if begin < end - TOLERANCE:
            yield Problem(
                f"{section}.stretches[{other}]",
                f"overlaps stretches[{one}]: let one end at the start of the other",
                list(flow.stretches[other].from_m),
            )
    acting = [(begin, end) for begin, end, _ in taken]
    yield from _across(line, acting if flow.stretches else [(0.0, line.length)], flow, section)


def _across(
    line: Centreline, acting: Sequence[tuple[float, float]], flow: ConfigPart, section: str
) -> Problems:
    """Yield a problem for the first place between the arc lengths `acting` at which the direction
    of a section is along the tube.
    """
    along = np.asarray(flow.direction) / np.linalg.norm(flow.direction)
    for begin, end in acting:
        places = np.linspace(begin, end, ALONG_TUBE)
        sines = [np.linalg.norm(np.cross(line.direction(place), along)) for place in places]
        if min(sines) < LEAST_SINE:
            at = line.position(places[int(np.argmin(sines))])
            yield Problem(
                f"{section}.direction",
                f"is along the tube at {np.round(at, 4).tolist()} m: give a direction across"
                " the tube wherever the force acts, or stretches without that place",
            )
            return


def band(turbulence: ConfigPart) -> Problems:
    """Yield a problem unless the band of turbulence is above 0."""
    if turbulence.band_Hz[0] == 0.0:
        yield Problem("excitation.band_Hz", "begins at 0: give a lower end above 0 Hz")


def points_of_spectrum(tube: ConfigPart, turbulence: ConfigPart) -> Problems:
    """Yield a problem unless the points of a spectrum are ascending pairs that cover the band."""
    spectrum = turbulence.spectrum
    if spectrum.kind == "table":
        key, places, values = "frequency_Hz", spectrum.frequency_Hz, spectrum.psd_N2_per_m2_Hz
        scale = 1.0
    elif spectrum.kind == "reduced_table":
        key, places, values = "reduced_frequency", spectrum.reduced_frequency, spectrum.reduced_psd
        scale = outer_width(tube.section) / spectrum.velocity_m_per_s
    else:
        return
    place = f"excitation.spectrum.{key}"
    if len(places) != len(values):
        told = f"places have {len(values)} values of the PSD: give one value per place"
        yield Problem(place, told, len(places))
    if any(after <= before for before, after in pairwise(places)):
        yield Problem(place, "is not in ascending order: sort the points, each once")
    low, high = (scale * end for end in turbulence.band_Hz)
    if places[0] > low * (1 + TOLERANCE) or places[-1] < high * (1 - TOLERANCE):
        yield Problem(
            place,
            f"does not cover excitation.band_Hz, which is {low:.4g} to {high:.4g} on this axis:"
            " narrow the band or add points",
            [places[0], places[-1]],
        )
