"""The one style of all figures: sizes, colours, markers, and the axis label and display unit of
every plotted column.

Colours are those of Okabe and Ito, told apart with any colour vision; what differs in colour also
differs in marker or line. Quantities with an order (load, stiffness) take a colour map whose
lightness rises with the value.
"""

from __future__ import annotations

import matplotlib
import numpy as np
from matplotlib.colors import ListedColormap, LogNorm, to_hex
from matplotlib.ticker import LogLocator, NullLocator

BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, RED, PINK = (
    "#000000",
    "#E69F00",
    "#56B4E9",
    "#009E73",
    "#F0E442",
    "#0072B2",
    "#D55E00",
    "#CC79A7",
)
BROWN, GREY, PALE = "#8C5A1E", "#7F7F7F", "#D9D9D9"

PARAMETERS = {
    "figure.constrained_layout.w_pad": 0.06,
    "figure.constrained_layout.h_pad": 0.06,
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
ORDERED = ListedColormap(
    matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, 256))
)  # without the lightest tenth, too pale for lines

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

# column of the data -> (axis label, display units per SI unit)
COLUMNS = {
    "x_m": ("x (m)", 1.0),
    "y_m": ("y, out of plane (m)", 1.0),
    "z_m": ("z (m)", 1.0),
    "across_m": ("Across (mm)", 1e3),
    "along_m": ("Along the tube (mm)", 1e3),
    "horizontal_m": ("Horizontal, as seen (m)", 1.0),
    "vertical_m": ("Vertical, as seen (m)", 1.0),
    "section_e1_m": ("First transverse axis (mm)", 1e3),
    "section_e2_m": ("Second transverse axis (mm)", 1e3),
    "height_in_support_m": ("Height from the middle of the support (mm)", 1e3),
    "stiffness_density_N_per_m2": ("Stiffness per unit height (MN/m²)", 1e-6),
    "radial_displacement_m": ("Radial displacement of the tube (mm)", 1e3),
    "contact_force_N": ("Contact force (N)", 1.0),
    "k_N_per_m": ("Equivalent k (N/m per support)", 1.0),
    "c_N_s_per_m": ("Equivalent c (N s/m per support)", 1.0),
    "support_stiffness_N_per_m": ("Bilateral stiffness k per support (N/m)", 1.0),
    "frequency_Hz": ("Frequency (Hz)", 1.0),
    "first_frequency_Hz": ("First frequency, out of plane (Hz)", 1.0),
    "peak_frequency_Hz": ("Peak frequency (Hz)", 1.0),
    "damping_ratio": ("Damping ratio (%)", 1e2),
    "load_rms_N": ("Load (N RMS)", 1.0),
    "load_over_gap_N_per_m": ("Load / gap (N/mm)", 1e-3),
    "psd_m2_per_Hz": ("PSD of displacement (m²/Hz)", 1.0),
    "psd_m2_per_s4_per_Hz": ("PSD of acceleration ((m/s²)²/Hz)", 1.0),
    "psd_per_load2_m2_per_N2_per_Hz": ("PSD of displacement / load² (m²/N²/Hz)", 1.0),
    "psd_per_force_psd_m2_per_N2": ("PSD of displacement / PSD of force (m²/N²)", 1.0),
    "psd_dB": ("PSD / load² (dB re 1 m²/N²/Hz)", 1.0),
    "psd_per_force_psd_dB": ("|response|² (dB re 1 m²/N²)", 1.0),
    "arc_length_m": ("Arc length from the left root (m)", 1.0),
    "shape": ("Shape, y (largest = 1)", 1.0),
    "singular_value": ("Singular value / first one (-)", 1.0),
    "mac": ("MAC (-)", 1.0),
    "quadrature": ("Quadrature / in phase (-)", 1.0),
    "model_order": ("Model order (-)", 1.0),
    "relative_error": ("Relative error of the frequencies (-)", 1.0),
    "energy_J": ("Energy (J)", 1.0),
    "time_s": ("Time (s)", 1.0),
    "residual": ("Residual / input work (-)", 1.0),
    "in_plane_share_dB": ("In-plane / out-of-plane mean square (dB)", 1.0),
    "contact_fraction": ("Time in contact (%)", 1e2),
    "impact_rate_per_s": ("Impacts per second (1/s)", 1.0),
    "force_N": ("Support force (N)", 1.0),
    "impact_velocity_m_per_s": ("Impact velocity (mm/s)", 1e3),
    "wear_work_rate_W": ("Wear work rate (W)", 1.0),
    "stress_Pa": ("Bending stress (MPa)", 1e-6),
    "cpu_s": ("CPU time (s)", 1.0),
    "response_per_force": ("|response / force| (unit/N)", 1.0),
    "share_of_error": ("Running share of error (-)", 1.0),
    "support_stiffness_change_N_per_m": ("Change of k (MN/m)", 1e-6),
    "support_damping_change_N_s_per_m": ("Change of c (kN s/m)", 1e-3),
    "relative_displacement": ("Relative displacement (mm)", 1e3),
    "restoring_force": ("Force (N)", 1.0),
    "stiffness_change": ("Change of k (-)", 1.0),
    "damping_change": ("Change of c (s)", 1.0),
    "output_V": ("Output (V)", 1.0),
    "restoring_V": ("Force (V)", 1.0),
    "own_displacement": ("Motion of the hidden place (arbitrary scale)", 1.0),
    "own_force": ("Its force (arbitrary scale)", 1.0),
    "discrepancy_dB": ("Measured / simulated (dB)", 1.0),
    "z": ("z (standard deviations)", 1.0),
    "heldout_score": ("Score on held-out records (-)", 1.0),
    "score": ("Score (-)", 1.0),
    "parameter": ("Parameter (in its unit)", 1.0),
    "place_in_list": ("Place in the list (-)", 1.0),
    "psd_N2_per_Hz": ("PSD of force (N²/Hz)", 1.0),
    "psd_m2_per_s2_per_Hz": ("PSD of velocity ((m/s)²/Hz)", 1.0),
    "psd_V2_per_Hz": ("PSD of voltage (V²/Hz)", 1.0),
    "psd_unit2_per_Hz": ("PSD (unit²/Hz)", 1.0),
    "rms_over_lowest": ("RMS / RMS of the lowest level (-)", 1.0),
    "rate": (
        "Share of campaigns; of the two medians: relative error, share of the excess closed (%)",
        1e2,
    ),
    "campaigns": ("Campaigns (-)", 1.0),
    "strength_over_floor": (
        "Strength: misfit of the bare model beyond its floor, held-out records (floors)",
        1.0,
    ),
    "found": ("Truth in the set (%)", 1e2),
    "estimate_over_truth": ("Estimate / truth (-)", 1.0),
}

METHODS = {
    # method -> (name in legends, colour, marker); the three that are compared are filled, the
    # others open
    "peak_half": ("peak width at 1/2", ORANGE, "v"),
    "peak_quarter": ("peak width at 1/4", BROWN, "<"),
    "peak_25th": ("peak width at 1/25", SKY, ">"),
    "lscf": ("LSCF pole", BLUE, "o"),
    "ods": ("deflection shape", GREEN, "s"),
    "broadband": ("broadband PSD", RED, "D"),
    "statistical_linearisation": ("statistical linearisation", PINK, "x"),
    "secant": ("mean secant stiffness", BLACK, "+"),
}
OPEN_METHODS = ("peak_half", "peak_quarter", "peak_25th")
GAP_COLOURS, GAP_MARKERS = (BLUE, ORANGE, GREEN, RED, PINK, BLACK), ("o", "s", "^", "D", "v", "P")


def label_of(column):
    """Return the axis label, with its unit, of a column. Raises KeyError for a column that COLUMNS
    does not know.
    """
    return COLUMNS[column][0]


def shown(column, values):
    """Return SI values in the unit of the axis, as an array."""
    return np.asarray(values, dtype=float) * COLUMNS[column][1]


def ordered_norm(values):
    """Return the logarithmic scale on which positive values are coloured; a single value gets some
    room.
    """
    low, high = float(np.min(values)), float(np.max(values))
    return LogNorm(low, high) if low < high else LogNorm(0.9 * low, 1.1 * low)


def ordered_colours(values):
    """Return {value: colour} for positive values, by their logarithm from dark to light."""
    norm = ordered_norm(values)
    return {value: to_hex(ORDERED(float(norm(value)))) for value in values}


def number(value):
    """Return a value as text with 3 digits, powers of ten raised: 4×10⁶, 0.289."""
    text = f"{value:.3g}"
    if "e" not in text:
        return text
    digits, power = text.split("e")
    return f"{digits}×{power_of_ten(int(power))}" if digits != "1" else power_of_ten(int(power))


def power_of_ten(power):
    """Return 10 to a whole power as text with raised digits, which is drawn at once; mathematical
    text would be parsed, at some cost.
    """
    return "10" + str(power).translate(RAISED)


def tidy_log_axis(axis):
    """Give a logarithmic axis few ticks: of up to three decades at 1, 2 and 5 in plain numbers, of
    more at powers of ten only.

    Minor ticks tell little here and take half of the drawing time.
    """
    low, high = sorted(axis.get_view_interval())
    if high <= 1e3 * low and low >= 1e-3 and high <= 1e4:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(lambda value, _: f"{value:g}")
    else:
        axis.set_major_formatter(lambda value, _: power_of_ten(round(np.log10(value))))
    axis.set_minor_locator(NullLocator())


def gap_label(gap_m, diameter_m):
    """Return e.g. '0.289 mm (1.3 % of D)'."""
    return f"{gap_m * 1e3:.3g} mm ({gap_m / diameter_m * 100:.3g} % of D)"
