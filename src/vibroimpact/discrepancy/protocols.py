"""The attributes that this package needs of classes in the packages above it.

linear_stage and missing_effect import this package, so it can not import their classes.
"""

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
import xarray as xr

from vibroimpact.effects.effect import Values
from vibroimpact.observation.features import FeatureLayout
from vibroimpact.observation.signals import Signals
from vibroimpact.reduction.modal_model import ModalModel


class ComparisonLike(Protocol):
    """A campaign and a model to compare with it, as in linear_stage.workbench.Workbench."""

    @property
    def campaign(self) -> xr.Dataset:
        """The campaign."""

    @property
    def signals(self) -> Signals:
        """The signals of the campaign in SI."""

    @property
    def layout(self) -> FeatureLayout:
        """Which features a record has."""

    @property
    def measured_features(self) -> np.ndarray:
        """(record, feature) of the measurement."""

    @property
    def bare(self) -> ModalModel:
        """The model with the channels of the campaign, without corrections."""


class NuisanceLike(Protocol):
    """Corrections of modes and channels, as in linear_stage.nuisance.Nuisance."""

    @property
    def modes(self) -> np.ndarray:
        """(mode,) indices of the corrected modes."""

    @property
    def frequency(self) -> np.ndarray:
        """(mode,) factors of frequency."""

    @property
    def damping(self) -> np.ndarray:
        """(mode,) factors of damping."""

    @property
    def gain(self) -> np.ndarray:
        """(channel,) measured over true."""


class WorkbenchLike(ComparisonLike, Protocol):
    """A comparison with a configuration and its corrections, as in linear_stage.workbench."""

    @property
    def values(self) -> Values:
        """The configuration in plain values."""

    @property
    def nuisance(self) -> NuisanceLike | None:
        """The corrections, None for none."""

    def variant(self, candidate: Any, physical: Any, /) -> Values:
        """Return the configuration with a linear_stage Candidate or Pair, of parameters in SI."""


class CandidateLike(Protocol):
    """An effect at a place, or two, as in linear_stage.candidates."""

    def physical(
        self, unit: np.ndarray, scales: dict[str, float], /
    ) -> dict[str, float] | list[dict[str, float]]:
        """Return {name: value in SI} of normalised parameters unit (parameter,); a list of two."""


class PreparedLike(Protocol):
    """Results of the linear stage, as in linear_stage.linear_analysis.Prepared."""

    @property
    def checks(self) -> Sequence[dict[str, Any]]:
        """Rows of checks."""

    @property
    def scales(self) -> dict[str, float]:
        """Sizes by name."""

    @property
    def adopted(self) -> dict[str, Any] | None:
        """The linear effect that was added to the model, None for none."""

    @property
    def nonlinear_low(self) -> bool:
        """Whether the record of the lowest load is not that of a linear structure."""


class NullLike(Protocol):
    """The features of records where no effect is missing, as in missing_effect.null.Null."""

    @property
    def records(self) -> np.ndarray:
        """(record,) indices of the records compared."""

    @property
    def mean(self) -> np.ndarray:
        """(record, feature)."""

    @property
    def covariance(self) -> np.ndarray:
        """(record, feature, feature)."""

    @property
    def seed_variance(self) -> np.ndarray:
        """(record, feature), of one run."""

    @property
    def seeds(self) -> int:
        """Number of runs of every record."""


class ChosenLike(Protocol):
    """The explanation that completes the model, as in missing_effect.decision.Chosen."""

    @property
    def candidate(self) -> CandidateLike:
        """The effect at its place."""

    @property
    def unit(self) -> np.ndarray:
        """(parameter,) from 0 to 1."""


class DecisionLike(Protocol):
    """The conclusion of the search, as in missing_effect.decision.Decision."""

    @property
    def verdict(self) -> str:
        """One of verdict.content.CONCLUSIONS."""

    @property
    def chosen(self) -> ChosenLike | None:
        """The explanation that completes the model, None for none."""
