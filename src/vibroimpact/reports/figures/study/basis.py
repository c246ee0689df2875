"""Accuracy of the reduced model, and the contribution of each family of basis vectors."""

import numpy as np

from vibroimpact.reports.figures.plot import Axis, Panel, Plot, Series
from vibroimpact.reports.figures.style import BLUE, GREEN, ORANGE

FAMILY_NAMES = {
    "free_modes": ("free modes", BLUE, "o"),
    "constrained_modes": ("constrained modes", ORANGE, "s"),
    "attachment_shapes": ("static shapes", GREEN, "^"),
}
PANELS = {
    # panel -> (title, name of the basis with everything, how a family's basis is named)
    "alone": ("one family alone", "all", "{} alone"),
    "without": ("one family left out", "all", "without {}"),
    "tenth": (
        "one left out, free modes to a tenth",
        "free_modes to a tenth",
        "free_modes to a tenth, without {}",
    ),
}
FLOOR = 1.0e-9  # round-off of the full model's eigenvalues


def basis_quality(config, rows):
    """Return the Plot of the worst error of the reduced frequencies against bilateral stiffness.

    rows: table of reduction.basis_accuracy.basis_frequency_errors, list of {column: value}.
    """
    highest = max(row["full_Hz"] for row in rows)
    caption = (
        f"Worst relative error of the frequencies up to {highest:.0f} Hz of the reduced model"
        " against the full one, with bilateral supports of stiffness k. Left: with one family of"
        " vectors alone; middle: with one family left out; right: the same with free modes to"
        f" {0.1 * config.basis.free_modes_to_Hz:g} Hz in place of {config.basis.free_modes_to_Hz:g}"
        f" Hz. Black: with all families. Errors below {FLOOR:g} are round-off and drawn there."
        " Constrained modes and static shapes carry the contact; a wide band of free modes alone"
        " does not replace them."
    )
    panels = {}
    for panel, (title, everything, pattern) in PANELS.items():
        items = _errors(rows, everything, label="all families", marker="D", width=2.0)
        for family, (label, colour, marker) in FAMILY_NAMES.items():
            look = {"label": label, "colour": colour, "marker": marker}
            items += _errors(rows, pattern.format(family), **look)
        axes = Axis("support_stiffness_N_per_m", True), Axis("relative_error", True)
        panels[panel] = Panel(*axes, items, title)
    title = "Reduced model: contribution of each family of vectors"
    return Plot("basis_quality", title, caption, panels, size=(9.6, 4.2), share="y", legend=4)


def _errors(rows, vectors, **look):
    """Return the worst error of one basis in a list, empty if the report has none.

    A tube without supports has no constrained modes.
    """
    worst: dict[float, float] = {}
    for row in rows:
        if row["vectors"] == vectors and np.isfinite(row["relative_error"]):
            k = row["stiffness_N_per_m"]
            worst[k] = max(worst.get(k, FLOOR), abs(row["relative_error"]))
    return (
        [Series(vectors, sorted(worst), [worst[k] for k in sorted(worst)], **look)] if worst else []
    )
