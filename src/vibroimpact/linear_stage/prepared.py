"""The results of the linear stage in plain values, which the search for the missing effect starts
from.
"""

from dataclasses import dataclass, field, replace
from typing import Any

from . import priors
from .candidates import Candidate, Pair, candidate_named


@dataclass
class Prepared:
    """The results of the linear stage, in plain values.

    checks: rows of the validator and of this stage.
    refusal: a sentence, None where the campaign can be tested.
    scales: {name: value}, see scales.scales.
    adopted: None, or {name, unit, gain, interval} of the linear effect, or two (the name of a
    Pair), that belong to the model from here on.
    linear: the same of every linear candidate, best first.
    screened: names of the candidates that only simulation can judge.
    in_place: names of those among them that may explain the lowest record instead of what is
    adopted.
    linear_stage: whether the lowest record identifies the linear structure.
    still_linear: whether it does with what is adopted in the model, which may then touch.
    nonlinear_low: whether the response is nonlinear in the lowest record.
    other_structure: whether the lowest record is that of another linear structure than the model,
    see lowest_record.is_of_another_structure.
    chi_square: of the lowest record. residual (channel,): over noise. delays: {channel: s}.
    fit: the ModalFit of the lowest record relative to the model with what is adopted.
    draw: see linear_analysis.prepare.
    fitted: names of the held-out records that are fitted too, see verification.telling_record.
    """

    checks: list[dict[str, Any]]
    refusal: str | None = None
    scales: dict[str, float] = field(default_factory=dict)
    adopted: dict[str, Any] | None = None
    linear: list[dict[str, Any]] = field(default_factory=list)
    screened: list[str] = field(default_factory=list)
    in_place: list[str] = field(default_factory=list)
    linear_stage: bool = False
    still_linear: bool = False
    nonlinear_low: bool = False
    other_structure: bool = False
    chi_square: float = 0.0
    residual: list[float] = field(default_factory=list)
    delays: dict[str, float] = field(default_factory=dict)
    not_testable: list[str] = field(default_factory=list)
    fit: dict[str, Any] | None = None
    draw: int = 0
    fitted: list[str] = field(default_factory=list)

    def room(self, candidate: Candidate | Pair) -> bool:
        """Return whether a Candidate or Pair may be missing in addition to what was adopted, or
        instead of it where it is alone: no more than priors.MOST_EFFECTS are named.
        """
        adopted = (
            []
            if self.adopted is None or candidate.alone
            else candidate_named(self.adopted["name"]).ids
        )
        return len(adopted) + len(candidate.ids) <= priors.MOST_EFFECTS

    def beside_or_in_place(self, candidate: Candidate) -> list[Candidate]:
        """Return the Candidates that one is simulated as: in addition to what was adopted where
        room allows it, and alone where it is in in_place.
        """
        return [candidate] * self.room(candidate) + [replace(candidate, alone=True)] * (
            candidate.name in self.in_place
        )
