"""The validation as one HTML page next to its figures: checks, tables, figures."""

from collections import Counter
from html import escape
from pathlib import Path

from vibroimpact.reports.page_style import STYLE


def validation_page(
    checks: list[dict], tables: list[tuple[str, str, list[dict]]], figures: list[Path], folder: Path
) -> str:
    """Return the HTML page.

    checks: rows of validation.csv.
    tables: (heading, sentence, rows) in their order.
    figures: PNG files, each with its caption in a .txt file of the same name.
    folder: of the page; links are relative to it.
    """
    failed = [row for row in checks if row["pass"] not in (True, "True")]
    parts = [
        (
            f"<h1>Validation</h1><p>{len(checks)} comparisons with closed forms, exact laws,"
            f" published numbers and other codes; {_verdict(len(failed))}.</p>"
        ),
        _summary(checks),
    ]
    if failed:
        parts += ["<h2>What failed</h2>", _table(failed)]
    for heading, sentence, rows in tables:
        parts += [f"<h2>{escape(heading)}</h2><p>{escape(sentence)}</p>", _table(rows)]
    parts.append("<h2>Figures</h2>")
    for figure in figures:
        caption = figure.with_suffix(".txt").read_text(encoding="utf-8")
        parts.append(
            f'<figure><img src="{escape(figure.relative_to(folder).as_posix())}"'
            f' alt="{escape(figure.stem)}"><figcaption>{escape(caption)}</figcaption></figure>'
        )
    parts.append("<h2>Every comparison</h2>")
    for case in dict.fromkeys(row["case"] for row in checks):
        rows = [row for row in checks if row["case"] == case]
        parts.append(
            f"<details><summary>{escape(str(case))}: {len(rows)}</summary>{_table(rows)}</details>"
        )
    body = "\n".join(parts)
    return (
        '<!doctype html>\n<html lang="en"><meta charset="utf-8"><title>Validation</title>'
        f"<style>{STYLE}</style>\n<body>\n{body}\n</body></html>\n"
    )


def page_tables(claims: list[dict], prediction: list[dict]) -> list[tuple[str, str, list[dict]]]:
    """Return the tables of the page: the claims, and the use of the equivalent linear model."""
    counts = Counter(row["verdict"] for row in claims)
    verdicts = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    return [
        (
            "The paper's claims",
            (
                f"Measured on the default study: {verdicts}. Values agree where they are within"
                " 25 % of their median."
            ),
            claims,
        ),
        (
            "When may the equivalent linear model be used?",
            (
                "Linear over non-linear response for loads, gaps and a tube that were not fitted."
                " yes: every case within 2 dB (26 %); with care: the median; no: else."
            ),
            prediction,
        ),
    ]


def _verdict(failed):
    return (
        '<span class="good">all within their tolerance</span>'
        if failed == 0
        else f'<span class="bad">{failed} beyond their tolerance</span>'
    )


def _summary(checks):
    total = Counter(row["case"] for row in checks)
    passed = Counter(row["case"] for row in checks if row["pass"] in (True, "True"))
    rows = [
        {
            "case": case,
            "comparisons": count,
            "within tolerance": passed[case],
            "largest error / tolerance": max(_share(row) for row in checks if row["case"] == case),
        }
        for case, count in total.items()
    ]
    return _table(rows)


def _share(row):
    tolerance = float(row["tolerance"])
    return float(row["error"]) / tolerance if tolerance > 0.0 else float("nan")


def _table(rows):
    if not rows:
        return "<p>(empty)</p>"
    head = "".join(f"<th>{escape(str(name)).replace('_', ' ')}</th>" for name in rows[0])
    body = "".join(
        "<tr>" + "".join(_cell(value) for value in row.values()) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead>{body}</table>"


def _cell(value):
    if str(value) in ("True", "False"):  # by its text: 1 is a number, and equals True
        return '<td class="good">yes</td>' if str(value) == "True" else '<td class="bad">no</td>'
    if isinstance(value, (int, float)):
        return f'<td class="number">{value:.5g}</td>'
    return f"<td>{escape(str(value))}</td>"
