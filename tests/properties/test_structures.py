"""Generated structures: refused with a sentence, or their reduced model is right.

Right: a Ritz basis only stiffens, frequencies are finite, no more modes are rigid than the ends
allow, and a contact is as flexible as the full model says. Matrices have the eigenvalues that they
were made of.
"""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy import linalg
from scipy.sparse.linalg import spsolve

from tests.properties.guarded import Tried, folder_of_example, guarded
from vibroimpact.config.problems import ConfigError
from vibroimpact.config.reading import check_config
from vibroimpact.config.structure import Path as PathSection
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.reduction.model_accuracy import model_accuracy
from vibroimpact.reduction.reduced_model import build_model, full_structure
from vibroimpact.structure.rigid_motions import free_rigid_motions
from vibroimpact.study.model_checks import check_model

EPSILON = float(np.finfo(float).eps)
# Words of numerical libraries, which are no sentence for a user.
LIBRARY_WORDS = ("leading minor", "converge", "infs or NaNs", "ingular matrix", "zero-size")
ENDS = st.sampled_from(
    [
        {"kind": "clamped"},
        {"kind": "pinned"},
        {"kind": "free"},
        {"kind": "springs", "translation_N_per_m": 1.0e6, "rotation_N_m_per_rad": 1.0e3},
        {"kind": "springs", "translation_N_per_m": 1.0e-9, "rotation_N_m_per_rad": 1.0e12},
    ]
)


class Refused(Exception):
    """The problems that the checks of a model found."""


def powers(low, high):
    """Numbers between powers of ten, evenly in their logarithm."""
    return st.floats(low, high).map(lambda power: float(10.0**power))


@st.composite
def structures(draw):
    """The section `structure` of a path."""
    lengths = powers(-1.5, 0.7)
    straight = st.fixed_dictionaries({"kind": st.just("straight"), "length_m": lengths})
    bend = st.fixed_dictionaries(
        {
            "kind": st.just("bend"),
            "radius_m": powers(-1.0, 0.0),
            "angle_deg": st.sampled_from([10.0, 90.0, 180.0]),
            "toward": st.sampled_from([[1.0, 0.0, 0.1], [0.0, 1.0, 0.3], [0.3, -1.0, 0.0]]),
        }
    )
    outer = draw(powers(-2.5, -1.3))
    return {
        "kind": "path",
        "theory": draw(st.sampled_from(["timoshenko", "euler_bernoulli"])),
        "section": {"outer_diameter_m": outer, "wall_thickness_m": outer * draw(powers(-2, -0.4))},
        "material": {"young_modulus_Pa": 2e11, "poisson_ratio": 0.3, "density_kg_per_m3": 8e3},
        "start_m": [0.0, 0.0, 0.0],
        "start_direction": [0.0, 0.0, 1.0],
        "segments": draw(st.lists(straight | bend, min_size=1, max_size=3)),
        "mesh": {
            "elements_per_span": draw(st.integers(1, 8)),
            "elements_per_bend": draw(st.integers(1, 8)),
        },
        "start": draw(ENDS),
        "end": draw(ENDS),
    }


@st.composite
def supports(draw, line):
    """The sections of supports along a centreline, also at its ends, its joints and beside it."""
    places = [0.0, *(segment.end for segment in line.segments)]
    near = st.builds(
        lambda place, off: place + off,
        st.sampled_from(places),
        st.sampled_from([-1e-2, -1e-3, -1e-4, -1e-6, 0.0, 1e-6, 1e-4, 1e-3, 1e-2]),
    )
    anywhere = st.floats(0.02, 0.98).map(lambda part: part * line.length)
    out = []
    for number in range(draw(st.integers(0, 3))):
        place = min(max(draw(anywhere | anywhere | near), 0.0), line.length)
        off = draw(st.sampled_from([0.0, 0.0, 0.0, 1e-3, 1.0]))
        out.append(
            {
                "name": f"support_{number}",
                "at_m": (line.position(place) + off).tolist(),
                "height_m": draw(powers(-3.5, -0.5)),
                "points": draw(st.integers(1, 6)),
                "stiffness_N_per_m": draw(powers(0.0, 8.0)),
            }
        )
    return out


@st.composite
def tubes(draw):
    """A configuration of a path with supports."""
    structure = draw(structures())
    line = build_centreline(PathSection.model_validate(structure))
    held = draw(supports(line))
    basis = {
        "free_modes_to_Hz": draw(powers(1.0, 3.8)),
        "constrained_modes_to_Hz": draw(powers(1.0, 3.0)),
        "attachment_shapes": draw(st.sampled_from([True, True, True, False])),
    }
    return {
        "study": "made",
        "structure": structure,
        "damping": {"kind": "modal", "other_ratio": 0.01},
        "supports": held,
        "points": {"drive": line.position(draw(st.floats(0.1, 0.9)) * line.length).tolist()},
        "excitation": {
            "kind": "harmonic",
            "point": "drive",
            "direction": [1.0, 1.0, 0.3],
            "frequency_Hz": draw(powers(0.0, 2.5)),
        },
        "basis": basis,
        "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-4], "seeds": 1},
        "record": {
            "sensors": {"points": ["drive"], "directions": ["x", "y"]},
            "shape_line": {"direction": "x"},
        },
    }


def checked(data):
    """The configuration that passes every check. Raises ConfigError or Refused."""
    config = check_config(data, "made")
    found = check_model(config)
    if found.problems:
        raise Refused("\n".join(found.problems))
    return config


def require_no_library_words(outcome):
    """A refusal is a sentence of this library."""
    if outcome[0] == "refused":
        assert not [word for word in LIBRARY_WORDS if word in outcome[1]], outcome[1]


def require_right_tube(config):
    """The reduced model against the full one."""
    model, (structure, _) = build_model(config), full_structure(config)
    assert np.isfinite(model.omega).all() and (model.omega >= 0.0).all()
    line = build_centreline(config.structure)
    allowed = free_rigid_motions(config.structure, line)
    assert np.sum(model.omega == 0.0) <= allowed
    # The round-off of a bending stiffness grows with the cube of the tube over its elements.
    ratio = line.length / np.diff(structure.node_arc_length).min()
    round_off = 1.0e-6 + EPSILON * ratio**3
    for row in model_accuracy(config):
        assert np.isfinite(row["full_Hz"])
        if np.isfinite(row["reduced_Hz"]) and row["full_Hz"] > 0.0:
            assert row["basis_error"] > -round_off, row
    rows = structure.contact_rows().reshape(-1, structure.dofs)
    if allowed == 0 and len(rows) and config.basis.attachment_shapes:
        moved = spsolve(structure.stiffness.tocsc(), rows.T).reshape(rows.T.shape)
        full = np.sum(rows * moved.T, axis=1)
        shapes = model.contact_shapes.reshape(model.modes, -1)
        reduced = np.sum((shapes / model.omega[:, None]) ** 2, axis=0)
        assert np.allclose(reduced, full, rtol=1e-4 + round_off, atol=1e-6 * full.max())


def test_generated_tubes_are_refused_or_right(reliability):
    tried = Tried()

    @given(tubes())
    def attempt(data):
        with folder_of_example() as folder:
            outcome = tried.add(guarded(lambda: checked(data), (ConfigError, Refused), [folder]))
        require_no_library_words(outcome)
        if outcome[0] == "right":
            require_right_tube(outcome[1])

    attempt()
    reliability.inputs("tubes: segments, ends, supports, mesh and basis", tried)


EIGENVALUES = powers(0.0, 8.0) | st.sampled_from([0.0, 0.0, -1.0e-3, -1.0, -1.0e4])


@st.composite
def matrices(draw):
    """Squared frequencies, and mass and stiffness that have them, in units of 1e-3 to 1e3."""
    size = draw(st.integers(1, 8))
    squares = np.sort(draw(st.lists(EIGENVALUES, min_size=size, max_size=size)))
    random = np.random.default_rng(draw(st.integers(0, 10**6)))
    motions = np.linalg.qr(random.normal(size=(size, size)))[0]
    units = 10.0 ** random.uniform(-1.5, 1.5, size)
    mixed = (np.eye(size) + 0.3 * random.uniform(-1.0, 1.0, (size, size)) / size) * units
    mass, stiffness = mixed.T @ mixed, mixed.T @ motions @ np.diag(squares) @ motions.T @ mixed
    dropped = draw(st.sampled_from([None, None, None, 0]))
    if dropped is not None:
        mass[dropped], mass[:, dropped] = 0.0, 0.0
    return squares, 0.5 * (mass + mass.T), 0.5 * (stiffness + stiffness.T), dropped is None


def of_matrices(folder, mass, stiffness):
    """The configuration of a structure of two matrices in a folder."""
    np.savez(folder / "mass.npz", mass=mass)
    np.savez(folder / "stiffness.npz", stiffness=stiffness)
    return {
        "study": "made",
        "structure": {
            "kind": "matrices",
            "mass": str(folder / "mass.npz"),
            "stiffness": str(folder / "stiffness.npz"),
            "points": {"tip": {"x": 0}},
        },
        "supports": [{"name": "stop", "point": "tip", "stiffness_N_per_m": 1.0e-2}],
        "damping": {"kind": "modal", "other_ratio": 0.01},
        "excitation": {"kind": "none"},
        "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-4], "seeds": 1},
        "record": {"duration_s": 1.0, "sampling_frequency_Hz": 2048},
    }


def without_first(mass, stiffness):
    """Squared frequencies where the first dof, without mass, follows the others."""
    beside = stiffness[1:, :1] / stiffness[0, 0]
    return linalg.eigvalsh(stiffness[1:, 1:] - beside * stiffness[:1, 1:], mass[1:, 1:])


def test_generated_matrices_are_refused_or_right(reliability):
    tried = Tried()

    @given(matrices())
    def attempt(made):
        squares, mass, stiffness, definite = made
        with folder_of_example() as folder:
            data = of_matrices(folder, mass, stiffness)
            outcome = tried.add(guarded(lambda: checked(data), (ConfigError, Refused), [folder]))
            require_no_library_words(outcome)
            unbounded = squares[0] < -1.0e-11 * np.abs(squares).max()
            if definite and unbounded:
                assert outcome[0] == "refused", squares
            elif definite and squares[0] >= 0.0:
                assert outcome[0] == "right" or "contracts" in outcome[1], outcome
            if outcome[0] == "refused":
                assert ".npz" in outcome[1]
            else:
                expected = squares if definite else without_first(mass, stiffness)
                found = build_model(outcome[1]).omega[: expected.size] ** 2
                assert np.allclose(found, expected, rtol=1e-6, atol=1e-9 * squares.max())

    attempt()
    reliability.inputs("mass and stiffness matrices with any eigenvalues", tried)
