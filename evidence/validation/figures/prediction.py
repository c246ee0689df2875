"""Error of the equivalent linear tube for each quantity, where nothing was fitted."""

from __future__ import annotations

import numpy as np

from vibroimpact.equivalent_support.supports_prediction import USABLE_dB
from vibroimpact.reports.figures.plot import Axis, Item, Panel, Plot, Series, Span
from vibroimpact.reports.figures.style import BLUE, GREEN, GREY, ORANGE

QUANTITIES = (
    "RMS displacement",
    "PSD 5-20 Hz",
    "PSD 20-40 Hz",
    "PSD 40-60 Hz",
    "PSD 100-200 Hz",
    "RMS plate force",
    "RMS bending stress",
    "peak bending stress",
)
GEOMETRIES = {
    "study, load left out": (BLUE, "o"),
    "study tube, other gaps and loads": (ORANGE, "s"),
    "second tube": (GREEN, "^"),
}
LOWEST_dB, LOWEST_CONTACT = -20.0, 1e-3


def prediction(rows, law):
    """Return the Plot of the prediction's errors by one law; rows: of prediction.csv."""
    gained = "input gain" in law
    caption = (
        f"Linear over non-linear in dB against the fraction of time in contact, law '{law}'; each"
        f" point a sensor, plate or section of one case that was not fitted. Band: {USABLE_dB:g}"
        " dB, within which the prediction counts as usable. Cases with less than 0.1 % of contact"
        f" are drawn at 0.1 %; errors below {LOWEST_dB:g} dB at {LOWEST_dB:g} dB."
    )
    title = "Equivalent linear tube against the non-linear one" + ", input gain" * gained
    return Plot(
        "validation_prediction" + "_gain" * gained,
        title,
        caption,
        {quantity: _panel(rows, law, quantity) for quantity in QUANTITIES},
        [*zip(*[iter(QUANTITIES)] * 4, strict=True)],
        (9.6, 5.4),
        share="xy",
        legend=3,
    )


def _panel(rows, law, quantity):
    """Return the Panel of the errors of one quantity."""
    items: list[Item] = [Span("y", -USABLE_dB, USABLE_dB, GREY, 0.2)]
    for geometry, (colour, marker) in GEOMETRIES.items():
        part = [
            row
            for row in rows
            if row["quantity"] == quantity
            and row["geometry"] == geometry
            and row["law"] in (law, _plain(law, geometry))
            and np.isfinite(row["error_dB"])
        ]
        if part:
            contact = np.maximum([row["contact_fraction"] for row in part], LOWEST_CONTACT)
            error = np.clip([row["error_dB"] for row in part], LOWEST_dB, -LOWEST_dB)
            look = {"label": geometry, "colour": colour, "marker": marker, "size": 3.5, "line": ""}
            items.append(Series(geometry, contact, error, **look))
    return Panel(Axis("contact_time", True), Axis("prediction_error_dB"), items, quantity)


def _plain(law, geometry):
    """The study's own loads are predicted without a gain, which is fitted on them."""
    return (
        law.removesuffix(", input gain")
        if geometry == "study, load left out" and "input gain" not in law
        else law
    )
