"""The pole of the main peak (figure 9): its width, the poles against load, and the stabilisation
charts of LSCF, poles by model order over the spectrum.
"""

from dataclasses import replace

import numpy as np

from vibroimpact.identify.linear.poles import first_pole, frequency_of
from vibroimpact.identify.peak import LEVELS, level_edges
from vibroimpact.identify.stabilisation import STABLE_DAMPING, STABLE_FREQUENCY
from vibroimpact.reports.figures.plot import Axis, Mark, Panel, Plot, Series, Text
from vibroimpact.reports.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    RED,
    gap_label,
    ordered_colours,
)

from .cases_of_gap import first_seed, spread_loads, transition_load
from .equivalent import look_of
from .linear_limits import contact_stiffness
from .psd_table import driven_sensor, inside
from .seed_scatter import over_seeds

SHOWN_PEAKS = 5
POLE_METHODS = ("peak_half", "peak_quarter", "peak_25th", "lscf")
NEAR = 1.6  # times the frequency of the main peak: the range of a chart to both sides
ALL = ("frequency", "damping", "participation")  # the values of a pole that can be stable
FEWEST_ORDERS = 5  # with a stable pole, which make a column
# Kind of a pole: how it looks.
KINDS = {
    "new": {"marker": "x", "colour": ORANGE, "size": 3.5},
    "stable in frequency": {"marker": "o", "hollow": True, "colour": BLUE, "size": 4},
    "stable in all": {"marker": "o", "colour": GREEN, "size": 4.5},
}
TAKEN = {"marker": "o", "hollow": True, "colour": RED, "size": 9, "order": 1.5}


def figure_09_poles(config, model, curves, spectra, rows):
    """Return the Plot of the main peaks with their widths, and of the poles against load.

    curves, spectra: {Case: Dataset} of one gap; rows: table rows of that gap.
    """
    gap = next(iter(curves)).gap_m
    sensor = driven_sensor(config, config.identification.response_point)
    caption = (
        f"Main peak at {sensor}, gap"
        f" {gap_label(config, gap)}. Left: PSD of displacement /"
        " load² of one seed (thin), the resonance curve fitted to it (thick), and its widths at"
        " 1/2, 1/4 and 1/25 of the height (bars). Right: frequency and damping ratio of the peak"
        " against load from the widths and from an output-only LSCF: median and range over seeds."
        " Dotted: the free tube and the tube in full bilateral contact. The width between these is"
        " no dissipation: the support's stiffness varies."
    )
    cases, loads = first_seed(curves), spread_loads(rows, SHOWN_PEAKS)
    colours = ordered_colours(loads)
    band = config.identification.peak_search_Hz
    peaks = []
    for load in loads:
        files = curves[cases[load]], spectra[cases[load]].sel(sensor=sensor)
        poles = [row for row in rows if row["load_rms_N"] == load]
        poles = {row["method"]: row for row in poles if row["seed"] == cases[load].seed}
        peaks += _peak(files, poles, load, band, colours[load])
    if peaks and peaks[-1].curve.startswith("width"):
        peaks[-1] = replace(peaks[-1], label="widths at 1/2, 1/4, 1/25")
    axes = Axis("frequency_Hz", False, *band), Axis("psd_per_load2_m2_per_N2_per_Hz", True)
    legend = {"legend": "lower left", "legend_title": "load"}
    panels = {
        "peaks": Panel(*axes, peaks, f"{sensor}, first seed", **legend),
        "frequency": _against_load(model, rows, "peak_frequency_Hz", "frequency_Hz"),
        "damping": _against_load(model, rows, "damping_ratio", "damping_ratio"),
    }
    title = "Main peak: frequency and width against load"
    rows = [["peaks", "frequency"], ["peaks", "damping"]]
    return Plot("figure_09_poles", title, caption, panels, rows, (7.6, 5.0), widths=(1.15, 1.0))


def _against_load(model, rows, column, table_column):
    """Return the Panel of frequency or damping ratio against load, between its linear limits."""
    items = []
    for method in POLE_METHODS:
        poles = [{**row, column: row[table_column]} for row in rows if row["method"] == method]
        hollow = method in ("peak_quarter", "peak_25th")
        look = look_of(method) | {"width": 0.9, "hollow": hollow, "order": None}
        items += over_seeds(poles, "load_rms_N", column, method, **look)
    frequency = column == "peak_frequency_Hz"
    for k, name in ((0.0, "free"), (contact_stiffness(model), "in full contact")):
        value = frequency_of(first_pole(model, k, 0.0))[0 if frequency else 1]
        items.append(Mark(name, "y", value, colour=GREY, line=":", width=1.0))
        look = {"shift": (-2, 2), "align": ("right", "bottom"), "colour": GREY}
        items.append(Text(name, 1.0, value, "x", **look))
    loads = Axis("load_rms_N", True, bare=frequency)
    title, legend = ("frequency", "upper left") if frequency else ("damping ratio", "")
    return Panel(loads, Axis(column), items, title, legend=legend)


def _peak(files, poles, load, band_Hz, colour):
    """Return the peak at a load, its fitted curve and its widths at the three levels.

    files: (estimates, spectra at the sensor) of the case. poles: {method: row of the table}.
    """
    fitted, spectrum = files
    tags = {"load_rms_N": load}
    frequency = spectrum["frequency"].values
    kept = inside(frequency, band_Hz)
    psd = spectrum["psd_displacement_mean"].values[kept].astype(float) / load**2
    look = {"colour": colour, "width": 0.6, "alpha": 0.7}
    items = [Series("PSD", frequency[kept], psd, tags, **look)]
    for method, level in LEVELS.items():
        curve = fitted["peak_curve"].sel(level=method).values
        known, pole = np.isfinite(curve), poles.get(method)
        if pole is None or not known.any() or not np.isfinite(pole["frequency_Hz"]):
            continue
        if method == "peak_half":
            place, label = fitted["low_frequency"].values[known], f"{load:.3g} N"
            look = {"colour": colour, "width": 1.8, "label": label}
            items.append(Series("fitted to 1/2", place, curve[known] / load**2, tags, **look))
        edges = np.array(level_edges(pole["frequency_Hz"], pole["damping_ratio"], level))
        height = np.full(2, np.nanmax(curve) / level / load**2)
        look = {"colour": BLACK, "marker": "|", "width": 0.9, "size": 5, "order": 5}
        items.append(Series(f"width at 1/{level:g}", edges, height, tags, **look))
    return items


def figure_09_stabilisation(config, curves, spectra, rows):
    """Return the Plot of the stabilisation charts at two loads.

    They are the load of the widest peak and the largest load.
    """
    cases = first_seed(curves)
    stable = {
        load for load, case in cases.items() if _orders_of_pole(curves[case]) >= FEWEST_ORDERS
    }
    chosen = [row for row in rows if row["load_rms_N"] in stable] or rows
    loads = sorted({transition_load(chosen), max(cases)})
    sensor = driven_sensor(config, config.identification.response_point)
    caption = (
        "Stabilisation charts of the output-only LSCF, first seed, gap"
        f" {gap_label(config, next(iter(curves)).gap_m)}: poles"
        f" by model order over the PSD of displacement at {sensor} (grey, logarithmic, right axis)."
        " Poles near the main peak alone. A pole is stable when"
        f" frequency ({STABLE_FREQUENCY:.0%}), damping ({STABLE_DAMPING:.0%}) and participation"
        " keep their values from the order below. Circled: the pole that is taken; line: its"
        f" column, stable in {FEWEST_ORDERS} or more orders at {len(stable)} of {len(cases)} loads."
        f" Shown: {'of these, ' if stable else ''}the load at which the peak is widest, and the"
        " largest load."
    )
    band = config.identification.peak_search_Hz
    panels = {}
    for load in loads:
        fitted, spectrum = curves[cases[load]], spectra[cases[load]]
        taken, _ = pole_taken(fitted)
        low, high = (max(band[0], taken / NEAR), min(band[1], taken * NEAR))
        near = (low, high) if np.isfinite(taken) else band
        panels[f"{load:g} N"] = chart_panel(fitted, spectrum, sensor, near)
    title = "LSCF poles of the main peak, by model order"
    return Plot("figure_09_stabilisation", title, caption, panels, share="y", legend=4)


def pole_taken(fitted):
    """Return (frequency in Hz of the poles taken, NaN for none, places of the poles).

    At each order taken it is the pole nearest to the fitted peak.
    """
    curve = fitted["peak_curve"].values[0]
    if "chart_order" not in fitted or not np.isfinite(curve).any():
        return np.nan, []
    order, place = fitted["chart_order"].values, fitted["chart_frequency"].values
    peak = fitted["low_frequency"].values[np.nanargmax(curve)]
    chosen = []
    for taken in np.unique(fitted["chart_orders_taken"].values):
        here = np.flatnonzero((order == taken) & (fitted["chart_damping_ratio"].values > 0.0))
        if here.size:
            chosen.append(here[np.argmin(np.abs(place[here] - peak))])
    return (float(np.median(place[chosen])) if chosen else np.nan), chosen


def _stable(fitted, *names):
    """Return (pole,) bool: whether poles keep some of their values from the order below."""
    return np.all([fitted[f"chart_stable_{name}"].values.astype(bool) for name in names], axis=0)


def _orders_of_pole(fitted):
    """Return in how many orders a pole within STABLE_FREQUENCY of the one taken is stable."""
    taken, chosen = pole_taken(fitted)
    if not chosen:
        return 0
    own = np.abs(fitted["chart_frequency"].values / taken - 1.0) < STABLE_FREQUENCY
    own &= _stable(fitted, *ALL)
    return np.unique(fitted["chart_order"].values[own]).size


def chart_panel(fitted, spectrum, sensor, band_Hz):
    """Return the Panel of the poles of a case inside a band over the PSD of a sensor."""
    frequency = spectrum["frequency"].values
    kept = inside(frequency, band_Hz)
    psd = spectrum["psd_displacement_mean"].sel(sensor=sensor).values[kept]
    look = {"colour": GREY, "width": 0.7, "alpha": 0.7}
    behind = Series("PSD", frequency[kept], psd, right=True, **look)
    title = f"load {spectrum.attrs['load_rms_N']:.3g} N RMS"
    axes = Axis("frequency_Hz", False, *band_Hz), Axis("model_order")
    right = Axis("psd_m2_per_Hz", True)
    if "chart_order" not in fitted:
        note = "no pole found near the main peak"
        return Panel(*axes, [behind], title, note, right)
    place, ratio = (fitted[f"chart_{name}"].values for name in ("frequency", "damping_ratio"))
    order = fitted["chart_order"].values.astype(float)
    steady, stable = _stable(fitted, "frequency"), _stable(fitted, *ALL)
    physical = (ratio > 0.0) & inside(place, band_Hz)
    items = [behind]
    for (name, look), kind in zip(KINDS.items(), (~steady, steady & ~stable, stable), strict=True):
        kept = kind & physical
        hover = [
            f"{name}: {f:.2f} Hz, damping ratio {100 * z:.2f} %, order {n:g}"
            for f, z, n in zip(place[kept], ratio[kept], order[kept], strict=True)
        ]
        tags = {"damping_ratio": ratio[kept]}
        look = {**look, "line": "", "label": name, "hover": hover}
        items.append(Series(name, place[kept], order[kept], tags, **look))
    taken, own = pole_taken(fitted)
    if own:
        items.append(Mark("pole taken", "x", taken, colour=RED, width=0.8))
        label = "taken for the main peak"
        items.append(Series("taken", place[own], order[own], line="", label=label, **TAKEN))
        found = f"stable in {_orders_of_pole(fitted)} of {np.unique(order).size} orders"
        title = f"{title}\n{taken:.2f} Hz, {found}"
    return Panel(*axes, items, title, right=right)
