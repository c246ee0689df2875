"""F4 to F8 and F12: one mode in a flow, by eigenvalues, by the describing function and in time.

0.6 kg/m, 30 Hz, 1 % damping, in water of 1000 kg/m³ across 20 mm; C_D 0.3, slope of the lift -20,
delay D/V. References: closed forms, and integrations of the same equations by a solver.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.integrate import solve_ivp
from scipy.linalg import solve_continuous_lyapunov
from scipy.optimize import brentq

from evidence.validation.check import Check
from vibroimpact.config.flow import ConnorsForce, NegativeDamping, QuasiSteady
from vibroimpact.config.reading import changed_config, load_config
from vibroimpact.config.schema import Config
from vibroimpact.excitation.fluid_elastic import FluidForce, fluid_force
from vibroimpact.flow.coupled import (
    ModelInFlow,
    Zone,
    critical_velocity,
    describing_stiffness,
    oscillations,
    system,
)
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.study.cases import all_cases
from vibroimpact.study.simulation import simulate_cases

DENSITY, DIAMETER, GAP = 1000.0, 0.02, 1.0e-3
HIGHEST = 3.0  # m/s, up to which a critical velocity is looked for
CRITICAL, CONNORS = 0.682912, 0.552596  # m/s: of one lag, and of Connors' law with K = 3
ONE_LAG = fluid_force(
    QuasiSteady(kind="quasi_steady", lift_slope=-20.0, drag=0.3, delay=1.0), DIAMETER
)
FROZEN = NegativeDamping(kind="negative_damping", constant=3.0, frequency_Hz=30.0)
LAGGED = ConnorsForce(kind="connors", constant=3.0, band_Hz=(6.0, 150.0))
CYCLES_MM = {1.1: (1.1484, 1.1563), 1.3: (1.4254, 1.4436), 1.5: (1.8590, 1.8820)}
NET_RATIO = -0.02  # of F7 and F8
STEPS = 81_920  # per second, of F8
SEPARATRIX_MM = 2.98625  # 4 F / (pi c omega) of 2 N
# F12: the lags' stiffness rises with the logarithm of the frequency, by 2/pi of their negative
# damping. At 0.8 V_c that counts as 2/pi 0.64 zeta more mass.
DRIFT = 2.0 / np.pi * 0.64 * 0.01
RISE = 5.0 / 3.0
EXACT, SOLVED = "closed form", "integrated by a solver"
TIGHT, WIDE = 2.0e-3, 1.0e-2  # tolerances


def oscillator(folder: Path, **changes: Any) -> tuple[Config, ModalModel]:
    """Return (Config, ModalModel) of f6_limit_cycle with keys changed; "__" stands for a dot."""
    values = {key.replace("__", "."): value for key, value in changes.items()}
    config = changed_config(load_config(folder / "f6_limit_cycle.yaml"), values)
    return config, build_model(config)


def in_flow(model: ModalModel, force: FluidForce, velocity: float) -> ModalModel:
    """Return the model with a force on 1 m of tube that moves with the mass, at m/s."""
    shapes = np.sqrt(0.5 * DENSITY) * model.contact_shapes[:, 0, :1]
    return replace(model, fluid_shapes=shapes, fluid_laws=force.laws(np.array([velocity])))


def matrices(model: ModalModel) -> tuple[np.ndarray, np.ndarray, list[Zone]]:
    """Return (stiffness, damping, zones) of coupled.system without contact."""
    motion = model.contact_shapes[:, 0, :1]
    overlap = [Zone(1.0, 0.5 * DENSITY * motion @ motion.T)]
    return np.diag(model.omega**2), np.diag(model.damping), overlap


def eigenvalue_checks(folder: Path) -> list[Check]:
    """Return the Checks of F4 and F5; folder: of the reference configurations."""
    stiff, drag, zones = matrices(oscillator(folder)[1])

    def at(velocity: float) -> tuple[float, float]:
        found = oscillations(system(stiff, drag, ONE_LAG, zones, velocity), 1)
        return float(found[0][0]), float(found[1][0])

    ours = critical_velocity(stiff, drag, ONE_LAG, zones, HIGHEST)
    checks = [
        Check("F4", "critical velocity, one lag", "m/s", CRITICAL, EXACT, ours, TIGHT),
        Check("F4", "frequency at onset", "Hz", 30.10339, EXACT, at(ours)[0], TIGHT),
    ]
    for velocity, ratio in ((0.65, 0.00210036), (0.80, -0.00929546)):
        name = f"damping ratio at {velocity:.2f} m/s"
        checks.append(Check("F4", name, "1", ratio, EXACT, at(velocity)[1], TIGHT))
    for name, law in (("frozen", FROZEN), ("by lags", LAGGED)):
        own = critical_velocity(stiff, drag, fluid_force(law, DIAMETER), zones, HIGHEST)
        name = f"critical velocity, damping of Connors' law {name}"
        checks.append(Check("F5", name, "m/s", CONNORS, EXACT, own, TIGHT))
    return checks


def white_noise_checks(folder: Path) -> list[Check]:
    """Return the Checks of F12: RMS under white noise at 0.8 V_c over that without flow."""
    stiff, drag, zones = matrices(oscillator(folder)[1])

    def rise(law: Any) -> float:
        variances = []
        for velocity in (0.0, 0.8 * CONNORS):
            matrix = system(stiff, drag, fluid_force(law, DIAMETER), zones, velocity)
            noise = np.zeros(matrix.shape)
            noise[1, 1] = 1.0
            variances.append(solve_continuous_lyapunov(matrix, -noise)[0, 0])
        return float(np.sqrt(variances[1] / variances[0]))

    name, lagged = "RMS at 0.8 V_c over that without flow", rise(LAGGED)
    drifting = "closed form with the drift of stiffness of a causal force"
    plain = "closed form without drift of stiffness; a causal force is 0.2 % below"
    return [
        Check("F12", f"{name}, frozen", "1", RISE, EXACT, rise(FROZEN), TIGHT),
        Check("F12", f"{name}, by lags", "1", RISE / np.sqrt(1 + DRIFT), drifting, lagged, TIGHT),
        Check("F12", f"{name}, by lags", "1", RISE, plain, lagged, 2.5e-3),
    ]


def stop_checks(folder: Path) -> list[Check]:
    """Return the Checks of F6: the limit cycle of one lag between elastic stops."""
    _, model = oscillator(folder)
    tube = ModelInFlow(in_flow(model, ONE_LAG, 1.0), ONE_LAG, 1.0, HIGHEST)
    checks = []
    for over, (first_harmonic, integrated) in CYCLES_MM.items():
        velocity = over * CRITICAL
        found = 1e3 * amplitude_where(partial(_beyond, tube, velocity))
        name = f"amplitude at {over:g} V_c"
        named = f"{name}, describing function"
        timed = 1e3 * last_amplitude(folder, ONE_LAG, velocity)
        checks += [
            Check("F6", named, "mm", first_harmonic, "describing function", found, TIGHT),
            Check("F6", f"{name}, in time", "mm", integrated, SOLVED, timed, WIDE),
        ]
    return checks


def _beyond(tube: ModelInFlow, velocity: float, size: float) -> float:
    """Return by how much the velocity of a cycle of an amplitude in m exceeds another, m/s."""
    return tube.limit_cycle(GAP, size) - velocity


def net_damping(model: ModalModel) -> tuple[FluidForce, float, float]:
    """Return (force, velocity in m/s, damping c in N s/m) that leave NET_RATIO; c is positive."""
    force, mass = fluid_force(FROZEN, DIAMETER), 1.0 / float(model.contact_shapes[0, 0, 0]) ** 2
    left = -2.0 * NET_RATIO * mass * float(model.omega[0])
    taken = left + mass * float(model.damping[0])
    return force, float(np.sqrt(taken / (-0.5 * DENSITY * force.frozen_damping))), left


def friction_checks(folder: Path) -> list[Check]:
    """Return the Checks of F7: growth over six cycles from either side of the separatrix."""
    slider = {
        "name": "slider",
        "point": "mass",
        "direction": [1.0, 0.0, 0.0],
        "slip_limit_N": 2.0,
        "stick_stiffness_N_per_m": 2.0e7,
    }
    force, velocity, _ = net_damping(oscillator(folder)[1])

    def growth(start: float) -> float:
        changes = {"elements": [slider], "record__duration_s": 0.3, **from_rest_at(start)}
        found = peaks(run(folder, force, velocity, {**changes, "supports__gap_m": 1.0}))
        return float(found[12] / found[2] - 1.0)

    start = 1e3 * brentq(growth, 0.9e-3 * SEPARATRIX_MM, 1.1e-3 * SEPARATRIX_MM, xtol=1e-7)
    checks = [Check("F7", "separatrix", "mm", SEPARATRIX_MM, EXACT, start, TIGHT)]
    for share, sign in ((0.97, -1.0), (1.03, 1.0)):
        ours = float(np.sign(growth(1e-3 * share * SEPARATRIX_MM)))
        name = f"sign of the growth from {share:g} of the separatrix"
        checks.append(Check("F7", name, "1", sign, EXACT, ours, 0.0))
    return checks


def damped_stop_checks(folder: Path) -> list[Check]:
    """Return the Checks of F8: stops of 0.2 k and 5 c.

    The contacts of the library only push. A stop that may pull is made of a contact with much more
    stiffness and an element that takes it away again, a negative spring with a dead zone.
    """
    _, model = oscillator(folder)
    force, velocity, c = net_damping(model)
    k = float(model.omega[0] / model.contact_shapes[0, 0, 0]) ** 2
    tube = ModelInFlow(in_flow(model, force, velocity), force, velocity, HIGHEST)

    def beyond(size: float) -> float:
        share = describing_stiffness(GAP, np.array([size]))
        return tube.critical(0.2 * k * share, 5.0 * c * share)[0] - velocity

    # the damper of a contact takes a step to build up
    fine = {"integration__steps_per_second": STEPS, **from_rest_at(1.3e-3)}
    stop = {"supports__damping_N_s_per_m": 5.0 * c, **fine}
    much = 100.0 * k
    returned = {
        "name": "returned",
        "point": "mass",
        "direction": [1.0, 0.0, 0.0],
        "stiffness_N_per_m": -much,
        "saturation_stiffness_N_per_m": much,
        "saturation_limit_N": much * GAP,
    }
    pulls = {**stop, "supports__stiffness_N_per_m": 0.2 * k + much, "elements": [returned]}
    pushes = {**stop, "supports__stiffness_N_per_m": 0.2 * k}
    found = 1e3 * amplitude_where(beyond)
    pulling, pushing = (
        1e3 * last_amplitude(folder, force, velocity, own) for own in (pulls, pushes)
    )
    solved = [solved_cycle(k, c, least) for least in (-np.inf, 0.0)]
    name = "amplitude, stops that may pull"
    return [
        Check("F8", f"{name}, describing function", "mm", 1.4555, EXACT, found, TIGHT),
        Check("F8", f"{name}, in time", "mm", 1.4513, SOLVED, pulling, WIDE),
        Check("F8", f"{name}, in time", "mm", 1e3 * solved[0], "SciPy", pulling, WIDE),
        Check("F8", "amplitude, stops that push only", "mm", 1.70, SOLVED, pushing, WIDE),
        Check(
            "F8", "amplitude, stops that push only", "mm", 1e3 * solved[1], "SciPy", pushing, WIDE
        ),
    ]


def solved_cycle(k: float, c: float, least: float) -> float:
    """Return the amplitude in m of F8 by SciPy; least: of the force of a stop in N."""
    mass = k / (2.0 * np.pi * 30.0) ** 2

    def rate(_: float, state: np.ndarray) -> list[float]:
        place, speed = state
        side, depth = np.sign(place), abs(place) - GAP
        push = max(0.2 * k * depth + 5.0 * c * speed * side, least) if depth > 0.0 else 0.0
        return [speed, (c * speed - k * place - side * push) / mass]

    found = solve_ivp(rate, (0.0, 4.0), [1.3e-3, 0.0], rtol=1e-7, atol=1e-10, max_step=5e-4)
    return float(np.abs(found.y[0][found.t > 3.5]).max())


def from_rest_at(start: float) -> dict[str, Any]:
    """Return the change of the configuration that starts the mass at rest at a place in m."""
    return {"initial": {"displacement_m": {"mass": {"x": start}}}}


def run(folder: Path, force: FluidForce, velocity: float, changes: Mapping[str, Any]) -> np.ndarray:
    """Return (sample,) m of a run in a flow at m/s."""
    config, model = oscillator(folder, **changes)
    moving = in_flow(model, force, velocity)
    ((_, record),) = simulate_cases(config, moving, all_cases(config.grid))
    return _motion(record)


def _motion(record: xr.Dataset) -> np.ndarray:
    """Return (sample,) m of the contact."""
    return record["contact_displacement"].values[0, 0]


def last_amplitude(
    folder: Path, force: FluidForce, velocity: float, changes: Mapping[str, Any] | None = None
) -> float:
    """Return the mean amplitude in m over the last eighth of a run."""
    motion = run(folder, force, velocity, changes or {})
    return float(np.mean(peaks(motion[-len(motion) // 8 :])))


def peaks(values: np.ndarray) -> np.ndarray:
    """Return (peak,) the local maxima of |values|, each on the parabola through three samples."""
    size = np.abs(values)
    inner = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:])) + 1
    before, at, after = (size[inner + shift] for shift in (-1, 0, 1))
    return at + (after - before) ** 2 / (8.0 * (2.0 * at - before - after))


def amplitude_where(balance: Callable[[float], float]) -> float:
    """Return the amplitude in m between 1.02 and 3 gaps at which a balance is 0."""
    return float(brentq(balance, 1.02 * GAP, 3.0 * GAP, xtol=1e-9))
