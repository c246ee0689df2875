"""The report of an import, and the checks of a campaign, as plain text."""

from pathlib import Path

import xarray as xr

from vibroimpact.campaign.file import with_no_force

SHOWN = {
    "sensor": "sensor",
    "role": "role",
    "kind": "kind",
    "file": "file",
    "variable": "signal",
    "unit_read": "unit read",
    "unit_from": "unit stated in",
    "unit_SI": "SI unit",
    "factor": "factor to SI",
    "rms_SI": "RMS (SI)",
    "peak_SI": "peak (SI)",
}
SIGNS = {"pass": "ok    ", "warn": "WARN  ", "refuse": "REFUSE", "not checked": "-     "}


def import_text(
    folder: str | Path, campaign: xr.Dataset, rows: list[dict], checks: list[dict]
) -> str:
    """Return the report of an import.

    folder: of the measurements.
    campaign: Dataset.
    rows: of assemble.import_folder.
    checks: rows of check_campaign.
    """
    campaign = with_no_force(campaign)
    loads, gaps = campaign["load_rms"].values, campaign["gap"].values
    lines = [
        f"Imported from {Path(folder).name}: {campaign.sizes['record']} records at"
        f" {campaign.attrs['sampling_frequency']:g} Hz.",
        "",
        "Values are stored as they were read. Every comparison is made in SI units, after"
        " multiplication by the factor shown.",
        "",
    ]
    for record, name in enumerate(str(value) for value in campaign["record_name"].values):
        sensors = [row for row in rows if row["record"] == name]
        load = f"load {loads[record]:.4g} {sensors[0]['unit_SI']} RMS"
        if not campaign.sizes["force_channel"]:
            load = "no force"
        gap = f"gap {gaps[record] * 1e3:.4g} mm" if gaps[record] == gaps[record] else "no gap"
        lines += [
            f"Record {name}: {sensors[0]['samples']} samples, {sensors[0]['duration_s']:.4g} s,"
            f" {load}, {gap}, {campaign['split'].values[record]}",
            *_table(sensors),
            *(f"  {row['sensor']}: {row['note']}" for row in sensors if row["note"]),
            "",
        ]
    return "\n".join([*lines, checks_text(checks)])


def _table(rows: list[dict]) -> list[str]:
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


def checks_text(checks: list[dict]) -> str:
    """Return the rows of check_campaign as lines, refusals first, then warnings."""
    order = {"refuse": 0, "warn": 1, "not checked": 2, "pass": 3}
    counts = {level: sum(row["level"] == level for row in checks) for level in order}
    usability = "can be used, with care" if counts["warn"] else "can be used"
    if counts["refuse"]:
        usability = "gives no verdict"
    lines = [
        f"Checks: the campaign {usability}; {counts['pass']} checks passed, {counts['warn']}"
        f" warnings, {counts['refuse']} refusals, {counts['not checked']} not checked.",
        "",
    ]
    said: dict[tuple[str, str], list[str]] = {}  # one reason often stands for several checks
    for row in sorted(checks, key=lambda row: order[row["level"]]):
        said.setdefault((row["level"], row["message"]), []).append(row["check"])
    for (level, message), names in said.items():
        lines.append(f"{SIGNS[level]} {', '.join(names)}: {message}")
    return "\n".join(lines) + "\n"
