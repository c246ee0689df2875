"""Chains and matrices: what is read, what is refused, and the physics of the models they make."""

import copy

import numpy as np
import pytest
from scipy import io, sparse
from scipy.integrate import solve_ivp

from vibroimpact.config.reading import ConfigError, check_config
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.structure.contact.local_elements import split_damping
from vibroimpact.structure.matrix_files import MatrixFileError, read_matrix
from vibroimpact.structure.point_structure import build_point_structure
from vibroimpact.study.cases import all_cases
from vibroimpact.study.simulation import simulate_cases

CHAIN = {
    "study": "chain",
    "structure": {
        "kind": "chain",
        "masses": [{"name": "a", "mass_kg": 2.0}, {"name": "b", "mass_kg": 1.0}],
        "springs": [
            {"between": ["ground", "a"], "stiffness_N_per_m": 3.0e3},
            {"between": ["a", "b"], "stiffness_N_per_m": 1.0e3},
        ],
    },
    "damping": {"kind": "modal", "other_ratio": 0.0},
    "excitation": {"kind": "none"},
    "integration": {"steps_per_second": 20000, "start_up_s": 0.0, "imperfection": 0.0},
    "grid": {"load_rms_N": [1.0], "gap_m": [1.0], "seeds": 1},
    "record": {"duration_s": 0.5, "every_step": True},
}
STOPS = {"kind": "planes", "normals_deg": [0.0, 180.0]}
MASS, STIFFNESS = np.diag([2.0, 1.0]), np.array([[4.0e3, -1.0e3], [-1.0e3, 1.0e3]])


def chain(**changes):
    """The checked configuration of the chain with top-level keys changed."""
    return check_config({**copy.deepcopy(CHAIN), **changes}, "chain")


def only_record(config):
    """The record of the one case of a configuration."""
    ((_, record),) = simulate_cases(config, build_model(config), all_cases(config.grid))
    return record


def test_a_chain_has_the_frequencies_of_its_matrices():
    structure = build_point_structure(chain())
    assert np.array_equal(structure.mass.toarray(), MASS) and np.allclose(
        structure.stiffness.toarray(), STIFFNESS
    )
    squares = np.sort(np.linalg.eigvals(np.linalg.solve(MASS, STIFFNESS)).real)
    assert build_model(chain()).omega == pytest.approx(np.sqrt(squares), rel=1e-12)


@pytest.mark.parametrize("ending", ["npz", "mat", "mtx", "sparse.npz"])
def test_matrices_come_from_every_format(tmp_path, ending):
    path = tmp_path / f"stiffness.{ending}"
    if ending == "npz":
        np.savez(path, K=STIFFNESS, M=MASS)
    elif ending == "mat":
        io.savemat(path, {"stiffness": STIFFNESS, "other": MASS})
    elif ending == "mtx":
        io.mmwrite(path, sparse.csr_array(STIFFNESS))
    else:
        sparse.save_npz(path, sparse.csr_array(STIFFNESS))
    assert np.array_equal(read_matrix(path, "stiffness").toarray(), STIFFNESS)


def test_matrices_that_can_not_be_used_are_refused(tmp_path):
    np.savez(tmp_path / "two.npz", first=MASS, second=MASS)
    np.savez(tmp_path / "skew.npz", M=np.array([[1.0, 2.0], [0.0, 1.0]]))
    np.savez(tmp_path / "long.npz", M=np.ones((2, 3)))
    io.mmwrite(tmp_path / "complex.mtx", sparse.csr_array(MASS * 1j))
    (tmp_path / "text.txt").write_text("1")
    for name, part in (
        ("two.npz", "name the mass matrix 'mass'"),
        ("skew.npz", "not symmetric"),
        ("long.npz", "a square matrix is needed"),
        ("text.txt", "none of .npz, .mat, .mtx, .op4"),
        ("complex.mtx", "is complex"),
        ("no.npz", "no such file"),
    ):
        with pytest.raises(MatrixFileError, match=part):
            read_matrix(tmp_path / name, "mass")


def test_matrices_and_chain_are_the_same_model(tmp_path):
    for name, matrix in (("mass", MASS), ("stiffness", STIFFNESS)):
        io.mmwrite(tmp_path / f"{name}.mtx", sparse.csr_array(matrix))
    given = {
        "kind": "matrices",
        "mass": str(tmp_path / "mass.mtx"),
        "stiffness": str(tmp_path / "stiffness.mtx"),
        "points": {"a": {"x": 0}, "b": {"x": 1}},
    }
    start = {"displacement_m": {"b": {"x": 1.0e-3}}}
    spring = [
        {"name": "end", "point": "b", "direction": [1.0, 0.0, 0.0], "stiffness_N_per_m": 500.0}
    ]
    one, other = (
        only_record(chain(structure=structure, initial=start, elements=spring))
        for structure in (given, CHAIN["structure"])
    )
    assert one["element_displacement"].values == pytest.approx(
        other["element_displacement"].values, abs=1e-12
    )


def test_dampers_of_a_chain_couple_its_modes_as_the_matrices_say():
    springs = copy.deepcopy(CHAIN["structure"])
    springs["springs"][1]["damping_N_s_per_m"] = 6.0
    watch = [{"name": "watch", "point": "b", "direction": [1.0, 0.0, 0.0]}]
    record = only_record(
        chain(structure=springs, initial={"displacement_m": {"b": {"x": 1.0e-3}}}, elements=watch)
    )
    damping = 6.0 * np.array([[1.0, -1.0], [-1.0, 1.0]])

    def motion(_, state):
        return np.concatenate(
            [state[2:], -np.linalg.solve(MASS, STIFFNESS @ state[:2] + damping @ state[2:])]
        )

    time = record["step_time"].values
    exact = solve_ivp(
        motion, (0.0, time[-1]), [0.0, 1.0e-3, 0.0, 0.0], t_eval=time, rtol=1e-10, atol=1e-14
    ).y[1]
    assert record["element_displacement"].values[0] == pytest.approx(exact, abs=1e-6 * 1.0e-3 * 20)


def test_a_damping_matrix_is_rebuilt_from_its_parts():
    generator = np.random.default_rng(3)
    rows = generator.standard_normal((3, 8))
    diagonal = np.diag(generator.uniform(1.0, 2.0, 8))
    for matrix, dampers in ((diagonal, 0), (rows.T @ np.diag([1.0, 2.0, 3.0]) @ rows, 3)):
        kept, shapes, coefficients = split_damping(matrix)
        assert len(coefficients) == dampers
        assert np.diag(kept) + (shapes * coefficients) @ shapes.T == pytest.approx(
            matrix, abs=1e-12
        )
    with pytest.raises(ValueError, match="at most 20 are possible: give proportional damping"):
        split_damping(np.eye(30) + 0.1 * np.cov(generator.standard_normal((30, 100))))


def test_base_motion_agrees_with_absolute_coordinates():
    """Relative and absolute formulation: two masses on a base that moves as a sine, an elastic stop
    fixed in space.
    """
    base = {
        "kind": "base_motion",
        "direction": [1.0, 0.0, 0.0],
        "obstacles": "fixed",
        "signal": {"kind": "harmonic", "frequency_Hz": 4.0},
    }
    stop = [
        {
            "name": "stop",
            "point": "b",
            "stiffness_N_per_m": 2.0e4,
            "gap_m": 1.0e-3,
            "profile": {"kind": "planes", "normals_deg": [0.0]},
        }
    ]
    omega = 8.0 * np.pi
    speed = -np.sqrt(2.0) * 2.0 / omega  # of s = -sqrt(2) load sin(omega t) / omega², load 2 m/s²
    record = only_record(
        chain(
            excitation=base,
            supports=stop,
            initial={"base_velocity_m_per_s": speed},
            grid={"load_rms_N": [2.0], "gap_m": [1.0], "seeds": 1},
        )
    )

    def motion(time, state):
        moved = -np.sqrt(2.0) * 2.0 * np.sin(omega * time) / omega**2
        relative = state[:2] - moved
        push = -2.0e4 * max(state[1] - 1.0e-3, 0.0)
        return np.concatenate(
            [state[2:], np.linalg.solve(MASS, -STIFFNESS @ relative + np.array([0.0, push]))]
        )

    time = record["step_time"].values
    exact = solve_ivp(
        motion,
        (0.0, time[-1]),
        [0.0, 0.0, speed, speed],
        t_eval=time,
        rtol=1e-10,
        atol=1e-14,
        max_step=1e-4,
    ).y[1]
    found = record["contact_displacement"].values[0, 0]
    assert record["contact_force"].values[0, 0].min() < -1.0
    assert np.max(np.abs(found - exact)) < 1e-4 * np.max(np.abs(exact))


def test_a_dead_load_settles_at_the_static_deflection():
    pulled = {
        "kind": "none",
        "constant": [{"point": "b", "direction": [1.0, 0.0, 0.0], "force_N": 5.0}],
    }
    damped = {"kind": "modal", "other_ratio": 0.2}
    watch = [{"name": name, "point": name, "direction": [1.0, 0.0, 0.0]} for name in ("a", "b")]
    record = only_record(
        chain(
            excitation=pulled,
            damping=damped,
            elements=watch,
            record={"duration_s": 4.0, "every_step": True},
        )
    )
    assert record["element_displacement"].values[:, -1] == pytest.approx(
        np.linalg.solve(STIFFNESS, [0.0, 5.0]), rel=1e-6
    )


def test_a_gap_between_two_masses_opens_and_closes():
    between = [
        {
            "name": "pair",
            "point": "a",
            "other_point": "b",
            "stiffness_N_per_m": 1.0e5,
            "gap_m": 1.0e-3,
            "profile": {"kind": "planes", "normals_deg": [0.0]},
        }
    ]
    record = only_record(chain(supports=between, initial={"velocity_m_per_s": {"a": {"x": 0.3}}}))
    relative = record["contact_displacement"].values[0, 0]
    force = record["contact_force"].values[0, 0]
    assert np.array_equal(force < 0.0, relative > 1.0e-3) and (force < 0.0).any()
    energy = dict(zip(record["run_term"].values, record["run_energy"].values, strict=True))
    assert abs(energy["mechanical"] + energy["stored"]) < 1e-4 * 0.5 * 2.0 * 0.3**2


def test_stops_at_unequal_distances_are_stops_off_centre():
    """Stops at +1 mm and -1.6 mm, as a table and as a pair at 1.3 mm round -0.3 mm."""
    ways = (
        {"gap_m": 1.0e-3, "profile": STOPS | {"extra_gap_m": [0.0, 6.0e-4]}},
        {"gap_m": 1.3e-3, "profile": STOPS, "centre_offset_m": [-3.0e-4, 0.0]},
    )
    table, offset = (
        only_record(
            chain(
                supports=[{"name": "stops", "point": "a", "stiffness_N_per_m": 1.0e5} | way],
                initial={"velocity_m_per_s": {"a": {"x": 0.3}}},
            )
        )
        for way in ways
    )
    force = table["contact_force"].values
    assert force.min() < 0.0 < force.max()
    assert force == pytest.approx(offset["contact_force"].values, abs=1e-6 * force.max())


def test_two_tubes_that_meet_are_one_with_a_wall_midway():
    """Two equal masses that move as mirror images meet in the plane of symmetry: half the gap, and
    a spring of half the length.
    """
    masses = [{"name": name, "mass_kg": 2.0} for name in ("a", "b")]
    springs = [
        {"between": ["ground", name], "stiffness_N_per_m": 8.0e4, "damping_N_s_per_m": 4.0}
        for name in ("a", "b")
    ]
    structure = {"kind": "chain", "masses": masses, "springs": springs}
    facing = {"name": "pair", "point": "a", "other_point": "b", "stiffness_N_per_m": 1.0e6}
    wall = {"name": "pair", "point": "a", "stiffness_N_per_m": 2.0e6}
    pair, alone = (
        only_record(
            chain(
                structure=structure,
                supports=[support | {"gap_m": gap, "profile": STOPS | {"normals_deg": [0.0]}}],
                initial={"velocity_m_per_s": {"a": {"x": 0.3}, "b": {"x": -0.3}}},
            )
        )
        for support, gap in ((facing, 2.0e-3), (wall, 1.0e-3))
    )
    force = pair["contact_force"].values
    assert force.min() < -100.0
    assert force == pytest.approx(alone["contact_force"].values, abs=1e-6 * -force.min())


REFUSED = [
    (
        {
            "supports": [
                {"name": "stop", "at_m": [0, 0, 0], "height_m": 0.1, "stiffness_N_per_m": 1.0}
            ]
        },
        "supports[0] = 'stop' is on a structure of kind chain: give point",
    ),
    (
        {"supports": [{"name": "stop", "point": "c", "stiffness_N_per_m": 1.0}]},
        "supports[0].point = 'c' is not one of the named points",
    ),
    (
        {"supports": [{"name": "stop", "point": "a", "gap_m": 0.0, "stiffness_N_per_m": 1.0}]},
        "supports[0].gap_m = 0.0 must be > 0 round a centre",
    ),
    (
        {"elements": [{"name": "e", "point": "z", "direction": [1, 0, 0]}]},
        "elements[0].point = 'z' is not one of the named points",
    ),
    (
        {
            "excitation": {
                "kind": "harmonic",
                "point": "a",
                "direction": [1, 0, 0],
                "frequency_Hz": 5000.0,
            }
        },
        "20 steps per period",
    ),
    (
        {"integration": {"steps_per_second": 20000, "start_up_s": 1.0}},
        "must be 0 if every step is kept",
    ),
    ({"record": {"duration_s": 900.0, "every_step": True}}, "shorten record.duration_s"),
    (
        {
            "identification": {
                "response_point": "a",
                "lscf": {"references": ["a"]},
                "broadband": {"point": "a"},
            }
        },
        "leave identification out",
    ),
]


@pytest.mark.parametrize(
    ("changes", "sentence"), REFUSED, ids=[sentence[:30] for _, sentence in REFUSED]
)
def test_mistakes_are_named(changes, sentence):
    with pytest.raises(ConfigError) as refusal:
        chain(**changes)
    assert any(sentence in line for line in refusal.value.problems), refusal.value.problems


def test_a_spring_to_nowhere_is_named():
    broken = copy.deepcopy(CHAIN["structure"])
    broken["springs"][1]["between"] = ["a", "bb"]
    with pytest.raises(ConfigError, match="structure.springs.1..between = 'bb' is no mass"):
        chain(structure=broken)
