"""What a run says at its end: the headline of a study, or what failed and what to do about it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from vibroimpact.io.records import read_table
from vibroimpact.io.whole_file import problem_of
from vibroimpact.study.headline import flag_sentences, headline

# A failed job in the log that Snakemake writes.
FAILED = re.compile(r"^Error in rule (?P<rule>[^\s:]+).*:\n(?P<about>(?:    .*\n)*)", flags=re.M)
STARTED = re.compile(r"^Job (?P<job>\d+): (?P<message>.*)$", flags=re.M)
FINISHED = re.compile(r"^Finished jobid: (\d+)", flags=re.M)
# A warning as Python prints it: file, line, kind and text.
WARNED = re.compile(r"^\S.*:\d+: (?P<warning>\w*Warning: .*)$", flags=re.M)
NO_WORD = (
    "see the lines above. A job that is stopped from outside, as for lack of memory, leaves no"
    " word: run fewer jobs at a time (-j1)"
)
LAST_LINES, MOST_WARNINGS = 6, 5
STATISTICS = "statistics.csv"
MENTIONED = ("index.html", "equivalent.csv", "consistency.csv", STATISTICS)


def success_text(folder: str | Path, rows: Sequence[dict]) -> str:
    """Return what a complete study says: its headline, and where its page and tables are.

    rows: of equivalent.csv, empty for a study without identification.
    """
    folder = Path(folder)
    files = [folder / name for name in MENTIONED if (folder / name).is_file()]
    figures = [folder / "figures"] if (folder / "figures").is_dir() else []
    lines = [f"Study '{folder.name}': {headline(rows)}."] if rows else []
    lines += flag_sentences(rows)
    if not rows and (folder / STATISTICS).is_file():
        lines += flag_sentences(read_table(folder / STATISTICS), STATISTICS)
    return "\n".join([*lines, *(f"  {path.as_posix()}" for path in [*files, *figures])])


def failure_text(log: str) -> str:
    """Return what a failed run says: each failed job, the end of its log, and what to do next.

    log: text of the log that Snakemake wrote of the run.
    """
    messages = {match["job"]: match["message"] for match in STARTED.finditer(log)}
    jobs = [_failed_job(match, messages) for match in FAILED.finditer(log)]
    recovered = set(FINISHED.findall(log))  # in a later attempt
    failed = {(job["rule"], job["log"]): job for job in jobs if job["job"] not in recovered}
    if not failed:
        return ""
    count = f"{len(failed)} jobs" if len(failed) > 1 else "1 job"
    lines = [f"{count} failed:", *(line for job in failed.values() for line in _about(job))]
    return "\n".join(
        [
            *lines,
            "Mend what the last line says and give the same command again: complete files are kept"
            " and only what is missing runs.",
        ]
    )


def warnings_text(logs: Iterable[str | Path]) -> str:
    """Return which logs hold warnings, as of a division by zero, and the first of each; "" for
    none.
    """
    found = {}
    for path in logs:
        if Path(path).is_file():
            text = Path(path).read_text(encoding="utf-8", errors="replace")
            found[path] = WARNED.findall(text)
    warned = {path: warnings for path, warnings in found.items() if warnings}
    if not warned:
        return ""
    lines = [f"  {path}: {warnings[0]}" for path, warnings in warned.items()]
    more = len(lines) - MOST_WARNINGS
    return "\n".join(
        [
            f"{len(lines)} {'jobs' if len(lines) > 1 else 'job'} warned; look at the numbers in"
            " question before you use them:",
            *lines[:MOST_WARNINGS],
            *([f"  and {more} more"] if more > 0 else []),
        ]
    )


def _failed_job(match: re.Match, messages: dict[str, str]) -> dict[str, str]:
    """Return {job, rule, message, log} of a failed job; messages: of the started jobs by number."""
    about = dict(re.findall(r"^    (\w+): (.*)$", match["about"], flags=re.M))
    log = about.get("log", "").removesuffix(" (check log file(s) for error details)")
    number = about.get("jobid", "")
    return {
        "job": number,
        "rule": match["rule"],
        "message": messages.get(number, ""),
        "log": log.split(", ")[0],
    }


def _about(job: dict[str, str]) -> list[str]:
    """Return the lines on one failed job."""
    rule = job["rule"].removeprefix("_")
    lines = [f"  {job['message']} (rule {rule})" if job["message"] else f"  rule {rule}"]
    if not job["log"]:
        return lines
    path = Path(job["log"])
    text = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""
    last = [line for line in text.splitlines() if line.strip()][-LAST_LINES:]
    if not last:
        return [
            *lines,
            f"    {job['log']} is empty: {problem_of(path.parent) or NO_WORD}",
        ]
    return [*lines, f"    {job['log']} ends with", *(f"      {line}" for line in last)]
