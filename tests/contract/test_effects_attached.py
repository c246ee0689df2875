"""Every effect of the catalogue changes the model that campaigns are compared with: none is lost
between the configuration and what is simulated.
"""

from dataclasses import fields, is_dataclass

import numpy as np
import pytest

from tests.support.effect_values import term_at, with_term
from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.config.reading import check_config
from vibroimpact.diagnosis.comparison import Comparison
from vibroimpact.diagnosis.explanations import Structure, Term
from vibroimpact.diagnosis.measurement.attached_model import attach, with_channel_points
from vibroimpact.diagnosis.measurement.signals import signals_of
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.excitation.random_force import band_limited_noise

RATE, GAP = 2048.0, 2.8886e-4
OF_THE_MODEL = [
    name for name, effect in EFFECTS.items() if not effect.measured and not effect.needs
]


@pytest.fixture(scope="module")
def compared(study_config):
    """(configuration in plain values, campaign, attached model, scales)."""
    channels = [
        Channel(f"apex_{axis}", (0.0, 0.0, 1.0), direction, "m s-2", "acceleration")
        for axis, direction in (("x", (1, 0, 0)), ("y", (0, 1, 0)))
    ]
    drive = Channel("shaker", (-0.2121, 0.0, 0.9121), (0.0, 1.0, 0.0), "N", "generic")
    force = np.array([1.0, 8.0])[:, None, None] * band_limited_noise(
        np.random.default_rng(2), int(8 * RATE), RATE, (5.0, 200.0)
    )
    campaign = campaign_dataset(
        force,
        np.repeat(force, 2, axis=1),
        channels,
        [drive],
        [Level("low", GAP), Level("high", GAP)],
        RATE,
        start_up="rest",
    )
    config = with_channel_points(study_config, campaign)
    model = attach(config, campaign)
    comparison = Comparison(signals_of(campaign), Structure(config, campaign))
    return config.model_dump(mode="json"), campaign, model, comparison.sizes


def differing(one, other):
    """Names of the fields in which two models differ, fields of their laws included."""
    out = []
    for item in fields(one):
        first, second = getattr(one, item.name), getattr(other, item.name)
        if is_dataclass(first):
            out += [f"{item.name}.{name}" for name in differing(first, second)]
        elif np.shape(first) != np.shape(second) or not np.array_equal(
            np.asarray(first), np.asarray(second), equal_nan=np.asarray(first).dtype.kind == "f"
        ):
            out.append(item.name)
    return out


@pytest.mark.parametrize("name", OF_THE_MODEL)
def test_an_effect_changes_the_attached_model(compared, name):
    values, campaign, bare, sizes = compared
    effect = EFFECTS[name]
    location = effect.locations(values)[0]
    variant = attach(
        check_config(with_term(values, term_at(name, location, 0.7, sizes)), name), campaign
    )
    assert differing(bare, variant), f"{name} at {location} changes nothing that is simulated"


@pytest.mark.parametrize(
    "location",
    EFFECTS["clearance"].locations(
        {
            "structure": {"kind": "u_tube"},
            "points": {"shaker": (0, 0, 0), "apex": (1, 0, 0), "left_leg": (2, 0, 0)},
            "excitation": {"point": "shaker"},
        }
    ),
)
def test_a_stop_acts_along_the_force_wherever_it_sits(compared, location):
    """The axes of a section turn with the tube: at the apex the first is y, on a leg the second."""
    values, campaign, _, _ = compared
    model = attach(
        check_config(
            with_term(values, Term("clearance", location, (1.0e-4, 1.0e4))),
            "stop",
        ),
        campaign,
    )
    normal, point = model.contact_laws.land_normal[-2:], model.contact_laws.land_point[-2:]
    assert np.allclose(
        np.einsum("lp,lpc->lc", normal, model.contact_directions[point]),
        [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]],
    )


def test_added_stop_is_not_among_all_supports(compared):
    """An effect of all supports leaves the stop as it is, whichever of the two comes first."""
    values, _, _, sizes = compared
    stop = term_at("clearance", "apex", 0.6, sizes)
    everywhere = [name for name in OF_THE_MODEL if "all" in EFFECTS[name].locations(values)]
    assert len(everywhere) >= 10
    for name in everywhere:
        other = term_at(name, "all", 0.6, sizes)
        one, two = (
            with_term(with_term(values, first), second)
            for first, second in ((stop, other), (other, stop))
        )
        assert one == two, name


def test_misaligned_force_drives_the_transverse_direction(compared):
    values, campaign, bare, _ = compared
    model = attach(
        check_config(with_term(values, Term("force_misalignment", "about_z", (0.4,))), "turned"),
        campaign,
    )
    size = np.linalg.norm(bare.drive_shapes)
    assert np.linalg.norm(model.drive_shapes) == pytest.approx(size, rel=0.1)
    across = np.abs(bare.drive_shapes[:, 0]) < 1e-9 * size
    assert np.abs(model.drive_shapes[across]).max() > 0.1 * np.abs(bare.drive_shapes).max()
    along = ~across & (np.abs(bare.drive_shapes[:, 0]) > 0.01 * np.abs(bare.drive_shapes).max())
    np.testing.assert_allclose(
        model.drive_shapes[along, 0], np.cos(0.4) * bare.drive_shapes[along, 0], rtol=1e-6
    )
    np.testing.assert_array_equal(model.sensor_shapes, bare.sensor_shapes)


def test_force_turned_about_the_tube_stays_transverse(compared):
    values, campaign, bare, _ = compared
    model = attach(
        check_config(
            with_term(values, Term("force_misalignment", "about_tube", (0.5 * np.pi,))),
            "turned",
        ),
        campaign,
    )
    apart = campaign.assign(
        force_channel_direction=(
            ("force_channel", "xyz"),
            np.array([[-1.0, 0.0, 1.0]]) / np.sqrt(2.0),
        )
    )  # out of the bend, at 45 degrees
    np.testing.assert_allclose(
        model.drive_shapes,
        attach(check_config(values, "bare"), apart).drive_shapes,
        atol=1e-6 * np.abs(bare.drive_shapes).max(),
    )


def test_shifted_mode_may_cross_its_neighbours(compared):
    values, campaign, bare, _ = compared
    model = attach(
        check_config(with_term(values, Term("mode_frequency_error", "mode_3", (0.6,))), "passed"),
        campaign,
    )
    np.testing.assert_allclose(
        np.sort(np.where(np.arange(bare.modes) == 2, 0.6, 1.0) * bare.omega), model.omega
    )
    np.testing.assert_allclose(
        model.sensor_shapes[1], bare.sensor_shapes[2]
    )  # the third mode is the second now
    np.testing.assert_allclose(model.sensor_shapes[2], bare.sensor_shapes[1])
