"""The pole of the main peak: its width and the poles (figure 9), and the stabilisation chart."""

from __future__ import annotations

import numpy as np

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    METHODS,
    ORANGE,
    RED,
    gap_label,
    ordered_colours,
    shown,
)
from vibroimpact.geometry.sections import outer_width
from vibroimpact.identify.peak import LEVELS, level_edges
from vibroimpact.identify.stabilisation import STABLE_DAMPING, STABLE_FREQUENCY
from vibroimpact.linear.poles import first_pole

from .cases_of_gap import first_seed, spread_loads, transition_load
from .linear_limits import contact_stiffness
from .psd_table import driven_sensor
from .seed_scatter import over_seeds

SHOWN_PEAKS = 5
NEAR = 1.6  # times the frequency of the main peak: what a chart shows to both sides
FEWEST_ORDERS = 5  # with a stable pole, which make a column
POLE_METHODS = ("peak_half", "peak_quarter", "peak_25th", "lscf")


def figure_09_poles(config, model, curves, spectra, rows):
    """Return the Sheet of the main peaks with their widths, and of the poles against load.

    curves, spectra: {Case: Dataset} of one gap; rows: table rows of that gap.
    """
    gap = next(iter(curves)).gap_m
    caption = (
        f"Main peak at {driven_sensor(config, config.identification.response_point)}, gap"
        f" {gap_label(gap, outer_width(config.structure.section))}. Left: PSD of displacement /"
        " load² of one seed (thin), the resonance curve fitted to it (thick), and its widths at"
        " 1/2, 1/4 and 1/25 of the height (bars). Right: frequency and damping ratio of the peak"
        " against load from the widths and from an output-only LSCF: median and range over seeds."
        " Dotted: the free tube and the tube in full bilateral contact. The width between these is"
        " no dissipation: the support's stiffness varies."
    )
    sheet = Sheet(
        "figure_09_poles",
        "Main peak: frequency and width against load",
        caption,
        [["peaks", "frequency"], ["peaks", "damping"]],
        size=(7.6, 5.0),
        width_ratios=(1.15, 1.0),
    )
    _peaks(sheet, sheet.axes["peaks"], config, curves, spectra, rows)
    for name, column, table_column in (
        ("frequency", "peak_frequency_Hz", "frequency_Hz"),
        ("damping", "damping_ratio", "damping_ratio"),
    ):
        axes = sheet.axes[name]
        for method in POLE_METHODS:
            label, colour, marker = METHODS[method]
            poles = [{**row, column: row[table_column]} for row in rows if row["method"] == method]
            over_seeds(
                sheet,
                axes,
                poles,
                "load_rms_N",
                column,
                method,
                color=colour,
                marker=marker,
                label=label,
                linewidth=0.9,
                markerfacecolor="white" if method in ("peak_quarter", "peak_25th") else colour,
            )
        axes.set_xscale("log")
    for k, name in ((0.0, "free"), (contact_stiffness(model), "in full contact")):
        pole = first_pole(model, k, 0.0)
        for axes, column, value in (
            ("frequency", "peak_frequency_Hz", abs(pole) / (2.0 * np.pi)),
            ("damping", "damping_ratio", -pole.real / abs(pole)),
        ):
            sheet.mark(
                sheet.axes[axes],
                column,
                value,
                name,
                vertical=False,
                color=GREY,
                linestyle=":",
                linewidth=1.0,
            )
            sheet.axes[axes].annotate(
                name,
                (1.0, shown(column, value)),
                xycoords=("axes fraction", "data"),
                xytext=(-2, 2),
                textcoords="offset points",
                ha="right",
                va="bottom",
                fontsize=8,
                color=GREY,
            )
    sheet.axes["frequency"].set_title("frequency")
    sheet.axes["damping"].set_title("damping ratio")
    sheet.axes["frequency"].set_xlabel("")
    sheet.axes["frequency"].margins(y=0.12)
    sheet.figure.align_ylabels([sheet.axes["frequency"], sheet.axes["damping"]])
    sheet.legend(sheet.axes["frequency"], loc="upper left")
    return [sheet]


def _peaks(sheet, axes, config, curves, spectra, rows):
    """Draw the peaks of some loads, their fitted curves and their widths at the three levels."""
    axes.set_title(f"{driven_sensor(config, config.identification.response_point)}, first seed")
    cases = first_seed(curves)
    loads = spread_loads(rows, SHOWN_PEAKS)
    colours = ordered_colours(loads)
    low, high = config.identification.peak_search_Hz
    for load in loads:
        case = cases[load]
        fitted, spectrum = curves[case], spectra[case]
        frequency = spectrum["frequency"].values
        inside = (frequency >= low) & (frequency <= high)
        psd = (
            spectrum["psd_displacement_mean"]
            .sel(sensor=driven_sensor(config, config.identification.response_point))
            .values[inside]
            .astype(float)
        )
        column = "psd_per_load2_m2_per_N2_per_Hz"
        sheet.line(
            axes,
            ("frequency_Hz", frequency[inside]),
            (column, psd / load**2),
            "PSD",
            tags={"load_rms_N": load},
            color=colours[load],
            linewidth=0.6,
            alpha=0.7,
        )
        poles = {
            row["method"]: row
            for row in rows
            if row["load_rms_N"] == load and row["seed"] == case.seed
        }
        for method, level in LEVELS.items():
            curve = fitted["peak_curve"].sel(level=method).values
            known = np.isfinite(curve)
            pole = poles.get(method)
            if pole is None or not known.any() or not np.isfinite(pole["frequency_Hz"]):
                continue
            if method == "peak_half":
                sheet.line(
                    axes,
                    ("frequency_Hz", fitted["low_frequency"].values[known]),
                    (column, curve[known] / load**2),
                    "fitted to 1/2",
                    tags={"load_rms_N": load},
                    color=colours[load],
                    linewidth=1.8,
                    label=f"{load:.3g} N",
                )
            edges = np.array(level_edges(pole["frequency_Hz"], pole["damping_ratio"], level))
            sheet.line(
                axes,
                ("frequency_Hz", edges),
                (column, np.full(2, np.nanmax(curve) / level / load**2)),
                f"width at 1/{level:g}",
                tags={"load_rms_N": load},
                color=BLACK,
                marker="|",
                linewidth=0.9,
                markersize=5,
                zorder=5,
                label=(
                    "widths at 1/2, 1/4, 1/25"
                    if (load, method) == (loads[-1], "peak_25th")
                    else None
                ),
            )
    axes.set_yscale("log")
    axes.set_xlim(low, high)
    sheet.legend(axes, loc="lower left", title="load")


def figure_09_stabilisation(config, curves, spectra, rows):
    """Return the Sheet of the stabilisation charts at two loads.

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
        f" {gap_label(next(iter(curves)).gap_m, outer_width(config.structure.section))}: poles"
        f" by model order over the PSD of displacement at {sensor} (grey, logarithmic, right axis)."
        " Poles near the main peak alone. A pole is stable when"
        f" frequency ({STABLE_FREQUENCY:.0%}), damping ({STABLE_DAMPING:.0%}) and participation"
        " keep their values from the order below. Circled: the pole that is taken; line: its"
        f" column, stable in {FEWEST_ORDERS} or more orders at {len(stable)} of {len(cases)} loads."
        f" Shown: {'of these, ' if stable else ''}the load at which the peak is widest, and the"
        " largest load."
    )
    sheet = Sheet(
        "figure_09_stabilisation",
        "LSCF poles of the main peak, by model order",
        caption,
        [[f"{load:g} N" for load in loads]],
        size=(7.6, 4.2),
        sharey=True,
    )
    for load in loads:
        _chart(
            sheet,
            sheet.axes[f"{load:g} N"],
            config,
            curves[cases[load]],
            spectra[cases[load]],
            sensor,
        )
    for key in [f"{load:g} N" for load in loads][1:]:
        sheet.axes[key].set_ylabel("")
    handles, labels = sheet.axes[f"{loads[0]:g} N"].get_legend_handles_labels()
    if handles:
        sheet.figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return [sheet]


def _pole_taken(fitted):
    """Return (frequency in Hz of the poles taken, NaN for none, places of the poles).

    At each order taken it is the pole nearest to the fitted peak.
    """
    curve = fitted["peak_curve"].values[0]
    order, place = fitted["chart_order"].values, fitted["chart_frequency"].values
    if not np.isfinite(curve).any():
        return np.nan, []
    peak = fitted["low_frequency"].values[np.nanargmax(curve)]
    chosen = []
    for taken in np.unique(fitted["chart_orders_taken"].values):
        here = np.flatnonzero((order == taken) & (fitted["chart_damping_ratio"].values > 0.0))
        if here.size:
            chosen.append(here[np.argmin(np.abs(place[here] - peak))])
    return (float(np.median(place[chosen])) if chosen else np.nan), chosen


def _orders_of_pole(fitted):
    """Return in how many orders a pole within STABLE_FREQUENCY of the one taken is stable."""
    if "chart_order" not in fitted:
        return 0
    taken, _ = _pole_taken(fitted)
    own = np.abs(fitted["chart_frequency"].values / taken - 1.0) < STABLE_FREQUENCY
    for name in ("frequency", "damping", "participation"):
        own &= fitted[f"chart_stable_{name}"].values.astype(bool)
    return np.unique(fitted["chart_order"].values[own]).size


def _chart(sheet, axes, config, fitted, spectrum, sensor):
    """Draw one chart over the PSD."""
    low, high = config.identification.peak_search_Hz
    taken, own = _pole_taken(fitted) if "chart_order" in fitted else (np.nan, [])
    if own:
        low, high = max(low, taken / NEAR), min(high, taken * NEAR)
    load = f"load {spectrum.attrs['load_rms_N']:.3g} N RMS"
    axes.set_title(load)
    frequency = spectrum["frequency"].values
    inside = (frequency >= low) & (frequency <= high)
    behind = axes.twinx()
    behind.set_label(f"{axes.get_label()} PSD")
    sheet.line(
        behind,
        ("frequency_Hz", frequency[inside]),
        ("psd_m2_per_Hz", spectrum["psd_displacement_mean"].sel(sensor=sensor).values[inside]),
        "PSD",
        color=GREY,
        linewidth=0.7,
        alpha=0.7,
    )
    behind.set_yscale("log")
    behind.grid(False)
    axes.set_zorder(behind.get_zorder() + 1)
    axes.patch.set_visible(False)
    axes.set_xlim(low, high)
    if "chart_order" not in fitted:
        sheet.note(axes, "no pole found near the main peak", "frequency_Hz", "model_order")
        return
    order, place = fitted["chart_order"].values.astype(float), fitted["chart_frequency"].values
    flags = {
        name: fitted[f"chart_stable_{name}"].values.astype(bool)
        for name in ("frequency", "damping", "participation")
    }
    physical = (fitted["chart_damping_ratio"].values > 0.0) & (place >= low) & (place <= high)
    stable = flags["frequency"] & flags["damping"] & flags["participation"]
    kinds = (
        ("new", ~flags["frequency"], {"marker": "x", "color": ORANGE, "markersize": 3.5}),
        (
            "stable in frequency",
            flags["frequency"] & ~stable,
            {"marker": "o", "markerfacecolor": "white", "color": BLUE, "markersize": 4},
        ),
        ("stable in all", stable, {"marker": "o", "color": GREEN, "markersize": 4.5}),
    )
    for name, chosen, style in kinds:
        chosen = chosen & physical
        sheet.line(
            axes,
            ("frequency_Hz", place[chosen]),
            ("model_order", order[chosen]),
            name,
            tags={"damping_ratio": fitted["chart_damping_ratio"].values[chosen]},
            linestyle="none",
            label=name,
            **style,
        )
    if own:
        _mark_taken(sheet, axes, taken, place[own], order[own])
        found = f"stable in {_orders_of_pole(fitted)} of {np.unique(order).size} orders"
        axes.set_title(f"{load}\n{taken:.2f} Hz, {found}")


def _mark_taken(sheet, axes, taken, place, order):
    """Mark the pole that is taken: a line at its frequency, and a circle at each of its orders."""
    sheet.mark(axes, "frequency_Hz", taken, "pole taken", color=RED, linewidth=0.8)
    sheet.line(
        axes,
        ("frequency_Hz", place),
        ("model_order", order),
        "taken",
        linestyle="none",
        marker="o",
        markersize=9,
        markerfacecolor="none",
        color=RED,
        label="taken for the main peak",
    )
