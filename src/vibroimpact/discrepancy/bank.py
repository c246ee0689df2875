"""Simulations of another campaign, of shorter records, or of both, brought to this one: matched by
channel, record and mode, moved by what the bare models differ.
"""

from dataclasses import replace
from functools import cached_property

import numpy as np

from . import nuisance as linear
from . import store
from .attach import attach
from .candidates import candidate_named
from .features import COARSE


def feature_keys(bench):
    """Return [kind/channel name/band] (feature,): what a feature is, whatever else its campaign
    holds.
    """
    layout, names = bench.layout, bench.signals.names
    others = iter(
        [names[other] for _ in ("co", "quad") for _, other in layout.pairs for _ in range(COARSE)]
    )
    return [
        f"{kind}/{names[channel]}/{next(others) if kind in ('co', 'quad') else ''}/{band}"
        for kind, channel, band in zip(layout.kind, layout.channel, layout.band, strict=True)
    ]


def record_keys(bench, records):
    """Return [load/gap] of records: nominal values, to three digits."""
    return [
        f"{bench.signals.load[record]:.3g}/{bench.signals.gap[record]:.3g}" for record in records
    ]


def described(bench, records):
    """Return the arrays that tell another campaign what the features of this one are."""
    return {
        "feature_keys": np.array(feature_keys(bench)),
        "record_keys": np.array(record_keys(bench, records)),
        "names": np.array(bench.signals.names),
    }


class Source:
    """Where the simulations come from: null parts (files) of a campaign whose features are those
    with a prefix, see store.null_features; bank: it is another campaign, with nothing adopted.
    Raises ValueError where it lacks what the campaign has.
    """

    def __init__(self, bench, null, files, prefix, bank):
        self.bench, self.null, self.bank = bench, null, bank
        missing = lacking(bench, null.records, files[0])
        if missing:
            raise ValueError(
                f"the bank has no {missing}: take one of the same model, loads, gaps and channels,"
                " or leave out bank="
            )
        there, here = store.load(files[0]), described(bench, null.records)
        self.features, self.records, self.channels = (
            [list(there[name]).index(key) for key in here[name]] for name in here
        )
        self.mean = self._here(store.null_features(files, prefix, ("features",))[0].mean(axis=1))

    def _here(self, features):
        """Return (..., record, feature) of this campaign from those of the source."""
        return features[..., self.records, :][..., self.features]

    def brought(self, path):
        """Return a Path of the source as one of this campaign."""
        readings = (
            [self._reading(row, self.bench.bare) for row in path.readings]
            if self.bank
            else path.readings
        )
        return replace(
            path, features=self._here(path.features) - self.mean + self.null.mean, readings=readings
        )

    def unmoved(self, path):
        """Return a Path of a bank as one of this campaign in the place of the linear effect that it
        adopted: there is no null of that to move it by.
        """
        return replace(
            path,
            features=self._here(path.features),
            readings=[self._reading(row, self.bare) for row in path.readings],
        )

    @cached_property
    def bare(self):
        """Return the bare model with nothing adopted."""
        return attach(self.bench.config, self.bench.campaign)

    def _reading(self, reading, model):
        """Return a Reading of a variant with the channels and modes of this campaign: what it
        changes, on a model.
        """
        if not self.bench.reads_lowest or (reading is None and model is self.bench.bare):
            return None
        if reading is None:
            return linear.gained(
                linear.reading_of_model(model, self.bench.measured_fit.modes), self.bench.measuring
            )
        modes = self.bench.measured_fit.modes
        common = np.intersect1d(modes, reading.modes)
        here = np.searchsorted(modes, common)
        there = [list(reading.modes).index(mode) for mode in common]
        was = linear.reading_of_model(self.bare, common)
        now = linear.reading_of_model(model, modes)
        for name in ("log_frequency", "log_damping"):
            getattr(now, name)[here] += getattr(reading, name)[there] - getattr(was, name)
        now.participation[:, here] += (
            reading.participation[self.channels][:, there] - was.participation
        )
        return linear.gained(
            replace(now, residual=reading.residual[self.channels]), self.bench.measuring
        )


def known_paths(files, source=None, prepared=None):
    """Return {Candidate: Path} of {candidate name: file}, brought here from a Source where one is
    given, for the campaign of a Prepared.
    """
    out = {}
    for name, file in files.items():
        arrays = store.load(file) or {}
        for alone, prefix in ((False, ""), (True, store.ALONE)):
            path = store.path_of(arrays, prefix)
            if path is not None:
                candidate = candidate_named(name)
                out[replace(candidate, alone=alone)] = (
                    path if source is None else source.brought(path)
                )
                if source is not None and source.bank and name in prepared.in_place:
                    out[replace(candidate, alone=True)] = source.unmoved(path)
    return out


def lacking(bench, records, file):
    """Return what of a campaign's records a null part (file) of another does not describe, as
    "channel apex_y", None where it has all.
    """
    there = store.load(file)
    what = {"names": "channel", "record_keys": "record of load/gap", "feature_keys": "feature"}
    here = described(bench, records)
    return next(
        (f"{what[name]} {key}" for name in what for key in here[name] if key not in there[name]),
        None,
    )
