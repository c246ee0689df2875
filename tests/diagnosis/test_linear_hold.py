"""How firmly the records below contact are held."""

from dataclasses import replace

import numpy as np

from tests.diagnosis.played import played
from vibroimpact.config.reading import check_config, load_config
from vibroimpact.diagnosis.bench import touches
from vibroimpact.diagnosis.comparison import Comparison
from vibroimpact.diagnosis.constants import LINEAR_HOLD
from vibroimpact.diagnosis.explanations import Point, Structure
from vibroimpact.diagnosis.gauss_newton import fit
from vibroimpact.diagnosis.linear_records import with_linear_records
from vibroimpact.diagnosis.measurement.attached_model import with_channel_points
from vibroimpact.diagnosis.measurement.signals import signals_of
from vibroimpact.diagnosis.measurement.usable import usable

NOISE = 0.002


def compared(campaign, model):
    """The Comparison of a campaign file with a model."""
    found, _ = usable(campaign, model)
    return Comparison(signals_of(found), Structure(with_channel_points(model, found), found))


def test_contact_is_seen_in_a_held_run(comparison):
    assert touches(played(comparison.fitted(), Point())).tolist() == [False, True, True]


def test_a_record_that_the_model_explains_is_held_little(measured):
    campaign, model, _ = measured
    found = with_linear_records(compared(campaign, load_config(model)))
    holds = {each.load > 5.0: each.hold for each in found.fitted().stretches}
    assert holds == {False: LINEAR_HOLD, True: 1.0}


def test_a_record_that_the_model_lacks_is_held_firmly(measured):
    """A tube that is 4 % stiffer has frequencies farther off than a modal test leaves them."""
    campaign, model, _ = measured
    values = load_config(model).model_dump(mode="json")
    values["structure"]["material"]["young_modulus_Pa"] *= 1.04
    assert not with_linear_records(compared(campaign, check_config(values, "stiffer"))).linear


def test_little_hold_shows_more_of_a_linear_tube(comparison):
    """Strong dampers answer the noise of all sensors in every channel."""
    low = played(comparison.fitted().on(slice(1)), Point())
    [stretch] = low.stretches
    noise = np.random.default_rng(2).standard_normal(stretch.motion.shape)
    motion = stretch.motion + NOISE * stretch.motion.std() * np.cumsum(noise, axis=0) / 300.0
    rows = comparison.nuisances()
    sd = {}
    for hold in (LINEAR_HOLD, 1.0):
        bench = replace(low, stretches=(replace(stretch, motion=motion, hold=hold),))
        sd[hold] = fit(bench, Point(), rows, 3).deviation
    of_modes = np.array([row.kind in ("frequency", "damping") for row in rows])
    shown = of_modes & (sd[1.0] < 0.2)
    assert shown.sum() >= 4
    assert np.median(sd[1.0][shown] / sd[LINEAR_HOLD][shown]) > 2.0
