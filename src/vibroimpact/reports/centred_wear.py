"""The effect of centred obstacles on wear, in a sentence: for figures and page."""

from typing import Any

import numpy as np

from vibroimpact.identify.secant import SMALL_OFFSET

from .number_text import digits


def centred_sentence(imperfection: float, offset_m: Any, gap_m: float) -> str:
    """Return the effect of centred obstacles on the wear work rate, "" for obstacles off centre.

    imperfection: largest random offset over the gap. offset_m: stated offsets. gap_m: smallest gap.
    """
    if max(imperfection, np.abs(offset_m).max(initial=0.0) / gap_m) > SMALL_OFFSET:
        return ""
    return (
        f"The obstacles are centred to {digits(imperfection)} of the gap: while the motion stays in"
        " the plane of the force hardly anything slides, and once it leaves that plane the wear"
        " work rate rises by decades. A real tube is off centre: state supports.centre_offset_m"
        " if wear at low loads counts."
    )


def centred_in(config: Any) -> str:
    """Return centred_sentence of a configuration, "" if the structure is not a tube."""
    if config.structure.kind not in ("u_tube", "path"):
        return ""
    offsets = [np.ravel(support.centre_offset_m) for support in config.supports]
    offset_m = np.concatenate(offsets) if offsets else np.zeros(0)
    return centred_sentence(config.integration.imperfection, offset_m, min(config.grid.gap_m))
