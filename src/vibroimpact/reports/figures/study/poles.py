"""The pole of the main peak: its width and the poles against load (figure 9)."""

from dataclasses import replace

import numpy as np

from vibroimpact.identify.linear.poles import first_pole, frequency_of
from vibroimpact.identify.peak import LEVELS, level_edges
from vibroimpact.reports.figures.plot import Axis, Mark, Panel, Plot, Series, Text
from vibroimpact.reports.figures.style import BLACK, GREY, gap_label, ordered_colours

from .cases_of_gap import first_seed, spread_loads
from .equivalent import look_of
from .linear_limits import contact_stiffness
from .psd_table import driven_sensor, inside
from .seed_scatter import over_seeds

SHOWN_PEAKS = 5
POLE_METHODS = ("peak_half", "peak_quarter", "peak_25th", "lscf")


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
