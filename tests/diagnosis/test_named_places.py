"""Channels and forces of a campaign on a structure that is known at named points: a user's
matrices.
"""

import numpy as np
import pytest

from evidence.truth.model_file import model_of
from tests.support import own_matrices
from vibroimpact.campaign.file import read_campaign
from vibroimpact.config.reading import ConfigError, check_config
from vibroimpact.diagnosis.measurement.attached_model import attach
from vibroimpact.diagnosis.measurement.comparable import comparison_problems, model_rows
from vibroimpact.diagnosis.measurement.named_places import point_at


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("own")


@pytest.fixture(scope="module")
def values(folder):
    return own_matrices.model_values(folder)


@pytest.fixture(scope="module")
def campaign(folder):
    short = {"levels": own_matrices.LEVELS[:2], "duration": 2.0}
    return read_campaign(own_matrices.campaign_file(folder, **short))


def with_channel(campaign, **changes):
    """The campaign with another kind, point or direction of its first channel."""
    for key, value in changes.items():
        rows = campaign[f"channel_{key}"].values.copy()
        rows = rows.astype(object if rows.dtype.kind in "UO" else float)
        rows[0] = value
        campaign = campaign.assign({f"channel_{key}": (campaign[f"channel_{key}"].dims, rows)})
    return campaign


def test_matrices_move_as_the_tube_they_describe(values, folder, campaign):
    own = attach(own_matrices.checked(values, folder), campaign)
    tube = attach(check_config(model_of(own_matrices.plan()), "tube"), campaign)
    assert own.frequencies[:4] == pytest.approx(tube.frequencies[:4], rel=0.004)
    shapes = [np.abs(model.sensor_shapes[:4]) for model in (own, tube)]
    assert shapes[0] == pytest.approx(shapes[1], abs=0.01 * shapes[1].max())
    assert np.abs(own.drive_shapes[:4]) == pytest.approx(
        np.abs(tube.drive_shapes[:4]), abs=0.01 * np.abs(tube.drive_shapes[:4]).max()
    )
    assert own.sensor_names == tube.sensor_names


def test_supports_have_the_place_of_their_point(values, folder, campaign):
    own = attach(own_matrices.checked(values, folder), campaign)
    assert own.contact_position.tolist() == [[0.0, 0.0, 1.05]]


def test_channel_off_the_points_is_told(values, folder, campaign):
    config = own_matrices.checked(values, folder)
    off = with_channel(campaign, point=[0.0, 0.0, 0.23])
    (problem,) = comparison_problems(config, off)
    assert "0.0200 m from the nearest named point, n5" in problem
    in_mm = with_channel(campaign, point=[0.0, 0.0, 250.0])
    (problem,) = comparison_problems(config, in_mm)
    assert "at a named point: is it in millimetres?" in problem


def test_structure_without_places_is_told(values, folder, campaign):
    config = own_matrices.checked(values | {"points": {}}, folder)
    (problem,) = comparison_problems(config, campaign)
    assert "'matrices' does not say where its named points are: give `points`" in problem


def test_place_of_an_unknown_point_is_refused(values, folder):
    wrong = values | {"points": values["points"] | {"tipp": [0.0, 0.0, 1.2]}}
    with pytest.raises(ConfigError, match=r"points\.tipp.*is the place of no named point"):
        own_matrices.checked(wrong, folder)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"kind": "strain"}, "is a strain, which a structure of named points does not tell"),
        ({"direction": [0.0, 0.0, 1.0]}, "along [0.0, 0.0, 1.0] at n5, where the structure"),
    ],
)
def test_what_a_point_does_not_give_is_left_out(values, folder, campaign, changes, text):
    config = own_matrices.checked(values, folder)
    assert model_rows(config, campaign) == []
    (row,) = model_rows(config, with_channel(campaign, **changes))
    assert row["channel"] == campaign["channel_name"].values[0]
    assert text in row["message"]


def test_force_where_nothing_moves_is_told(values, folder, campaign):
    axial = campaign.assign(
        force_channel_direction=(
            campaign["force_channel_direction"].dims,
            np.array([[0.0, 0.0, 1.0]]),
        )
    )
    (problem,) = comparison_problems(own_matrices.checked(values, folder), axial)
    assert "acts along [0.0, 0.0, 1.0] at n8, where the structure has no such motion" in problem


def test_the_nearest_point_is_taken():
    points = {"a": (0.0, 0.0, 0.0), "b": (0.0, 0.0, 0.006)}
    assert point_at(points, [0.0, 0.0, 0.004], "it") == "b"
