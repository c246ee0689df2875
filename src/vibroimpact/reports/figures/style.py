"""The style of all figures: sizes, colours, markers, ticks and number formats.

Colours are those of Okabe and Ito, which are distinct with any colour vision. Curves that differ in
colour also differ in marker or line. Ordered quantities (load, stiffness) have a colour map whose
lightness rises with the value.
"""

from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axis import Axis
from matplotlib.colors import ListedColormap, LogNorm, to_hex
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator
from numpy.typing import ArrayLike

from vibroimpact.geometry.sections import outer_width

from .columns import COLUMNS

BLACK = "#000000"
ORANGE = "#E69F00"
SKY = "#56B4E9"
GREEN = "#009E73"
BLUE = "#0072B2"
RED = "#D55E00"
PINK = "#CC79A7"
BROWN, GREY, PALE = "#8C5A1E", "#7F7F7F", "#D9D9D9"

PARAMETERS: dict[Any, Any] = {
    "figure.constrained_layout.w_pad": 0.06,
    "figure.constrained_layout.h_pad": 0.06,
    "text.parse_math": False,  # a name may hold a $
    "font.size": 9.5,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9.5,
    "legend.fontsize": 8.5,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "figure.titlesize": 11.5,
    "figure.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#E6E6E6",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.4,
    "lines.markersize": 4.5,
    "legend.frameon": True,
    "legend.framealpha": 0.85,
    "legend.edgecolor": "none",
    "legend.borderpad": 0.3,
    "legend.handlelength": 1.8,
    "image.cmap": "viridis",
}
matplotlib.rcParams.update(PARAMETERS)
# Without the lightest tenth, which is too pale for lines.
ORDERED = ListedColormap(matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, 256)))

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

METHODS = {
    # method -> (colour, marker)
    "peak_half": (ORANGE, "v"),
    "peak_quarter": (BROWN, "<"),
    "peak_25th": (SKY, ">"),
    "lscf": (BLUE, "o"),
    "ods": (GREEN, "s"),
    "broadband": (RED, "D"),
    "statistical_linearisation": (PINK, "x"),
    "secant": (BLACK, "+"),
}
OPEN_METHODS = ("peak_half", "peak_quarter", "peak_25th")
GAP_COLOURS = (BLUE, ORANGE, GREEN, RED, PINK, BLACK, SKY, BROWN)
GAP_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")


def label_of(column: str) -> str:
    """Return the axis label of a column, with its unit.

    Raises KeyError for a column that is not in COLUMNS.
    """
    return COLUMNS[column][0]


def shown(column: str, values: ArrayLike) -> np.ndarray:
    """Return SI values in the unit of the axis, as an array."""
    return np.asarray(values, dtype=float) * COLUMNS[column][1]


def ordered_colours(values: Sequence[float]) -> dict[float, str]:
    """Return {value: colour} of positive values, from dark to light by their logarithm."""
    low, high = float(np.min(values)), float(np.max(values))
    norm = LogNorm(low, high) if low < high else LogNorm(0.9 * low, 1.1 * low)
    return {value: to_hex(ORDERED(float(norm(value)))) for value in values}


def number(value: float) -> str:
    """Return a value as text with 3 digits, powers of ten raised: 4×10⁶, 0.289."""
    text = f"{value:.3g}"
    if "e" not in text:
        return text
    digits, power = text.split("e")
    return f"{digits}×{power_of_ten(int(power))}" if digits != "1" else power_of_ten(int(power))


def power_of_ten(power: int) -> str:
    """Return 10 to a whole power as text with raised digits.

    It is drawn faster than mathematical text.
    """
    return "10" + str(power).translate(RAISED)


def tidy_log_axes(figure: Figure) -> None:
    """Give the logarithmic axes of a figure their ticks, before it is drawn."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if axis.get_scale() == "log":
                tidy_log_axis(axis)


def tidy_log_axis(axis: Axis) -> None:
    """Give a logarithmic axis few ticks.

    Up to three decades have ticks at 1, 2 and 5 in plain numbers, more have powers of ten only.
    Minor ticks would take half of the drawing time.
    """
    low, high = sorted(axis.get_view_interval())
    if high <= 1e3 * low and low >= 1e-3 and high <= 1e4:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(lambda value, _: f"{value:g}")
    else:
        axis.set_major_formatter(lambda value, _: power_of_ten(round(np.log10(value))))
    axis.set_minor_locator(NullLocator())


def gap_label(config: Any, gap_m: float) -> str:
    """Return e.g. '0.289 mm (1.3 % of D)', D the outer width of the tube of a configuration."""
    share = gap_m / outer_width(config.structure.section)
    return f"{gap_m * 1e3:.3g} mm ({share * 100:.3g} % of D)"
