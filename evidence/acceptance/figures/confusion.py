"""Hidden effects against the first effect of the verdict."""

from __future__ import annotations

import numpy as np
from matplotlib.patches import Rectangle

from vibroimpact.diagnosis.verdict.content import CONCLUSIONS
from vibroimpact.reports.figures.sheet import Sheet
from vibroimpact.reports.figures.style import BLACK, GREY

GROUPS = ("nothing", "in the catalogue", "another law", "fault", "stranger")
RIGHT_PAIR = "the right pair"
OTHER_PAIR = "another pair"
PAIR = "two effects"
VERDICTS = tuple(conclusion for conclusion in CONCLUSIONS if conclusion != "named")
CELL_IN = 0.27
SHADES = "Blues"


def confusion_figure(confusion):
    """Return [Sheet] of the confusion matrix.

    confusion: rows of confusion.csv {group, hidden, first_name, campaigns}.
    """
    caption = (
        "Rows: what was hidden; columns: the name that came first, or the verdict where nothing was"
        " named. Numbers: campaigns. Framed: the right answer. To strangers, which no name of the"
        " catalogue fits, the right answer is unknown; a partial explanation, which counts under"
        " its first name, is not wrong there. To another law of a family that the catalogue has, a"
        " name of that family is right. Faults without a name are right where the campaign was"
        " flagged, which the rates tell. Pairs share a row; the figure's table lists each."
    )
    cells = _cells(confusion)
    hidden = sorted(
        {row for row, _ in cells}, key=lambda at: (GROUPS.index(at[0]), at[1] == PAIR, at[1])
    )
    names = _columns(hidden, {name for _, name in cells})
    size = (4.0 + CELL_IN * max(len(names), 8), 3.0 + CELL_IN * max(len(hidden), 4))
    sheet = Sheet(
        "acceptance_confusion", "What was hidden, and what came first", caption, size=size
    )
    axes = sheet.axes["main"]
    axes.set(xlabel="Came first, or verdict where nothing was named", ylabel="Hidden")
    axes.grid(False)
    if not confusion:
        axes.text(
            0.5, 0.5, "no campaign was judged", transform=axes.transAxes, ha="center", va="center"
        )
        axes.set(xticks=[], yticks=[])
        return [sheet]
    counts = np.zeros((len(hidden), len(names)), int)
    for row in confusion:
        sheet.record(
            axes,
            row["group"],
            hidden=row["hidden"],
            first_name=row["first_name"],
            campaigns=row["campaigns"],
        )
    for (at, name), campaigns in cells.items():
        counts[hidden.index(at), names.index(name)] = campaigns
    axes.imshow(
        np.ma.masked_equal(counts, 0),
        cmap=SHADES,
        vmin=-0.4 * counts.max(),
        vmax=2.2 * counts.max(),
        aspect="equal",
    )
    for row, column in np.argwhere(counts):
        axes.text(column, row, counts[row, column], ha="center", va="center", fontsize=8.5)
    for place, at in enumerate(hidden):
        if (right := _right(*at)) in names:
            axes.add_patch(
                Rectangle(
                    (names.index(right) - 0.5, place - 0.5),
                    1.0,
                    1.0,
                    fill=False,
                    edgecolor=BLACK,
                    linewidth=1.2,
                    zorder=4,
                )
            )
    _label(axes, hidden, names)
    return [sheet]


def _cells(confusion):
    """Return {((group, hidden), name): campaigns}.

    Pairs share a row, since most occur once.
    """
    cells = {}
    for row in confusion:
        hidden, name = row["hidden"], row["first_name"]
        if "+" in name:
            name = RIGHT_PAIR if name == hidden else OTHER_PAIR
        shown = PAIR if "+" in hidden else hidden
        key = (row["group"], shown), name
        cells[key] = cells.get(key, 0) + row["campaigns"]
    return cells


def _columns(hidden, names):
    """Return the columns in the order of the rows, so that right answers lie on the diagonal.

    Names never hidden and verdicts follow.
    """
    order = [*dict.fromkeys(name for _, name in hidden if name in names)]
    last = [name for name in (RIGHT_PAIR, OTHER_PAIR, *VERDICTS) if name in names]
    return order + sorted(names - set(order) - set(last)) + last


def _right(group, hidden):
    """Return the column of the right answer to what is hidden."""
    return (
        RIGHT_PAIR
        if hidden == PAIR
        else {"nothing": "none", "stranger": "unknown"}.get(group, hidden)
    )


def _label(axes, hidden, names):
    """Name rows and columns, and part the groups of rows by a line."""
    axes.set_xticks(range(len(names)), [_words(name) for name in names], rotation=90)
    axes.set_yticks(range(len(hidden)), [_words(name) for _, name in hidden])
    axes.set_xticks(np.arange(len(names) + 1) - 0.5, minor=True)
    axes.set_yticks(np.arange(len(hidden) + 1) - 0.5, minor=True)
    axes.grid(which="minor", color="#E6E6E6", linewidth=0.6)
    axes.tick_params(which="minor", length=0)
    groups = [group for group, _ in hidden]
    for group in dict.fromkeys(groups):
        first, count = groups.index(group), groups.count(group)
        axes.text(
            len(names) - 0.3, first + 0.5 * (count - 1), group, va="center", fontsize=8, color=GREY
        )
        if first:
            axes.axhline(first - 0.5, color=GREY, linewidth=1.0)


def _words(name):
    return name.replace("_", " ").replace("+", " + ")
