"""The content of the page of a measured tube."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from .equivalent_answer import Answer, answers, unmoved
from .number_text import digits
from .study_content import StudyContent, provenance
from .study_statistics import StudyStatistics
from .study_words import headline
from .table import Table

# Column of the level: (word, unit, units per SI unit).
LEVELS = {"load_rms_N": ("Load", "N", 1.0), "response_rms_m": ("Response", "mm", 1e3)}


@dataclass(frozen=True)
class MeasuredContent(StudyContent):
    """The content of the page of a measured tube, in the place of a study.

    campaign: its name. records: how many were read. level: of LEVELS. notes: sentences on the
    assumptions.
    """

    campaign: str = ""
    records: int = 0
    level: str = "load_rms_N"
    notes: Sequence[str] = ()

    kind = "measured supports"
    scatter = "records"

    @property
    def name(self) -> str:
        """The name of the campaign."""
        return self.campaign

    @property
    def unit(self) -> str:
        """The unit of the levels."""
        return LEVELS[self.level][1]

    @property
    def level_label(self) -> str:
        """The label of an axis of levels."""
        return f"{LEVELS[self.level][0]} ({self.unit} RMS)"

    def run(self) -> str:
        """Return the sentences on measurement and comparison."""
        own = sorted({row.load_rms_N for row in self.answers})
        gaps = ", ".join(digits(1e3 * gap) for gap in sorted({row.gap_m for row in self.answers}))
        return (
            f"{self.records} measured record{'s' * (self.records != 1)} at {len(own)}"
            f" level{'s' * (len(own) != 1)} ({digits(own[0])} to {digits(own[-1])} {self.unit}"
            f" RMS), gap {gaps} mm, compared with the linear tube of the model {self.config.study}."
            " No contact was simulated."
        )

    def headline(self) -> list[str]:
        """Return the answer in sentences."""
        return [*headline(self.config, self.answers, self.unit), *self.notes]

    def contact(self) -> list[str]:
        """Return nothing: contacts were not measured."""
        return []

    def reasons(self) -> Table:
        """Return why values are not resolved, or differ."""
        whole = super().reasons()  # its last column is the time in contact
        return Table(whole.columns[:-1], [row[:-1] for row in whole.rows])


def measured_content(
    found: Any, campaign: str, configuration: Mapping[str, Any], warnings: Sequence[str] = ()
) -> MeasuredContent:
    """Return the MeasuredContent of a measured_support.MeasuredSupports.

    campaign: name. configuration: the model, in plain values.
    """
    factor = LEVELS[found.levels][2]
    direction = found.rows[0]["direction"]
    values: list[Answer] = answers(found.summary, found.equivalent, direction)
    return MeasuredContent(
        config=found.config,
        answers=[replace(row, load_rms_N=factor * row.load_rms_N) for row in values],
        statistics=StudyStatistics([], []),
        limits={},
        provenance=provenance(configuration, {}),
        unmoved=unmoved(found.equivalent),
        warnings=warnings,
        campaign=campaign,
        records=len(found.records),
        level=found.levels,
        notes=found.notes,
    )
