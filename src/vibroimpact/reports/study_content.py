"""The content of the page of a study, and of a measured tube."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import yaml

import vibroimpact
from vibroimpact.study.wear.life import WearRow

from .equivalent_answer import ALL_SUPPORTS, Answer, answers
from .number_text import digits
from .study_statistics import StudyStatistics
from .study_words import (
    contact_sentences,
    energy_sentences,
    has_own_gaps,
    headline,
    load_unit,
    run_sentence,
)
from .table import Table
from .wear_life import wear_sentences

# Column of the level: (word, unit, units per SI unit).
LEVELS = {"load_rms_N": ("Load", "N", 1.0), "response_rms_m": ("Response", "mm", 1e3)}


def provenance(
    configuration: Mapping[str, Any],
    stages: Mapping[str, Mapping[str, Any]],
    timing: Sequence[dict] = (),
) -> dict[str, Any]:
    """Return the origin of the numbers: the configuration as it ran, as YAML, the version of the
    library, those that the first stage was run with, the Table of when each stage wrote its results
    with the digests of its keys and source, and the timing.

    configuration: the checked configuration in plain values.
    stages: {stage: global attributes of one of its files}.
    timing: rows of study.timing; empty if the jobs left no benchmark files.
    """
    text = yaml.safe_dump(dict(configuration), sort_keys=False, allow_unicode=True, width=96)
    columns = ("results of", "written (UTC)", "digest of configuration", "digest of source")
    rows = [
        (
            stage,
            str(values.get("history", "-")).split(" written")[0].replace("T", " "),
            str(values.get("config_digest", "-")),
            str(values.get("source_digest", "-")),
        )
        for stage, values in stages.items()
    ]
    versions = next((str(row["versions"]) for row in stages.values() if "versions" in row), "")
    return {
        "configuration": text,
        "version": vibroimpact.__version__,
        "versions": versions,
        "stages": Table(columns, rows),
        "timing": timing,
    }


@dataclass(frozen=True, kw_only=True)
class StudyContent:
    """The content of the page of a study, or of a measured tube in its place.

    config: of the study or of the model. name: of the study or the campaign. kind: in words.
    run: sentences on what was run. found: the answer, contact, wear and stress in sentences.
    answers: empty for a study without identification.
    limits: {residual: largest accepted value}.
    unit: of the loads as they are shown. load_words: of their control and of their axis.
    load_factor: shown loads per SI unit. scatter: what the intervals are over.
    warnings: sentences on causes that make numbers wrong or doubtful.
    worn: WearRows of a study with a wear life.
    """

    config: Any
    name: str
    kind: str = "study"
    run: str
    found: Sequence[str]
    answers: Sequence[Answer]
    statistics: StudyStatistics
    limits: Mapping[str, float]
    provenance: Mapping[str, Any]
    unit: str
    load_words: tuple[str, str] = ("Load", "Load")
    load_factor: float = 1.0
    scatter: str = "seeds"
    warnings: Sequence[str] = ()
    worn: Sequence[WearRow] = ()

    @property
    def load_label(self) -> str:
        """The label of an axis of loads."""
        return f"{self.load_words[1]} ({self.unit} RMS)"

    @property
    def several(self) -> bool:
        """Whether k and c belong to more than one group of supports or direction."""
        places = {(row.group, row.direction) for row in self.answers}
        return len(places) > 1 or any(group != ALL_SUPPORTS for group, _ in places)

    def at_gap(self, gap_m: float) -> str:
        """Return " at a gap of ... mm", empty if the gap of a case means nothing."""
        return "" if has_own_gaps(self.config) else f" at a gap of {digits(1e3 * gap_m)} mm"


def study_content(
    config: Any,
    answers: Sequence[Answer],
    statistics: StudyStatistics,
    provenance: Mapping[str, Any],
    unmoved: Sequence[tuple[str, str]] = (),
    worn: Sequence[WearRow] = (),
    **more: Any,
) -> StudyContent:
    """Return the StudyContent of a study.

    unmoved: (group of supports, direction) that the force does not move. more: limits, warnings.
    """
    unit = load_unit(config)
    places = ", ".join(f"{group} in {direction}" for group, direction in unmoved)
    still = f"No answer along directions in which the force moves no support: {places}."
    return StudyContent(
        config=config,
        name=str(config.study),
        run=run_sentence(config, statistics),
        found=[
            *energy_sentences(config, statistics),
            *headline(config, answers, unit),
            *([still] if unmoved else []),
            *contact_sentences(config, statistics),
            *wear_sentences(worn, config, unit),
        ],
        answers=answers,
        statistics=statistics,
        provenance=provenance,
        unit=unit,
        worn=worn,
        **more,
    )


def measured_content(
    found: Any, campaign: str, configuration: Mapping[str, Any], warnings: Sequence[str] = ()
) -> StudyContent:
    """Return the StudyContent of a measured_support.MeasuredSupports.

    campaign: name. configuration: the model, in plain values.
    """
    word, unit, factor = LEVELS[found.levels]
    rows: list[Answer] = [
        replace(row, load_rms_N=factor * row.load_rms_N)
        for row in answers(found.summary, found.equivalent)
    ]
    own, records = sorted({row.load_rms_N for row in rows}), len(found.records)
    gaps = ", ".join(digits(1e3 * gap) for gap in sorted({row.gap_m for row in rows}))
    run = (
        f"{records} measured record{'s' * (records != 1)} at {len(own)}"
        f" level{'s' * (len(own) != 1)}"
        f" ({digits(own[0])} to {digits(own[-1])} {unit} RMS), gap {gaps} mm, compared with the"
        f" linear tube of the model {found.config.study}. No contact was simulated."
    )
    return StudyContent(
        config=found.config,
        name=campaign,
        kind="measured supports",
        run=run,
        found=[*headline(found.config, rows, unit), *found.notes],
        answers=rows,
        statistics=StudyStatistics([*found.spectra], []),
        limits={},
        provenance=provenance(configuration, {}),
        unit=unit,
        load_words=("Level", word),
        load_factor=factor,
        scatter="records",
        warnings=warnings,
    )
