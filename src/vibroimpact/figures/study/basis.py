"""Accuracy of the reduced model, and the contribution of each family of basis vectors."""

from __future__ import annotations

import numpy as np

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import BLACK, BLUE, GREEN, ORANGE

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
    """Return the Sheet of the worst error of the reduced frequencies against bilateral stiffness.

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
    sheet = Sheet(
        "basis_quality",
        "Reduced model: what each family of vectors brings",
        caption,
        [list(PANELS)],
        size=(9.6, 4.2),
        sharey=True,
    )
    for panel, (title, everything, pattern) in PANELS.items():
        axes = sheet.axes[panel]
        axes.set_title(title)
        _errors(
            sheet,
            axes,
            rows,
            everything,
            {"color": BLACK, "marker": "D", "label": "all families", "linewidth": 2.0},
        )
        for family, (label, colour, marker) in FAMILY_NAMES.items():
            _errors(
                sheet,
                axes,
                rows,
                pattern.format(family),
                {"color": colour, "marker": marker, "label": label},
            )
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.label_outer()
    handles, labels = sheet.axes["alone"].get_legend_handles_labels()
    sheet.figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return [sheet]


def _errors(sheet, axes, rows, vectors, style):
    """Draw the worst error of one basis, if the report has it.

    A tube without supports has no constrained modes.
    """
    chosen = [
        row for row in rows if row["vectors"] == vectors and np.isfinite(row["relative_error"])
    ]
    stiffness = sorted({row["stiffness_N_per_m"] for row in chosen})
    if not stiffness:
        return
    worst = [
        max(abs(row["relative_error"]) for row in chosen if row["stiffness_N_per_m"] == k)
        for k in stiffness
    ]
    sheet.line(
        axes,
        ("support_stiffness_N_per_m", np.array(stiffness)),
        ("relative_error", np.maximum(worst, FLOOR)),
        vectors,
        **style,
    )
