"""The figures of a completed measured structure.

They show responses per force, prediction errors, equivalent support, where the model disagrees, and
the restoring force.
"""

from pathlib import Path

import numpy as np

from vibroimpact.completion.levels import levels_of
from vibroimpact.completion.local_laws import LAWS
from vibroimpact.completion.store import modes_of, trial_of
from vibroimpact.completion.trial import Records
from vibroimpact.config.measured_structure import ELSEWHERE
from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import BLACK, BLUE, GREEN, METHODS, ORANGE, RED, ordered_colours
from vibroimpact.integration.steady_response import steady_series

KINDS = (
    ("error_linear", "linear, lowest level", ORANGE),
    ("error_refitted", "linear, identified again", BLUE),
    ("error_completed", "completed", GREEN),
)
LOOP_PERIODS, LOOP_POINTS = 4, 12000
# The participation of an unmeasured place has an arbitrary scale.
LOOPS = {ELSEWHERE: ("own_displacement", "own_force")}
RESPONSES = {
    "acceleration": "(m/s²)/N",
    "velocity": "(m/s)/N",
    "displacement": "m/N",
    "contact_force": "N/N",
}
COLUMNS = {
    "stiffness": "support_stiffness_change_N_per_m",
    "damping": "support_damping_change_N_s_per_m",
}


def sheets(campaign, study, linear, completed, verdict, mounting, prediction):
    """Return the sheets of a completion, without those that would be empty.

    The arguments are the contents of the workflow's files.
    """
    levels, names, kinds = levels_of(campaign)
    trial = trial_of(completed["trial"])
    records = Records(tuple(levels), study.band_Hz, study.mean)
    predicted = records.predict(trial, LOOP_PERIODS)
    return [
        frf_overlay(
            study, levels, names, kinds, linear, records, predicted if trial.terms else None
        ),
        prediction_errors(study, prediction),
        *([equivalent_support(study, mounting)] if mounting else []),
        where(study, levels, names, linear, verdict),
        *([restoring_force(study, trial, records)] if trial.terms else []),
    ]


def saved_sheets(folder, campaign, study, linear, completed, verdict, mounting, prediction):
    """Return the PNG files of the sheets of a user's completion, saved in a folder.

    The folder is created. The list is empty where no linear model was accepted.
    """
    Path(folder).mkdir(parents=True, exist_ok=True)
    drawn = (
        sheets(campaign, study, linear, completed, verdict, mounting, prediction) if linear else []
    )
    for sheet in drawn:
        sheet.save(folder)
    return [Path(folder) / f"{sheet.name}.png" for sheet in drawn]


def frf_overlay(study, levels, names, kinds, linear, records, predicted):
    """Return the Sheet of responses per force of every level: measured, linear and completed.

    predicted: None without a completed model.
    """
    columns = min(2, len(levels))
    shown = sorted({0, len(levels) - 1, *np.linspace(0, len(levels) - 1, 4).round().astype(int)})
    panels = [(channel, index) for channel in _shown_channels(names) for index in shown]
    keys = [f"{names[channel]}, {levels[index].name}" for channel, index in panels]
    keys += ["."] * (-len(keys) % columns)
    grid = [keys[first : first + columns] for first in range(0, len(keys), columns)]
    sheet = Sheet(
        "frf_overlay",
        f"{study.name}: response per force",
        "Measured response per force at every line (black dots), the linear model of the lowest"
        " level (orange) and the completed model (green). The linear model is the same in every"
        " panel; the measured peak moves and flattens as the level rises.",
        grid,
        size=(7.6, 2.2 * len(grid)),
        sharex=True,
    )
    base = modes_of(linear["base"])
    for channel, index in panels:
        level, axes = levels[index], sheet.axes[f"{names[channel]}, {levels[index].name}"]
        kept = records.kept(level)
        lines = np.flatnonzero(kept & (level.frequency > 0.0))
        frequency, force = level.frequency[lines], level.force[lines]
        curves = (
            (
                "measured",
                level.response[channel, lines] / force,
                BLACK,
                {"linewidth": 0, "marker": ".", "markersize": 2.2},
            ),
            (
                "linear, lowest level",
                base.frf(frequency)[channel],
                ORANGE,
                {"linewidth": 1.0, "linestyle": "--"},
            ),
        )
        if predicted is not None:
            curves += (
                (
                    "completed",
                    predicted[index][channel, (level.frequency[kept] > 0.0)] / force,
                    GREEN,
                    {"linewidth": 0.9},
                ),
            )
        for name, values, colour, style in curves:
            sheet.line(
                axes,
                ("frequency_Hz", frequency),
                ("response_per_force", np.abs(values)),
                name,
                tags={"level": level.name, "channel": names[channel]},
                color=colour,
                label=name,
                **style,
            )
        axes.set_yscale("log")
        unit = RESPONSES.get(kinds[channel], f"{study.unit('m')}/{study.unit('N')}")
        axes.set_ylabel(f"Response per force\n({unit})")
        axes.set_title(f"{names[channel]}, {level.name} ({level.split})", fontsize=8)
    for key in keys[len(panels) - columns : len(panels)]:
        sheet.axes[key].tick_params(
            labelbottom=True
        )  # the last of a column, where the last row is not full
    sheet.legend(sheet.axes[grid[0][0]], fontsize=7)
    return sheet


def _shown_channels(names):
    """Return the first and the last channel, for lack of room for all."""
    return sorted({0, len(names) - 1})


def prediction_errors(study, rows):
    """Return the Sheet of the relative error of every level and channel, for three models."""
    channels = list(dict.fromkeys(row["channel"] for row in rows))
    sheet = Sheet(
        "prediction",
        f"{study.name}: error of the predicted steady response",
        f"RMS of measured minus predicted response between {study.band_Hz[0]:g} and"
        f" {study.band_Hz[1]:g} Hz, over the RMS measured. Levels in bold are held out: no model"
        " but the one identified again has seen them.",
        [channels],
        size=(7.6, 3.2),
        sharey=True,
    )
    for channel in channels:
        axes = sheet.axes[channel]
        own = [row for row in rows if row["channel"] == channel]
        for offset, (column, name, colour) in zip((-0.27, 0.0, 0.27), KINDS, strict=True):
            values = np.array([float(row[column]) for row in own])
            sheet.record(
                axes,
                name,
                level=[str(row["level"]) for row in own],
                split=[row["split"] for row in own],
                relative_response_error=values,
            )
            axes.bar(np.arange(len(own)) + offset, 100.0 * values, 0.25, color=colour, label=name)
        axes.set_xticks(np.arange(len(own)), [str(row["level"]) for row in own])
        for label, row in zip(axes.get_xticklabels(), own, strict=True):
            label.set_fontweight("bold" if row["split"] == "holdout" else "normal")
        axes.set_yscale("log")
        axes.set_title(channel, fontsize=9)
        axes.set_xlabel("Level")
    sheet.axes[channels[0]].set_ylabel("Error / response (%)")
    sheet.legend(sheet.axes[channels[0]], fontsize=7)
    return sheet


def equivalent_support(study, rows):
    """Return the Sheet of stiffness and damping of the mounting against level, by method."""
    unit = study.unit("N")
    sheet = Sheet(
        "mounting",
        f"{study.name}: equivalent stiffness and damping ({study.mounting}) against level",
        "Change of the equivalent bilateral stiffness and damping against the lowest level, that"
        " give the linear model the pole of the peak, the deflection shape round it, the spectra of"
        " the band, or the whole response with all levels fitted together.",
        [["stiffness", "damping"]],
        size=(7.6, 3.4),
    )
    styles = {
        "peak": METHODS["lscf"],
        "ods": METHODS["ods"],
        "broadband": METHODS["broadband"],
        "frf": ("all levels together", BLACK, "x"),
    }
    for column, of_rows, si_unit in (
        (COLUMNS["stiffness"], "k_N_per_m", "N/m"),
        (COLUMNS["damping"], "c_N_s_per_m", "N s/m"),
    ):
        sheet.show_in_prefix(column, si_unit, [float(row[of_rows]) for row in rows])
    for method, (name, colour, marker) in styles.items():
        own = [row for row in rows if row["method"] == method]
        for panel, column in (("stiffness", "k_N_per_m"), ("damping", "c_N_s_per_m")):
            values = np.array([float(row[column]) for row in own])
            load = np.array([float(row["load_rms_N"]) for row in own])
            if own and np.isfinite(values).any():
                shown = f"{panel}_change" if study.units else COLUMNS[panel]
                sheet.line(
                    sheet.axes[panel],
                    ("load_rms_N", load),
                    (shown, values),
                    name,
                    tags={"method": method},
                    color=colour,
                    marker=marker,
                    label=name,
                    markersize=5,
                    linewidth=1,
                    markerfacecolor="none",
                )
    for axes in sheet.axes.values():
        axes.axhline(0.0, color="0.7", linewidth=0.8)
        axes.set_xlabel(f"Load ({unit} RMS)")
    if study.units:
        stiffness = study.unit("N/m")
        sheet.axes["stiffness"].set_ylabel(
            f"Change of k ({stiffness})" if stiffness != "1" else "Change of k (-)"
        )
        sheet.axes["damping"].set_ylabel(
            f"Change of c ({stiffness} s)" if stiffness != "1" else "Change of c (s)"
        )
    sheet.legend(sheet.axes["stiffness"], fontsize=7)
    return sheet


def where(study, levels, names, linear, verdict):
    """Return the Sheet of the squared error of the linear model by frequency, a panel per channel.

    Regions of the verdict are shaded.
    """
    sheet = Sheet(
        "where",
        f"{study.name}: where the linear model of the lowest level is wrong",
        "Share of a record's squared error per line, as running sum over frequency; bars below: the"
        " narrowest stretch that holds most of it.",
        [[name] for name in names],
        size=(7.6, 1.6 + 1.4 * len(names)),
        sharex=True,
    )
    base, colours = modes_of(linear["base"]), ordered_colours([level.load_rms for level in levels])
    for channel, name in enumerate(names):
        axes = sheet.axes[name]
        for place, level in enumerate(levels):
            lines = np.flatnonzero(level.excited(study.band_Hz))
            missed = (
                np.abs(
                    base.frf(level.frequency[lines])[channel] * level.force[lines]
                    - level.response[channel, lines]
                )
                ** 2
            )
            colour = colours[level.load_rms]
            sheet.line(
                axes,
                ("frequency_Hz", level.frequency[lines]),
                ("share_of_error", np.cumsum(missed) / missed.sum()),
                level.name,
                color=colour,
                label=f"{level.name}",
                linewidth=1.1,
            )
            for region in verdict.regions:
                if (
                    region.channel == name
                    and abs(region.load_rms_N - level.load_rms) < 1e-6 * level.load_rms
                ):
                    axes.plot(
                        region.band_Hz,
                        [-0.06 - 0.05 * place] * 2,
                        color=colour,
                        linewidth=3,
                        solid_capstyle="butt",
                    )
        axes.set_title(name, fontsize=9)
        axes.set_ylabel("Share of error (-)")
    sheet.axes[names[0]].plot([], [], color="0.5", linewidth=3, label="holds most of it")
    sheet.legend(sheet.axes[names[0]], fontsize=7)
    return sheet


def restoring_force(study, trial, records):
    """Return the Sheet of the force of the added law against displacement, in the steady state.

    It shows the lowest and the highest level.
    """
    places = list(dict.fromkeys(term.place for term in trial.terms))
    sheet = Sheet(
        "restoring_force",
        f"{study.name}: force of what was added",
        "Force of the added law over its displacement in the steady state of the completed model,"
        " at the highest level (red) and at the lowest (blue): both of one instant, at every time"
        " step of the simulation, without a filter, so that a law without memory is a curve and"
        " only one that takes energy is a loop. No sensor measures this force. It is the change"
        " against the linear structure: a straight falling line is a softer spring.",
        [places],
        size=(7.6, 3.6),
    )
    model, _ = trial.model()
    counts = np.repeat(
        [term.place for term in trial.terms], [LAWS[term.law].elements for term in trial.terms]
    )
    loops = [
        (colour, index, *_loops(records, trial, model, counts, places, index))
        for colour, index in ((RED, len(records.levels) - 1), (BLUE, 0))
    ]
    for column, si_unit, axis in (("relative_displacement", "m", 2), ("restoring_force", "N", 3)):
        largest = [np.abs(values).max() for loop in loops for values in loop[axis].values()]
        sheet.show_in_prefix(column, si_unit, largest)
    for colour, index, displacement, force in loops:
        for place in places:
            across, up = (
                ("output_V", "restoring_V")
                if study.units
                else LOOPS.get(place, ("relative_displacement", "restoring_force"))
            )
            sheet.line(
                sheet.axes[place],
                (across, displacement[place]),
                (up, force[place]),
                records.levels[index].name,
                color=colour,
                linewidth=0.4,
                label=records.levels[index].name,
            )
    for place in places:
        sheet.axes[place].set_title(place, fontsize=9)
    sheet.legend(sheet.axes[places[0]], fontsize=7)
    return sheet


def _loops(records, trial, model, counts, places, index):
    """Return ({place: displacement m}, {place: force N}) of a level at the steps of a period."""
    part, *drive = next(group for group in records.groups if index in group[0])
    drive, samples = records.with_offsets(trial, part, *drive)
    motion, force = steady_series(model, drive, samples, LOOP_PERIODS)
    lane, keep = part.index(index), slice(0, drive.steps, max(1, drive.steps // LOOP_POINTS))
    own = {place: np.flatnonzero(counts == place) for place in places}
    return (
        {place: motion[rows[0], lane, keep] for place, rows in own.items()},
        {place: -force[rows, lane, keep].sum(axis=0) for place, rows in own.items()},
    )
