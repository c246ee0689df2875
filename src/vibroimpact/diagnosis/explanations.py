"""Explanations: effects at places with values, the nuisances of a measured structure, and the model
with both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import xarray as xr

from vibroimpact.config.reading import check_config
from vibroimpact.config.schema import Config
from vibroimpact.effects.effect import Effect, Values
from vibroimpact.effects.places import with_place
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.reduction.modal_model import MODE_FIELDS, ModalModel

from .measurement.attached_model import attach, attached_basis
from .measurement.sensed_motion import displacement_scale
from .measurement.sensor_chain import Measuring

KEPT_MODELS = 256
# Records are compared at a sampling frequency of so much at least, and so many times the first
# mode, or at their own.
SLOWEST_HZ, PER_FIRST_MODE = 2000.0, 20.0
TURNED, DAMPED = "force_misalignment", "modal_damping"
SEEN = 1.0e-3  # of the largest shape at a sensor or force: a smaller one is not seen
# Modes are kept to so many times the sampling frequency of the records, in free runs and in held
# ones: the others change the holding force of a right model by a per cent of its power.
MODES_TO, HELD_TO = 3.0, 1.5
# Arrays of a ModalModel whose first axis is the mode, other than omega and damping.
BY_MODE = tuple(name for name in MODE_FIELDS if name not in ("omega", "damping"))


@dataclass(frozen=True)
class Term:
    """An effect of the catalogue at a place; values: of its parameters in SI, in their order."""

    effect_id: str
    location: str
    values: tuple[float, ...]

    @property
    def effect(self) -> Effect:
        """Return the Effect."""
        return EFFECTS[self.effect_id]

    @property
    def name(self) -> str:
        """Return effect@location."""
        return f"{self.effect_id}@{self.location}"

    @property
    def parameters(self) -> dict[str, float]:
        """Return {name: value in SI}."""
        names = (parameter.name for parameter in self.effect.parameters)
        return dict(zip(names, self.values, strict=True))


@dataclass(frozen=True)
class Point:
    """Terms, and the nuisances: an angle, and logarithms of factors.

    frequency, damping (mode,): of the modes that sensors or forces see, from the lowest on.
    gain (channel,): of the channels. turn (1,): rad, by which the force is turned about the tube.
    """

    terms: tuple[Term, ...] = ()
    frequency: tuple[float, ...] = ()
    damping: tuple[float, ...] = ()
    gain: tuple[float, ...] = ()
    turn: tuple[float, ...] = ()

    @property
    def name(self) -> str:
        """Return the names of the terms, joined."""
        return " + ".join(term.name for term in self.terms) or "nothing"

    @property
    def ids(self) -> list[str]:
        """Return the ids of the effects as they are reported."""
        return [term.effect.reported for term in self.terms]

    @property
    def net_terms(self) -> tuple[Term, ...]:
        """Return the terms, a common factor of the damping times the mean one of the nuisances:
        where these undo it, only modes above the band are damped, by which a right model gains too.
        """
        mean = float(np.exp(np.mean(self.damping or (0.0,))))
        return tuple(
            replace(term, values=(term.values[0] * mean,)) if term.effect_id == DAMPED else term
            for term in self.terms
        )

    def with_own_gains(self, names: Sequence[str]) -> Point:
        """Return the Point with the nuisance gain of a channel merged into its sensor_gain, if it
        has one: the two are the same quantity. names (channel,): of the channels.
        """
        gain, terms = list(self.gain), []
        for term in self.terms:
            number = names.index(term.location) if term.location in names else len(gain)
            if term.effect_id == "sensor_gain" and number < len(gain):
                term = replace(term, values=(term.values[0] * float(np.exp(gain[number])),))
                gain[number] = 0.0
            terms.append(term)
        return replace(self, terms=tuple(terms), gain=tuple(gain))

    def beside(self, term: Term) -> Point:
        """Return the Point with one more term."""
        return replace(self, terms=(*self.terms, term))


class Structure:
    """The model as given, attached to a campaign; it makes the models of Points.

    values: of its configuration. names (channel,): of the channels. scale (channel,): displacement
    per unit of a channel's quantity. decimation: of the records that are compared with it.
    """

    def __init__(self, config: Config, campaign: xr.Dataset):
        own = attach(config, campaign)
        self.config, self.campaign = config, campaign
        self.values: Values = config.model_dump(mode="json")
        self.names = [str(name) for name in campaign["channel_name"].values]
        self.scale = displacement_scale(own, campaign["channel_kind"].values)
        self.with_terms = lru_cache(maxsize=KEPT_MODELS)(self._with_terms)
        self._lower = lru_cache(maxsize=KEPT_MODELS)(_without_highest)
        self._basis = attached_basis(config, campaign)
        sampling = float(campaign.attrs["sampling_frequency"])
        first = float(own.frequencies[own.omega > 0.0].min())
        self.decimation = max(int(sampling / max(SLOWEST_HZ, PER_FIRST_MODE * first)), 1)
        # numbers of modes that free runs and held ones leave out
        self._dropped, self._unheld = (
            int(np.sum(own.frequencies > to * sampling / self.decimation))
            for to in (MODES_TO, HELD_TO)
        )

    def terms(self, point: Point) -> tuple[Term, ...]:
        """Return the terms of a Point and a term for the turn of its force, about the same axis as
        a term that turns it.
        """
        if not any(point.turn):
            return point.terms
        *_, place = EFFECTS[TURNED].locations(self.values)
        own = (term.location for term in point.terms if term.effect_id == TURNED)
        return (*point.terms, Term(TURNED, next(own, place), point.turn))

    def configuration(self, terms: tuple[Term, ...]) -> Config:
        """Return the checked Config with terms. Raises ConfigError for values that none can
        have.
        """
        values = self.values
        for term in terms:
            if term.effect.apply is not None:
                values = with_place(values, term.location)
                values = term.effect.apply(values, term.parameters, term.location)
        return check_config(values, "the model with an effect") if terms else self.config

    def _with_terms(self, terms: tuple[Term, ...]) -> ModalModel:
        """Return the attached model with terms, its sensors scaled to displacements."""
        model = attach(self.configuration(terms), self.campaign, self._basis)
        model = replace(model, sensor_shapes=model.sensor_shapes * self.scale)
        return _without_highest(model, self._dropped)

    def held_model(self, point: Point) -> ModalModel:
        """Return the model of a Point with the modes that a held run needs; see `model`."""
        return self._lower(self.model(point), self._unheld - self._dropped)

    def model(self, point: Point) -> ModalModel:
        """Return the attached model of a Point.

        Raises ConfigError or ValueError for values that no structure can have.
        """
        model = self.with_terms(self.terms(point))
        if not any(point.frequency) and not any(point.damping):
            return model
        factor, damping = (
            np.exp(_on_modes(own, seen(model))) for own in (point.frequency, point.damping)
        )
        omega, damping = model.omega * factor, model.damping * damping * factor
        order = np.argsort(omega, kind="stable")
        return replace(
            model,
            omega=omega[order],
            damping=damping[order],
            **{name: getattr(model, name)[order] for name in BY_MODE},
        )

    def measuring(self, point: Point) -> Measuring:
        """Return the measuring chain of a Point."""
        still = np.zeros(len(self.names))
        chain = Measuring(np.exp(point.gain) + still if point.gain else 1.0 + still, still)
        for term in point.terms:
            if term.effect.measured:
                chain = chain.with_fault(term.effect_id, term.parameters, term.location, self.names)
        return chain


def seen(model: ModalModel) -> np.ndarray:
    """Return (mode,) bool: which modes a sensor or a force sees.

    That of a plate which the tube does not touch is not among them: it leaves the others their
    numbers.
    """
    shapes = np.abs(np.hstack([model.sensor_shapes, model.drive_shapes]))
    return np.max(shapes / np.maximum(shapes.max(axis=0), 1.0e-300), axis=1) > SEEN


def _without_highest(model: ModalModel, number: int) -> ModalModel:
    """Return a model without a number of its modes."""
    kept = slice(model.modes - number)
    names = ("omega", "damping", *BY_MODE)
    return replace(model, **{name: getattr(model, name)[kept] for name in names})


def _on_modes(values, chosen):
    """Return (mode,) values of the chosen modes in their order, 0 of the others and beyond."""
    out, places = np.zeros(chosen.size), np.flatnonzero(chosen)[: len(values)]
    out[places] = values[: len(places)]
    return out
