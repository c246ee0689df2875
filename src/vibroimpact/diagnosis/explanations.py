"""Explanations: effects at places with values, the nuisances of a measured structure, and the model
that both make.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
import xarray as xr

from vibroimpact.config.reading import check_config
from vibroimpact.config.schema import Config
from vibroimpact.effects.effect import Parameter, Values
from vibroimpact.effects.places import with_place
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.observation.attached_model import attach, attached_basis
from vibroimpact.observation.strain import as_displacements
from vibroimpact.reduction.modal_model import ModalModel


@dataclass(frozen=True)
class Term:
    """An effect of the catalogue at a place; values: of its parameters, SI, in their order."""

    effect: str
    location: str
    values: tuple[float, ...]

    @property
    def name(self) -> str:
        """Return effect@location."""
        return f"{self.effect}@{self.location}"

    @property
    def parameters(self) -> dict[str, float]:
        """Return {name: value in SI}."""
        names = (parameter.name for parameter in EFFECTS[self.effect].parameters)
        return dict(zip(names, self.values, strict=True))


@dataclass(frozen=True)
class Point:
    """A point of the space that is searched: terms, and the nuisances as logarithms of factors.

    frequency, damping (mode,): of the modes from the lowest on. gain (channel,): of the sensors.
    """

    terms: tuple[Term, ...] = ()
    frequency: tuple[float, ...] = ()
    damping: tuple[float, ...] = ()
    gain: tuple[float, ...] = ()

    @property
    def name(self) -> str:
        """Return the names of the terms, joined."""
        return " + ".join(term.name for term in self.terms) or "nothing"


@dataclass(frozen=True)
class Measuring:
    """What the measuring chain makes of the motion: gain, delay in s (channel,), force gain."""

    gain: np.ndarray
    delay: np.ndarray
    force_gain: float = 1.0


@dataclass(frozen=True, eq=False)
class Structure:
    """The model as given, attached to a campaign: what makes the models of Points."""

    config: Config
    campaign: xr.Dataset
    scale: np.ndarray = field(init=False)  # of strain channels, as displacements
    models: Callable = field(init=False)
    basis: np.ndarray | None = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "basis", attached_basis(self.config, self.campaign))
        object.__setattr__(self, "models", lru_cache(maxsize=256)(self._model_of))
        raw = self.models(())
        own = attach(self.config, self.campaign)
        size = np.abs(own.sensor_shapes).max(axis=0)
        scaled = np.abs(raw.sensor_shapes).max(axis=0)
        object.__setattr__(
            self, "scale", np.where(size > 0, scaled / np.where(size > 0, size, 1), 1.0)
        )

    @property
    def values(self) -> Values:
        """Return the configuration in plain values."""
        return self.config.model_dump(mode="json")

    def _model_of(self, terms: tuple[Term, ...]) -> ModalModel:
        """Return the attached model with terms, without nuisances."""
        values = self.values
        for term in terms:
            effect = EFFECTS[term.effect]
            if not effect.measured:
                values = effect.apply(
                    with_place(values, term.location), term.parameters, term.location
                )
        config = check_config(values, "variant of the model") if terms else self.config
        model = attach(config, self.campaign, self.basis)
        return replace(model, sensor_shapes=as_displacements(model))

    def model(self, point: Point) -> ModalModel:
        """Return the attached model of a Point."""
        model = self.models(point.terms)
        if not any(point.frequency) and not any(point.damping):
            return model
        factor, damping = np.ones(model.modes), np.ones(model.modes)
        count = min(len(point.frequency), model.modes)
        factor[:count] = np.exp(point.frequency[:count])
        count = min(len(point.damping), model.modes)
        damping[:count] = np.exp(point.damping[:count])
        omega = model.omega * factor
        order = np.argsort(omega, kind="stable") if (np.diff(omega) < 0).any() else None
        changed = (
            replace(model, omega=omega, damping=model.damping * damping * factor)
            if order is None
            else _ordered(model, omega, model.damping * damping * factor, order)
        )
        return changed

    def measuring(self, point: Point) -> Measuring:
        """Return what the measuring chain of a Point makes of the motion."""
        from vibroimpact.observation.sensor_chain import measuring_of

        names = [str(name) for name in self.campaign["channel_name"].values]
        gain, delay, force = np.ones(len(names)), np.zeros(len(names)), 1.0
        if point.gain:
            gain *= np.exp(point.gain)
        for term in point.terms:
            if EFFECTS[term.effect].measured:
                own = measuring_of(term.effect, term.parameters, term.location, names)
                gain, delay, force = gain * own.gain, delay + own.delay, force * own.force_gain
        return Measuring(gain, delay, force)


def _ordered(model, omega, damping, order):
    """Return a model with its modes in the order of their frequencies."""
    names = (
        "contact_shapes drive_shapes sensor_shapes line_shapes stress_shapes element_shapes"
        " initial_displacement initial_velocity constant_force"
    ).split()
    return replace(
        model,
        omega=omega[order],
        damping=damping[order],
        **{name: getattr(model, name)[order] for name in names},
    )
