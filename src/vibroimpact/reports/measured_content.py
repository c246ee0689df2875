"""The content of the page of a measured tube."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from .equivalent_answer import Answer, answers
from .number_text import digits
from .study_content import StudyContent, provenance
from .study_statistics import StudyStatistics
from .study_words import headline

# Column of the level: (word, unit, units per SI unit).
LEVELS = {"load_rms_N": ("Load", "N", 1.0), "response_rms_m": ("Response", "mm", 1e3)}


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
