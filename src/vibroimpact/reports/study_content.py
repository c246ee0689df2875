"""The content of the page of a study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import yaml

import vibroimpact
from vibroimpact.study.wear.life import WearRow

from .equivalent_answer import ALL_SUPPORTS, Answer
from .evenly_spread import spread_evenly
from .number_text import digits
from .study_statistics import StudyStatistics
from .study_tables import (
    answer_table,
    energy_table,
    place_table,
    reason_table,
    stress_table,
    timing_table,
)
from .study_words import (
    contact_sentences,
    energy_sentences,
    has_own_gaps,
    headline,
    load_unit,
    run_sentence,
)
from .table import Table
from .wear_life import wear_sentences, wear_table

MOST_LOADS = 8  # of a table of statistics, per gap


@dataclass(frozen=True)
class Provenance:
    """The origin of the numbers.

    configuration: the configuration as it ran, as YAML.
    version: of the library.
    stages: {stage: attributes of a file that it wrote}.
    timing: rows of study.timing; empty if the jobs left no benchmark files.
    """

    configuration: str
    version: str
    stages: dict[str, dict[str, str]]
    timing: Sequence[dict] = ()

    def stage_table(self) -> Table:
        """Return when each stage wrote its results, and the digests of its keys and source."""
        rows = [
            (
                stage,
                values.get("history", "-").split(" written")[0].replace("T", " "),
                values.get("config_digest", "-"),
                values.get("source_digest", "-"),
            )
            for stage, values in self.stages.items()
        ]
        columns = ("results of", "written (UTC)", "digest of configuration", "digest of source")
        return Table(columns, rows)

    @property
    def versions(self) -> str:
        """The versions that the first stage was run with."""
        return next((row["versions"] for row in self.stages.values() if "versions" in row), "")


def provenance(
    configuration: Mapping[str, Any],
    stages: Mapping[str, Mapping[str, Any]],
    timing: Sequence[dict] = (),
) -> Provenance:
    """Return the Provenance of a study.

    configuration: the checked configuration in plain values.
    stages: {stage: global attributes of one of its files}.
    """
    text = yaml.safe_dump(dict(configuration), sort_keys=False, allow_unicode=True, width=96)
    kept = ("history", "config_digest", "source_digest", "versions")
    return Provenance(
        text,
        vibroimpact.__version__,
        {
            stage: {key: str(values[key]) for key in kept if key in values}
            for stage, values in stages.items()
        },
        timing,
    )


@dataclass(frozen=True)
class StudyContent:
    """The content of the page of a study.

    config: its configuration.
    answers: empty for a study without identification.
    limits: {residual: largest accepted value}.
    unmoved: (group of supports, direction) that the force does not move.
    warnings: sentences on causes that make numbers wrong or doubtful.
    worn: WearRows of a study with a wear life.
    """

    config: Any
    answers: Sequence[Answer]
    statistics: StudyStatistics
    limits: Mapping[str, float]
    provenance: Provenance
    unmoved: Sequence[tuple[str, str]] = ()
    warnings: Sequence[str] = ()
    worn: Sequence[WearRow] = ()

    kind = "study"
    scatter = "seeds"

    @property
    def name(self) -> str:
        """The name of the study."""
        return str(self.config.study)

    @property
    def unit(self) -> str:
        """The unit of the loads."""
        return load_unit(self.config)

    @property
    def several(self) -> bool:
        """Whether k and c belong to more than one group of supports or direction."""
        places = {(row.group, row.direction) for row in self.answers}
        return len(places) > 1 or any(group != ALL_SUPPORTS for group, _ in places)

    def run(self) -> str:
        """Return the sentences on the run."""
        return run_sentence(self.config, self.statistics)

    def headline(self) -> list[str]:
        """Return the answer in sentences."""
        sentences = headline(self.config, self.answers)
        if self.unmoved:
            places = ", ".join(f"{group} in {direction}" for group, direction in self.unmoved)
            sentences.append(
                f"No answer along directions in which the force moves no support: {places}."
            )
        return [*energy_sentences(self.config, self.statistics), *sentences]

    def contact(self) -> list[str]:
        """Return contact, wear and stress in sentences."""
        return [
            *contact_sentences(self.config, self.statistics),
            *wear_sentences(self.worn, self.config, self.unit),
        ]

    def at_gap(self, gap_m: float) -> str:
        """Return " at a gap of ... mm", empty if the gap of a case means nothing."""
        return "" if has_own_gaps(self.config) else f" at a gap of {digits(1e3 * gap_m)} mm"

    def loads_in_tables(self) -> list[float]:
        """Return the loads that tables of statistics list."""
        return spread_evenly(self.statistics.loads, MOST_LOADS)

    def answer_tables(self) -> list[tuple[float, Table]]:
        """Return (gap in m, table of the recommended values) of each gap."""
        rows: dict[float, list[Answer]] = {}
        for row in self.answers:
            rows.setdefault(row.gap_m, []).append(row)
        return [(gap, answer_table(own, self.several, self.unit)) for gap, own in rows.items()]

    def reasons(self) -> Table:
        """Return why values are not resolved, or differ."""
        return reason_table(self.answers, self.statistics, self.several, self.unit)

    def place_tables(self, kind: str) -> list[tuple[float, Table]]:
        """Return (gap in m, table by load and support or local element) of each gap.

        kind: support, with contact and wear; element, with power and work.
        """
        places = {"support": self.statistics.supports, "element": self.statistics.elements}
        loads = self.loads_in_tables()
        return [
            (gap, place_table(self.statistics, kind, gap, loads, self.unit))
            for gap in (self.statistics.gaps if places[kind] else [])
        ]

    def wear_tables(self) -> list[tuple[float, Table]]:
        """Return (gap in m, wear life by load, support and land) of each gap."""
        loads = self.loads_in_tables() if self.worn else []
        return [
            (gap, wear_table(self.worn, gap, loads, self.unit))
            for gap in dict.fromkeys(row.gap_m for row in self.worn)
        ]

    def stress(self) -> Table:
        """Return the stress by gap and load."""
        return stress_table(self.statistics, self.loads_in_tables(), self.unit)

    def energy(self) -> Table:
        """Return the worst energy residuals."""
        return energy_table(self.statistics, self.limits, self.unit)

    def timing(self) -> Table:
        """Return the time of the jobs by rule."""
        return timing_table(self.provenance.timing)
