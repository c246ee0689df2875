"""Each claim's verdict follows the data: a made-up study in which all hold, and one change at a
time that makes each fail.
"""

from dataclasses import replace

import numpy as np
import pytest

from evidence.validation.claims import equivalence, poles, response, shapes
from evidence.validation.claims.claim import CONDITIONS, FAILS, HOLDS
from evidence.validation.study_curves import POLES, STIFFNESS, StudyCurves
from vibroimpact.identify.linear.poles import first_pole
from vibroimpact.identify.linear.responses import frf

LOAD = np.geomspace(0.1, 20.0, 20)
SEEDS = 3
HELD = 4.0e6


@pytest.fixture(scope="module")
def model(study_model):
    """The default model."""
    return study_model


@pytest.fixture(scope="module")
def curves(model):
    """A study that follows the paper to the letter: the linear tube with a k that rises and a c
    that rises and falls, valleys filled.
    """
    k = np.geomspace(1e2, HELD, LOAD.size)
    c = 60.0 * np.exp(-(np.linspace(-2.0, 2.0, LOAD.size) ** 2)) + 1.0
    frequency = np.arange(0.0, 400.0, 0.1)
    found = [first_pole(model, *support) for support in zip(k, c, strict=True)]
    hertz = np.array([abs(pole) for pole in found]) / (2.0 * np.pi)
    ratio = np.array([-pole.real / abs(pole) for pole in found])
    ratio = 0.015 + 0.05 * np.exp(-(np.linspace(-2.5, 1.8, LOAD.size) ** 2))
    sensors = [name for name in model.sensor_names if name.endswith(".y")]
    columns = [model.sensor_names.index(name) for name in sensors]
    psd = {name: np.empty((LOAD.size, SEEDS, frequency.size)) for name in sensors}
    for i in range(LOAD.size):
        spread = np.hanning(3 + 2 * int(12 * np.exp(-(np.linspace(-2.0, 2.0, LOAD.size)[i] ** 2))))
        for name, column in zip(sensors, columns, strict=True):
            linear = (
                np.abs(
                    frf(
                        model,
                        k[i],
                        c[i],
                        np.maximum(frequency, 1e-3),
                        model.sensor_shapes[:, [column]],
                    )[0]
                )
                ** 2
            )
            smooth = np.convolve(linear, spread / spread.sum(), "same") * LOAD[i] ** 2 / 195.0
            valley = 0.2 * psd_floor(smooth, frequency)
            psd[name][i] = np.maximum(smooth, valley)
    line = model.line_shapes
    shape = np.array(
        [
            np.stack([frf(model, k[i], 0.0, np.array([hertz[i]]), line)[:, 0]] * SEEDS)
            for i in range(LOAD.size)
        ]
    )
    phase = 1.0 + 0.06j * np.exp(-(np.linspace(-2.0, 2.0, LOAD.size) ** 2))[
        :, None, None
    ] * np.linspace(-1.0, 1.0, line.shape[1])
    second = 0.005 + 0.02 * np.exp(-(np.linspace(-2.0, 2.0, LOAD.size) ** 2))
    singular = np.stack([np.ones(LOAD.size), second, 0.3 * second, 0.1 * second], axis=-1)[
        :, None
    ].repeat(SEEDS, axis=1)
    wiggle = 1.0 + 0.01 * np.arange(-1, 2)

    def tables(values, methods):
        return {method: np.outer(values, wiggle) for method in methods}

    summary = [
        {"gap_m": 3e-4, "load_rms_N": load, "method": method, "k_median": value}
        for load, value in zip(LOAD, k, strict=True)
        for method in STIFFNESS
    ]
    collapse = [{"method": method, "k_ratio": 1.05} for method in STIFFNESS]
    damping = {**tables(c, STIFFNESS), "ods": np.full((LOAD.size, SEEDS), np.nan)}
    return StudyCurves(
        3e-4,
        LOAD,
        tables(hertz, POLES),
        tables(ratio, POLES),
        tables(k, STIFFNESS),
        damping,
        frequency,
        psd,
        shape * phase,
        model.line_arc_length,
        singular,
        np.linspace(0.0, 0.8, LOAD.size),
        195.0,
        {3e-4: hertz[-1], 5e-5: hertz[-1]},
        collapse,
        summary,
    )


def psd_floor(psd, frequency):
    """The level that fills valleys: the mean PSD of the neighbourhood."""
    return np.convolve(psd, np.ones(401) / 401.0, "same")


def scaled(table, method, factor):
    """A table of methods with one method's values times a factor."""
    return {**table, method: table[method] * factor}


def test_published_study_satisfies_every_claim(curves, model):
    for claim in (
        poles.smooth_transition,
        poles.pole_methods,
        poles.limits,
        poles.widths,
        poles.apparent_damping,
        response.response_point,
        shapes.rank,
        shapes.no_damping,
        equivalence.three_stiffnesses,
        equivalence.gap_reduction,
        response.spread_peaks,
    ):
        assert claim(curves, model).verdict == HOLDS, claim(curves, model)


def jump(curves):
    """The frequency leaps in the middle."""
    hertz = curves.pole_frequency["lscf"].copy()
    hertz[LOAD.size // 2 :] *= 1.3
    return {"pole_frequency": {**curves.pole_frequency, "lscf": hertz}}


def flat(values):
    """All loads alike."""
    return np.broadcast_to(values[:1], values.shape).copy()


FALSIFIED = [
    (poles.smooth_transition, jump, {FAILS}),
    (poles.pole_methods, lambda s: {"pole_damping": scaled(s.pole_damping, "lscf", 3.0)}, {FAILS}),
    (poles.limits, lambda s: {"pole_frequency": scaled(s.pole_frequency, "lscf", 1.2)}, {FAILS}),
    (poles.limits, lambda s: {"top_frequency": {**s.top_frequency, 3e-4: 20.0}}, {CONDITIONS}),
    (poles.widths, lambda s: {"pole_damping": scaled(s.pole_damping, "peak_25th", 0.5)}, {FAILS}),
    (
        poles.apparent_damping,
        lambda s: {"pole_damping": {**s.pole_damping, "lscf": flat(s.pole_damping["lscf"])}},
        {FAILS},
    ),
    (shapes.rank, lambda s: {"singular": flat(s.singular)}, {FAILS}),
    (
        shapes.no_damping,
        lambda s: {"support_damping": scaled(s.support_damping, "broadband", 1e3)},
        {FAILS},
    ),
    (
        equivalence.three_stiffnesses,
        lambda s: {
            "summary": [
                {**row, "k_median": row["k_median"] * (2.0 if row["method"] == "ods" else 1.0)}
                for row in s.summary
            ]
        },
        {FAILS},
    ),
    (
        equivalence.gap_reduction,
        lambda s: {"collapse": [{**row, "k_ratio": 1.6} for row in s.collapse]},
        {FAILS},
    ),
    (
        response.response_point,
        lambda s: {"psd": {**s.psd, "apex.y": np.roll(s.psd["apex.y"], 12, axis=-1)}},
        {FAILS},
    ),
    (
        response.spread_peaks,
        lambda s: {"psd": {name: flat(psd) for name, psd in s.psd.items()}},
        {FAILS},
    ),
]


@pytest.mark.parametrize(
    ("claim", "change", "verdicts"),
    FALSIFIED,
    ids=[f"{claim.__name__}-{i}" for i, (claim, _, _) in enumerate(FALSIFIED)],
)
def test_false_claim_fails(curves, model, claim, change, verdicts):
    assert claim(replace(curves, **change(curves)), model).verdict in verdicts


def test_the_node_is_where_the_shape_changes_sign(curves, model):
    arc = np.linspace(0.0, 2.0, 41)
    assert shapes.node_place(np.exp(0.7j) * (arc - 0.33), arc, 1.0) == pytest.approx(0.33, abs=1e-9)
    assert np.isnan(shapes.node_place(np.exp(0.7j) * (arc + 0.33), arc, 1.0))
    rising = np.array([[(arc - place) * (1.0 + 0j)] for place in (-1.0, 0.1, 0.2, 0.3)])
    held = replace(curves, load=LOAD[:4], shape=rising, arc_length=arc)
    assert shapes.node(held, model).verdict == HOLDS
    assert shapes.node(replace(held, shape=rising[::-1]), model).verdict != HOLDS


def test_quadrature_is_the_part_no_phase_rotation_removes():
    real = np.linspace(-1.0, 1.0, 9)
    assert shapes.quadrature(np.exp(1.1j) * real) == pytest.approx(0.0, abs=1e-12)
    assert shapes.quadrature(real + 0.1j * real**2) > 0.05


def test_filled_anti_resonances_are_detected(curves, model):
    k, c = curves.stiffness["broadband"][:, 1], curves.support_damping["broadband"][:, 1]
    column = model.sensor_shapes[:, [model.sensor_names.index(response.VALLEY_SENSOR)]]
    exact = {
        i: np.abs(frf(model, k[i], c[i], np.maximum(curves.frequency, 1e-3), column)[0]) ** 2
        * LOAD[i] ** 2
        / 195.0
        for i in range(LOAD.size)
    }
    psd = np.stack([np.stack([exact[i]] * SEEDS) for i in range(LOAD.size)])
    linear = replace(curves, psd={**curves.psd, response.VALLEY_SENSOR: psd})
    raised = np.concatenate([values[:, 2] for values in response.valleys(linear, model).values()])
    assert raised.size and np.all(raised < 1.0)
    assert response.anti_resonances(linear, model).verdict == FAILS
    band = (curves.frequency > 15.0) & (curves.frequency < 150.0)
    level = np.quantile(psd[..., band], 0.85, axis=-1, keepdims=True)
    filled = replace(curves, psd={**curves.psd, response.VALLEY_SENSOR: np.maximum(psd, level)})
    assert response.anti_resonances(filled, model).verdict != FAILS


def test_step_dependent_response_is_detected():
    generator = np.random.default_rng(5)
    names = equivalence.STATISTICS
    rows = [
        {
            "value": value,
            "load_rms_N": load,
            "potential_energy_residual": 1e-3,
            **{name: 10.0 + generator.standard_normal() for name in names},
        }
        for value in (51200, 204800)
        for load in (5.0, 20.0)
        for _ in range(16)
    ]
    assert equivalence.step(rows).verdict == HOLDS
    shifted = [
        {**row, **{name: row[name] + 3.0 for name in names}} if row["value"] == 51200 else row
        for row in rows
    ]
    assert equivalence.step(shifted).verdict == FAILS
