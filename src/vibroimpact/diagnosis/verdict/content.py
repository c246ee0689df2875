"""verdict.json: which effects a model lacks, and the evidence for it; its one writer and reader.

`verdict.schema.json` in this folder is the JSON schema of `Verdict` for readers in other
languages; tests/diagnosis/test_verdict.py compares it.
"""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal, Self, get_args, get_origin

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    PrivateAttr,
    ValidationError,
    WithJsonSchema,
    model_serializer,
    model_validator,
)

from vibroimpact.effects.registry import effects_in_words
from vibroimpact.io.records import RecordError, plain_values, read_text, write_text

Conclusion = Literal["none", "named", "ambiguous", "partly_explained", "unknown", "not_testable"]
CONCLUSIONS: tuple[Conclusion, ...] = get_args(Conclusion)
WITH_EFFECTS: tuple[Conclusion, ...] = ("named", "partly_explained")
WITH_AMBIGUITY_SET: tuple[Conclusion, ...] = ("named", "ambiguous", "partly_explained")
NINETY_SD = 1.645  # sigma: half width of the 90 % interval of a normal law

# An integer stays one, so that a file that is read and written again keeps its bytes.
Number = Annotated[int | float, WithJsonSchema({"type": "number"})]
Probability = Annotated[
    int | float,
    Field(ge=0, le=1),
    WithJsonSchema({"type": "number", "minimum": 0, "maximum": 1}),
]


class _Content(BaseModel):
    """A part of the file. It is written with the keys it was made with, in the same order."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)
    _keys: tuple[str, ...] = PrivateAttr(())

    @model_validator(mode="wrap")
    @classmethod
    def _with_keys(cls, values: Any, validate: ModelWrapValidatorHandler[Self]) -> Self:
        content = validate(values)
        if isinstance(values, dict):
            content._keys = tuple(values)
        return content

    @model_serializer(mode="plain")
    def _values(self) -> dict[str, Any]:
        return {key: getattr(self, key) for key in self._keys}

    @classmethod
    def from_values(cls, values: dict[str, Any]) -> Self:
        """Return the content of nested dicts and lists; numpy values become plain ones, and numbers
        that are not finite None. Raises pydantic.ValidationError, a ValueError.
        """
        return cls.model_validate(plain_values(values))

    def to_values(self) -> dict[str, Any]:
        """Return nested dicts and lists, as the file holds them."""
        return self.model_dump(mode="json")


class Estimate(_Content):
    """A parameter of an effect, with its 90 % interval."""

    value: Number | None = Field(description="Best estimate.")
    unit: str = Field(description="Unit of the three numbers; 1 if there is none.")
    low: Number | None = Field(description="Lower end of the 90 % interval.")
    high: Number | None = Field(description="Upper end of the 90 % interval.")


class FoundEffect(_Content):
    """An effect that the model lacks."""

    id: str = Field(description="Id of the effect in the catalogue.")
    location: str = Field(description="Its place: a named place, or all supports.")
    parameters: dict[str, Estimate] = Field(description="Estimates by parameter name.")
    family: str | None = Field(
        default=None, description="Family of effects that it belongs to, whatever its law."
    )
    law_fits: Literal["yes", "no", "not tested"] | None = Field(
        default=None, description="Whether this law of the family explains the records."
    )


class RankedCandidate(_Content):
    """A set of effects that was tried, and how well it explains the records."""

    ids: list[str] = Field(description="Ids of the effects that were tried together.")
    heldout_score: Number | None = Field(
        description="Gain on held-out records; null if the candidate was screened only."
    )
    closed_fraction: Number | None = Field(description="Share of the excess misfit it closes.")
    location: str | None = Field(default=None, description="The places of the effects.")
    probability: Probability | None = Field(
        default=None, description="Probability that these effects are the missing ones."
    )


class Region(_Content):
    """A frequency band of one channel and record in which model and measurement differ."""

    band_Hz: Annotated[list[Number], Field(min_length=2, max_length=2)] = Field(
        description="Lower and upper end of the band, Hz."
    )
    load_rms_N: Number | None = Field(
        description="RMS of the first force channel, N; in load_unit on a moving base."
    )
    gap_m: Number | None = Field(description="Radial clearance, m; null if there is none.")
    channel: str = Field(description="Name of the response channel.")
    discrepancy_dB: Number | None = Field(
        description="10 log10 of measured over simulated power in the band."
    )
    z: Number | None = Field(description="The discrepancy over its standard deviation.")
    record: str | None = Field(default=None, description="Name of the record.")
    nearest_modes_Hz: list[Number] | None = Field(
        default=None, description="Frequencies of the model's modes in or next to the band, Hz."
    )


class Misfit(_Content):
    """Log-spectral distance of model and measurement, over the records of one split."""

    before_dB: Number | None = Field(description="Distance with the model as given, dB.")
    after_dB: Number | None = Field(description="Distance with the completed model, dB.")
    floor_dB: Number | None = Field(description="Distance that chance alone makes, dB.")
    closed_fraction: Number | None = Field(
        description="Share of the excess over the floor that the completed model closes."
    )


class MisfitBySplit(_Content):
    """Misfit of the fitted and of the held-out records; null if a split has none."""

    fit: Misfit | None
    holdout: Misfit | None


class StageCost(_Content):
    """The cost of the jobs of one stage."""

    cpu_seconds: Number = Field(description="CPU time, s.")
    simulations: int = Field(description="Number of simulated records.")


class Cost(_Content):
    """The cost of all jobs of a verdict, from the first check of the campaign to this file."""

    cpu_seconds: Number = Field(description="CPU time of all jobs, s.")
    simulations: int = Field(description="Number of records that all jobs simulated.")
    by_stage: dict[str, StageCost] = Field(description="The same, stage by stage.")


class Withdrawn(_Content):
    """Effects that were added and are not offered: they make records worse, or hardly better."""

    effects: list[FoundEffect] = Field(description="The added effects.")
    misfit: MisfitBySplit = Field(description="Misfit without and with them.")


class CheckResult(_Content):
    """The result of one check of the campaign."""

    check: str = Field(description="Name of the check.")
    level: Literal["pass", "warn", "refuse", "not checked"]
    record: str | None = Field(description="Name of the record it concerns.")
    channel: str | None = Field(description="Name of the channel it concerns.")
    message: str = Field(description="The result, and the remedy if there is one.")


class Verdict(_Content):
    """The verdict of a campaign on a model."""

    verdict: Conclusion = Field(description="The conclusion.")
    effects: list[FoundEffect] = Field(
        description="The effects that the model lacks; empty unless named or partly_explained."
    )
    ambiguity_set: list[list[str]] = Field(
        description="Sets of effect ids that explain the campaign equally well; filled if"
        " the verdict is named, ambiguous or partly_explained."
    )
    ranking: list[RankedCandidate] = Field(description="Candidates, best first.")
    next_measurement: str | None = Field(
        description="The measurement that would decide between the sets of the ambiguity set."
    )
    broken_invariances: list[str] = Field(
        description="Symmetries of the bare model that the measurement breaks."
    )
    regions: list[Region] = Field(description="The largest differences of model and measurement.")
    misfit: MisfitBySplit
    p_global_before: Number | None = Field(
        description="Probability of the observed differences by chance, with the model as given."
    )
    p_global_after: Number | None = Field(description="The same with the completed model.")
    checks: list[CheckResult] = Field(description="Checks of the campaign.")
    seconds: Number = Field(description="CPU time of all jobs, s.")
    simulations: int = Field(description="Number of records that all jobs simulated.")
    not_testable: list[str] = Field(
        default=[], description="Ids of effects that this campaign can not show."
    )
    not_run: list[str] = Field(
        default=[], description="Ids of effects that could not be run: nothing is known of them."
    )
    most_probable: list[FoundEffect] = Field(
        default=[], description="The effects of the best candidate, whatever the verdict."
    )
    provenance: dict[str, Any] = Field(
        default={},
        description="Version, digests of source, campaign and configuration, seed.",
    )
    cost: Cost | None = Field(default=None, description="CPU time and simulations by stage.")
    ambiguity_probability: list[Probability] = Field(
        default=[], description="Probability of each set of the ambiguity set, in its order."
    )
    probability_none: Probability | None = Field(
        default=None, description="Probability that nothing is missing."
    )
    probability_something_else: Probability | None = Field(
        default=None, description="Probability that a missing effect is not in the catalogue."
    )
    load_unit: Literal["N", "m/s²"] = Field(
        default="N", description="Unit of the loads: m/s² if the base moved, N of forces."
    )
    withdrawn: Withdrawn | None = Field(
        default=None,
        description="Effects that were tried and made records worse, or hardly better.",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.effects and self.verdict not in WITH_EFFECTS:
            raise ValueError(f"effects must be empty if the verdict is {self.verdict}")
        if bool(self.ambiguity_set) != (self.verdict in WITH_AMBIGUITY_SET):
            wanted = "filled" if self.verdict in WITH_AMBIGUITY_SET else "empty"
            raise ValueError(f"ambiguity_set must be {wanted} if the verdict is {self.verdict}")
        if len(self.ambiguity_probability) not in (0, len(self.ambiguity_set)):
            raise ValueError("ambiguity_probability must have one number per set of ambiguity_set")
        return self

    def shown_effects(self) -> list[FoundEffect]:
        """Return the effects of the completed model: the named ones, or the most probable ones
        if the verdict is ambiguous.
        """
        return self.effects or (self.most_probable if self.verdict == "ambiguous" else [])


def not_run_sentence(ids: Iterable[str]) -> str:
    """Return a sentence, after a space, on effects that could not be run; empty without any."""
    words = effects_in_words(ids)
    cause = "no trial of them could be integrated, try a larger integration.steps_per_second"
    return f" Nothing is known of {words}: {cause}." if words else ""


def not_testable(
    checks: list[dict[str, Any]],
    provenance: dict[str, Any],
    next_measurement: str,
    cost: dict[str, Any],
) -> Verdict:
    """Return the verdict on a campaign that can not be judged; checks: rows of CheckResult, cost:
    values of Cost.
    """
    required = {name: own for name, own in Verdict.model_fields.items() if own.is_required()}
    lists = {name for name, own in required.items() if get_origin(own.annotation) is list}
    unknown = dict.fromkeys(Misfit.model_fields)
    return Verdict.from_values(
        {name: [] if name in lists else None for name in required}
        | {
            "verdict": "not_testable",
            "next_measurement": next_measurement,
            "misfit": {"fit": unknown, "holdout": unknown},
            "checks": checks,
            "seconds": cost["cpu_seconds"],
            "simulations": cost["simulations"],
            "provenance": provenance,
            "cost": cost,
        }
    )


def write_verdict(verdict: Verdict, path: str | Path) -> None:
    """Write a verdict as JSON, whole or not at all.

    Raises pydantic.ValidationError if the content does not keep the schema.
    """
    values = Verdict.from_values(verdict.to_values()).to_values()
    write_text(json.dumps(values, indent=1, allow_nan=False), path)


def read_verdict(path: str | Path) -> Verdict:
    """Return the verdict of a file. Raises RecordError if there is none."""
    try:
        return Verdict.model_validate(json.loads(read_text(path)))
    except (json.JSONDecodeError, ValidationError) as error:
        raise RecordError(f"{path}: is no verdict: {error}") from error
