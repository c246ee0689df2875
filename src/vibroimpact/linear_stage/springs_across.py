"""Springs, rubbing and stops across the force, where the lowest record shows one."""

import numpy as np
from scipy import optimize

from vibroimpact.effects import places

from . import priors
from .candidates import DIRECTED, Candidate
from .effect_fit import LinearChanges
from .spring_in_record import SpringInRecord
from .workbench import Workbench

PLACES = 12  # along a tube, between which the best is searched to a hundredth of their distance
WITHIN = 0.01


def across_the_force(bench: Workbench, gain: float, stiffness: float) -> list[Candidate]:
    """Return the Candidates of springs and stops at the place and in the direction of a spring that
    explains the lowest record of a Workbench, where none along the force does; none of another
    structure than a tube.

    bench: of the bare model, with the measured fit of its modes; gain: of log likelihood, which
    such a spring exceeds; stiffness: scale in N/m. Such an effect moves the tube where the force
    does not, and what is run along the force does not show it: a force that is turned comes
    nearest.
    """
    length = places.length_m(bench.values)
    if length is None:
        return []
    changes = LinearChanges(bench)

    def spring(arc_length):
        return SpringInRecord(bench, changes, places.between(arc_length), stiffness)

    apart = length / PLACES
    arcs = apart * (np.arange(PLACES) + 0.5)
    rows = {float(arc): spring(float(arc)) for arc in arcs}
    if any(row.along_force().share > priors.EXPLAINED for row in rows.values()):
        return []
    found = {arc: row.in_any_direction().gain for arc, row in rows.items()}
    nearest = max(found, key=lambda arc: found[arc])
    best = optimize.minimize_scalar(
        lambda arc: -spring(arc).in_any_direction().gain,
        bounds=(max(nearest - apart, 0.0), min(nearest + apart, length)),
        method="bounded",
        options={"xatol": WITHIN * apart},
    )
    turned = spring(best.x).in_any_direction()
    if turned.share < priors.EXPLAINED or turned.gain < gain:
        return []
    # a spring pulls along both senses of its direction
    degrees = (np.rad2deg(turned.angle) + 90.0) % 180.0 - 90.0
    location = places.between(float(best.x), float(degrees))
    return [Candidate(effect_id, location) for effect_id in sorted(DIRECTED)]
