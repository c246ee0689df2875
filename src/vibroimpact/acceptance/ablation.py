"""What each rule of the search is worth: campaigns in which it is known what is hidden, judged with
all rules and without each that acts in them. `python -m vibroimpact.acceptance.ablation --help`
"""

from __future__ import annotations

import json
from argparse import ArgumentParser
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

from vibroimpact.linear_stage import modal_lines
from vibroimpact.missing_effect import alike, decision, engine, race
from vibroimpact.records import write_table

from .campaign_rows import Row
from .judging import judged
from .sealed_run import run_sealed

SHOWN = (
    "hidden",
    "verdict",
    "named",
    "in_set",
    "one_right",
    "closed",
    "after_over_floor",
    "cpu_seconds",
)
ALL = ""  # in place of a rule's name: with all of them


@dataclass(frozen=True)
class Rule:
    """A function or a constant of a module; without: the value in its place where the rule is left
    out, of a function what it returns where there is nothing to do. A step returns nothing, and
    acts whenever it is called.
    """

    name: str
    module: ModuleType
    attribute: str
    without: Any = None
    step: bool = False

    @property
    def own(self) -> Any:
        """Return what stands in the module."""
        return getattr(self.module, self.attribute)

    @contextmanager
    def replaced(self, other: Any) -> Iterator[None]:
        """Put something else in its place in a `with` block."""
        own = self.own
        setattr(self.module, self.attribute, other)
        try:
            yield
        finally:
            setattr(self.module, self.attribute, own)

    @contextmanager
    def left_out(self) -> Iterator[None]:
        """Leave the rule out in a `with` block."""
        with self.replaced((lambda *_, **__: self.without) if callable(self.own) else self.without):
            yield

    @contextmanager
    def watched(self, acted: set[str]) -> Iterator[None]:
        """Add the name of the rule to `acted` where it does something in a `with` block."""
        own = self.own
        if not callable(own):
            acted.add(self.name)
            yield
            return

        def told(*given: Any, **named: Any) -> Any:
            result = own(*given, **named)
            if self.step or result != self.without:
                acted.add(self.name)
            return result

        with self.replaced(told):
            yield


RULES = (
    Rule("participations near the model's", modal_lines, "PARTICIPATION_SD", 1.0e9),
    Rule("a held-out record that disagrees is fitted", engine, "telling_record"),
    Rule("the end where nothing is near", engine, "nothing_near", False),
    Rule("a wider look", race, "look_wider", step=True),
    Rule("the likes of what leads", alike, "similar_too", False),
    Rule("other places", alike, "elsewhere_too", False),
    Rule("other effects at its place", alike, "at_its_place", False),
    Rule("other directions", alike, "turned_too", False),
    Rule("other laws of its family", alike, "laws_of", []),
    Rule("Gauss-Newton from what leads", engine, "descend", step=True),
    Rule("exchanged parts of pairs", engine, "exchanged_too", False),
    Rule("parts of a pair alone", engine, "parts_alone", step=True),
    Rule("the family alone", decision, "of_family"),
)


def rows_of(
    folder: str | Path, number: int, rules: Sequence[Rule], judge: Callable = run_sealed
) -> Iterator[Row]:
    """Yield the rows of one campaign: with all rules, then without each that acted.

    folder: of campaigns, as `python -m vibroimpact_truth make` makes it; judge(campaign, model,
    verdict): what writes a verdict of a campaign's file and its model's, paths.
    """
    name = f"campaign_{number:04d}"
    campaign, model = (Path(folder, name + end) for end in (".nc", ".yaml"))
    truth = json.loads(Path(folder, "truth", f"{name}.json").read_text(encoding="utf-8"))
    with TemporaryDirectory() as work:
        verdict = Path(work, "verdict.json")

        def row(without):
            judge(campaign, model, verdict)
            known = judged(json.loads(verdict.read_text(encoding="utf-8")), truth)
            return {"campaign": name, "without": without} | {key: known[key] for key in SHOWN}

        acted: set[str] = set()
        with ExitStack() as stack:
            for rule in rules:
                stack.enter_context(rule.watched(acted))
            everything = row(ALL)
        yield everything
        for rule in rules:
            if rule.name in acted:
                with rule.left_out():
                    without = row(rule.name)
                yield without


def main() -> None:
    """Write the table of campaigns, after each row what is known so far."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("folder", help="of campaigns: python -m vibroimpact_truth make")
    parser.add_argument("numbers", type=int, nargs="+", help="of its campaigns")
    parser.add_argument("--table", required=True, help="the CSV that is written")
    options = parser.parse_args()
    rows: list[Row] = []
    for number in options.numbers:
        for row in rows_of(options.folder, number, RULES):
            rows.append(row)
            write_table(rows, options.table)


if __name__ == "__main__":
    main()
