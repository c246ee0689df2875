"""Evidence of the paper's claims: limits, damping, rank, node, valleys, response points."""

from __future__ import annotations

from typing import Any

import numpy as np

from evidence.validation.claims.response import peaks_by_sensor, valleys
from evidence.validation.claims.shapes import node_places, quadrature
from evidence.validation.study_curves import POLES, median
from vibroimpact.identify.linear.poles import first_pole
from vibroimpact.reports.figures.plot import Axis, Item, Mark, Panel, Plot, Series
from vibroimpact.reports.figures.style import BLACK, BLUE, GREEN, GREY, ORANGE, RED

COLOURS = (BLUE, ORANGE, GREEN, RED)
LOOK: dict[str, Any] = {"marker": "o", "size": 3, "width": 1.0}


def claims_of_the_peak(model, gaps):
    """Return the Plot of frequency and damping of the main peak against load.

    Frequency by response point is drawn with the linear limits, damping by method.
    """
    wide, tight = gaps
    caption = (
        "Largest gap. Left: frequency of the main peak of the mean PSD at each response point,"
        " between the linear tube's limits (dashed: k = 1 N/m and the contact's own stiffness);"
        " grey: at the smallest gap, at the load that has the same load/gap. Right: damping ratio"
        " of the same peak by half-power, 1/4 and 1/25 widths and by LSCF, medians over seeds."
    )
    items: list[Item] = [
        Series(name, wide.load, values, label=name, colour=colour, **LOOK)
        for (name, values), colour in zip(peaks_by_sensor(wide).items(), COLOURS, strict=False)
    ]
    name, scale = "smallest gap, load scaled", wide.gap_m / tight.gap_m
    poles = median(tight.pole_frequency["lscf"])
    items.append(Series(name, tight.load * scale, poles, label=name, colour=GREY, width=1.4))
    held = float(np.bincount(model.support_of_point, model.contact_stiffness).mean())
    for k, name in ((1.0, "free"), (held, "held")):
        frequency = abs(first_pole(model, k, 0.0)) / (2.0 * np.pi)
        items.append(Mark(name, "y", frequency, colour=BLACK, line="--", width=0.9))
    damping = [
        Series(name, wide.load, median(wide.pole_damping[name]), label=name, colour=colour, **LOOK)
        for name, colour in zip(POLES, COLOURS, strict=True)
    ]
    loads, legend = Axis("load_rms_N", True), "upper left"
    panels = {
        "frequency": Panel(loads, Axis("frequency_Hz"), items, legend=legend),
        "damping": Panel(loads, Axis("damping_ratio"), damping, legend=legend),
    }
    title = "Claims on the main peak"
    return Plot("validation_claims_peak", title, caption, panels, size=(7.6, 3.6))


def claims_of_the_shape(model, gaps):
    """Return the Plot of the deflection shape against load.

    It shows singular values, node, quadrature, and the filling of anti-resonances.
    """
    wide, tight = gaps
    caption = (
        "Singular values of the response around the main peak over the first one, and the"
        " quadrature part of the first shape (largest gap, medians over seeds); place of the"
        " shape's node, as arc length from the root (smallest gap; dotted: the plate); height of"
        " the measured valleys above the anti-resonances of the equivalent linear tube (largest"
        " gap)."
    )
    rank = []
    for order, colour in ((1, BLUE), (2, ORANGE), (3, GREEN)):
        ratio = np.median(wide.singular[:, :, order] / wide.singular[:, :, 0], axis=1)
        name = f"value {order + 1}"
        rank.append(Series(name, wide.load, ratio, label=name, colour=colour, **LOOK))
    share = [np.median([quadrature(shape) for shape in seeds]) for seeds in wide.shape]
    plate = float(np.mean(model.contact_position[model.support_of_point == 0][:, 2]))
    node: list[Item] = [
        Series("node", tight.load, node_places(tight), colour=BLUE, **LOOK),
        Mark("plate", "y", plate, colour=GREY, line=":"),
    ]
    found = {load: values[:, 2] for load, values in valleys(wide, model).items() if len(values)}
    at = [load for load, values in found.items() for _ in values]
    raised = [value for values in found.values() for value in values]
    look = {"colour": RED, "marker": "o", "size": 4, "line": ""}
    loads = Axis("load_rms_N", True, wide.load[0], wide.load[-1])
    first = Series("first shape", wide.load, share, colour=BLUE, **LOOK)
    panels = {
        "rank": Panel(loads, Axis("singular_value_ratio", True), rank, legend="lower right"),
        "quadrature": Panel(loads, Axis("quadrature_share"), [first]),
        "node": Panel(loads, Axis("node_arc_length_m"), node),
        "valleys": Panel(loads, Axis("valley_height_dB"), [Series("valleys", at, raised, **look)]),
    }
    rows = [["rank", "quadrature"], ["node", "valleys"]]
    title = "Claims on shape and anti-resonances"
    return Plot("validation_claims_shape", title, caption, panels, rows, (7.6, 5.4))
