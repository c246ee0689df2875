"""What the bars of the ranking are called."""

import pytest

from vibroimpact.figures.discrepancy.ranking import ranking_figure


def rows(*pairs):
    """Rows of a ranking of (ids, location), the first best."""
    return [
        {
            "ids": ids,
            "location": place,
            "fit_score": 20.0 - number,
            "closed_fraction": None,
            "probability": 0.5,
            "tested": True,
        }
        for number, (ids, place) in enumerate(pairs)
    ]


@pytest.mark.parametrize(
    ("pairs", "labels"),
    [
        ([("gap", "all"), ("dry_friction", "all")], ["gap", "dry friction"]),
        (
            [("lateral_stinger+lateral_stinger", "along_x"), ("lateral_stinger+gap", "all")],
            ["lateral stinger + lateral stinger (along x)", "lateral stinger + gap"],
        ),
        (
            [("foliate_obstacle", "all"), ("foliate_obstacle", "all, foliate lands")],
            ["lobed hole (all)", "lobed hole (all, foliate lands)"],
        ),
    ],
)
def test_bars_of_the_same_effect_are_labelled_by_place(pairs, labels):
    (sheet,) = ranking_figure(rows(*pairs))
    assert [text.get_text() for text in sheet.axes["main"].get_yticklabels()] == labels


def test_what_the_lowest_record_told_alone_has_no_bar():
    told = [row | {"fit_score": 0.0} for row in rows(("lateral_stinger", "along_y"))]
    told += [row | {"fit_score": None, "tested": False} for row in rows(("root_stiffness", ""))]
    (sheet,) = ranking_figure(told)
    (note,) = sheet.axes["main"].texts
    assert note.get_text() == "the lowest record alone tells the lateral stinger"
