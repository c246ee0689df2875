"""What an import or a check found, as plain text."""

from __future__ import annotations

from pathlib import Path

from vibroimpact.campaign.checks.file_checks import COLUMNS, check_campaign
from vibroimpact.records import write_table, write_text

SHOWN = {
    "sensor": "sensor",
    "role": "role",
    "kind": "kind",
    "file": "file",
    "variable": "signal",
    "unit_read": "unit read",
    "unit_from": "which stands in",
    "unit_SI": "SI unit",
    "factor": "times",
    "rms_SI": "RMS (SI)",
    "peak_SI": "peak (SI)",
}
SIGNS = {"pass": "ok    ", "warn": "WARN  ", "refuse": "REFUSE"}


def write_report(folder, campaign, rows, paths):
    """Check the campaign of a folder and write paths.table, paths.checks (CSV) and paths.text."""
    checks = check_campaign(campaign)
    write_table(rows, paths.table)
    write_table(checks, paths.checks, COLUMNS)
    write_text(import_text(folder, campaign, rows, checks), paths.text)


def import_text(folder, campaign, rows, checks):
    """Return the report of an import: folder, rows of assemble.import_folder, checks of
    campaign_checks.
    """
    loads, gaps = campaign["load_rms"].values, campaign["gap"].values
    lines = [
        (
            f"Imported from {Path(folder).name}: {campaign.sizes['record']} records at"
            f" {campaign.attrs['sampling_frequency']:g} Hz."
        ),
        "",
        (
            "Values are stored as they were read; every comparison is made in SI units, after"
            " multiplication by the factor shown."
        ),
        "",
    ]
    for record, name in enumerate(str(value) for value in campaign["record_name"].values):
        own = [row for row in rows if row["record"] == name]
        gap = f"gap {gaps[record] * 1e3:.4g} mm" if gaps[record] == gaps[record] else "no gap"
        lines += [
            f"Record {name}: {own[0]['samples']} samples, {own[0]['duration_s']:.4g} s, load"
            f" {loads[record]:.4g} {own[0]['unit_SI']} RMS, {gap},"
            f" {campaign['split'].values[record]}"
        ]
        lines += [
            *_table(own),
            *(f"  {row['sensor']}: {row['note']}" for row in own if row["note"]),
            "",
        ]
    return "\n".join([*lines, checks_text(checks)])


def _table(rows):
    """Return the lines of a table of rows, columns aligned."""
    cells = [list(SHOWN.values())] + [
        [f"{row[key]:.4g}" if isinstance(row[key], float) else str(row[key]) for key in SHOWN]
        for row in rows
    ]
    widths = [max(len(line[column]) for line in cells) for column in range(len(SHOWN))]
    return [
        "  "
        + "  ".join(text.ljust(width) for text, width in zip(line, widths, strict=True)).rstrip()
        for line in cells
    ]


def checks_text(checks):
    """Return the rows of campaign_checks as lines, what refuses first."""
    order = {"refuse": 0, "warn": 1, "pass": 2}
    counts = {level: sum(row["level"] == level for row in checks) for level in order}
    verdict = (
        "can not be used"
        if counts["refuse"]
        else "can be used, with care"
        if counts["warn"]
        else "can be used"
    )
    lines = [
        (
            f"Checks: the campaign {verdict}; {counts['pass']} checks passed, {counts['warn']}"
            f" warnings, {counts['refuse']} refusals."
        ),
        "",
    ]
    ordered = sorted(checks, key=lambda row: order[row["level"]])
    return (
        "\n".join(
            lines + [f"{SIGNS[row['level']]} {row['check']}: {row['message']}" for row in ordered]
        )
        + "\n"
    )
