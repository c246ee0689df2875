"""A tube with gaps in flows of rising velocity, and the linear tubes that stand for it.

Each run has one turbulent load and one velocity. It starts at rest, or with a motion of several
gaps: if the two differ, the tube has two ways to vibrate. Runs under the turbulence alone give k
and c of each support; with them the eigenvalues have the critical velocity that the equivalent
linear tube predicts. If the turbulence follows the velocity there is such a run at each.
"""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import product
from typing import Any, cast

import numpy as np
import xarray as xr

from vibroimpact.config.reading import changed_config
from vibroimpact.config.schema import Config
from vibroimpact.excitation.fluid_elastic import FluidLaws, fluid_force
from vibroimpact.excitation.turbulence import load_of_spectrum
from vibroimpact.flow.coupled import ModelInFlow
from vibroimpact.flow.stability import NoFlow
from vibroimpact.geometry.sections import outer_width
from vibroimpact.identify.secant import secant_support
from vibroimpact.integration.batch import BatchResult, integrate_batch
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.integration.preload import seated

from .cases import Case, load_values
from .in_process import reduced_model
from .simulation import drive_of_lanes, imperfection, record_dataset, schedule_of, seed_forces

STARTS = {"small": 0.0, "large": 3.0}  # gaps that the lowest mode would reach without stops
ONSET = 1.25  # times the response without flow: beyond the scatter of a record, 7 to 14 %
AMPLITUDES = np.array([1.02, 1.05, 1.1, 1.2, 1.35, 1.5, 1.75, 2.0, 2.5, 3.0])  # of cycles, in gaps
SEARCHED = 3.0  # times the highest velocity, up to which critical velocities are sought


@dataclass(frozen=True)
class FlowRun:
    """One run, in SI units; an infinite response if it grew without bound.

    load: of the grid. start: small or large. rms: of the point of the shape line that moves most.
    contact_fraction: of the support that is touched most. wear_work_rate: of all supports.
    fluid_power: from the flow. force_rms: of the turbulence. coupled: whether the fluid-elastic
    force acts.
    """

    load_rms_N: float
    gap_m: float
    velocity_m_per_s: float
    start: str
    seed: int
    rms_m: float
    contact_fraction: float
    wear_work_rate_W: float
    fluid_power_W: float
    force_rms_N: float
    coupled: bool


@dataclass(frozen=True)
class Equivalent:
    """The linear tube of the turbulence at a velocity, 0 if it is the same at all.

    k, c: of a support under the turbulence alone, the mean over the supports. critical: velocity
    with k and c of each; NaN if there is none.
    """

    load_rms_N: float
    gap_m: float
    velocity_m_per_s: float
    force_rms_N: float
    k_N_per_m: float
    c_N_s_per_m: float
    critical_m_per_s: float


@dataclass(frozen=True)
class Onset:
    """Velocities in m/s at one load and gap, NaN if there is none in the range.

    k, c: of the Equivalent, at its critical velocity. open, equivalent, closed: critical velocities
    of the linear tube with no supports, with k and c, and with contact stiffnesses. small, large:
    at which the runs that start so leave the response to the turbulence alone.
    """

    load_rms_N: float
    gap_m: float
    k_N_per_m: float
    c_N_s_per_m: float
    open_m_per_s: float
    equivalent_m_per_s: float
    closed_m_per_s: float
    small_m_per_s: float
    large_m_per_s: float


@dataclass(frozen=True)
class Cycle:
    """A limit cycle by the describing function: amplitude of the support that moves most."""

    gap_m: float
    amplitude_m: float
    velocity_m_per_s: float


@dataclass(frozen=True)
class FlowSweep:
    """All runs, the predictions of the linear tubes, and the limit cycles without turbulence."""

    runs: tuple[FlowRun, ...]
    onsets: tuple[Onset, ...]
    equivalents: tuple[Equivalent, ...]
    cycles: tuple[Cycle, ...]

    def tables(self) -> dict[str, list[dict[str, Any]]]:
        """Return {name of the table: rows}."""
        return {
            "flow_runs": [asdict(run) for run in self.runs],
            "flow_onset": [asdict(onset) for onset in self.onsets],
            "flow_equivalent": [asdict(own) for own in self.equivalents],
            "flow_cycles": [asdict(cycle) for cycle in self.cycles],
        }


def flow_sweep(config: Config) -> FlowSweep:
    """Return the FlowSweep over the velocities of `flow` and the loads, gaps and seeds of the grid.

    Raises NoFlow without flow.coupling, IntegrationError.
    """
    flow = config.flow
    if flow is None or flow.coupling is None:
        raise NoFlow(
            f"study '{config.study}' has no flow.coupling: give the fluid-elastic force, as"
            " {kind: quasi_steady, lift_slope: -20, drag: 0.3}"
        )
    highest = max(flow.velocity_m_per_s)
    config = changed_config(config, {"flow.acting_m_per_s": highest})
    model, structure = reduced_model(config), cast(Any, config.structure)
    force = fluid_force(flow.coupling, outer_width(structure.section))
    tube = ModelInFlow(model, force, highest, SEARCHED * highest)
    runs: list[FlowRun] = []
    onsets: list[Onset] = []
    equivalents: list[Equivalent] = []
    for load, gap in product(load_values(config.grid), config.grid.gap_m):
        batches = [
            own
            for seed in range(config.grid.seeds)
            for start in STARTS
            for own in _runs(config, tube, Case(load, gap, seed), start)
        ]
        own_runs = [run for run, _ in batches]
        tubes = _equivalents(tube, [pair for pair in batches if not pair[0].coupled])
        runs, equivalents = runs + own_runs, equivalents + tubes
        onsets.append(_onset(tube, own_runs, tubes))
    cycles = tuple(
        Cycle(gap, amplitude, tube.limit_cycle(gap, amplitude))
        for gap in config.grid.gap_m
        for amplitude in (gap * AMPLITUDES).tolist()
    )
    return FlowSweep(tuple(runs), tuple(onsets), tuple(equivalents), cycles)


def _runs(
    config: Config, tube: ModelInFlow, case: Case, start: str
) -> Iterator[tuple[FlowRun, xr.Dataset]]:
    """Yield (FlowRun, record) of one load, gap, seed and start at each velocity; the turbulence
    alone first.
    """
    model, schedule = tube.model, schedule_of(config)
    channels = model.drive_shapes.shape[1]
    forces, lanes = {}, _lanes(config)
    grid = seed_forces(config, schedule, case.seed, channels)
    for velocity in {lane[0] for lane in lanes}:
        own, share = at_velocity(config, velocity)
        streams = grid if own is config else seed_forces(own, schedule, case.seed, channels)
        forces[velocity] = streams, share * case.load_rms_N
    moving = replace(model, initial_velocity=_push(model, STARTS[start] * case.gap_m))
    for first in range(0, len(lanes), LANES):
        batch = lanes[first : first + LANES]
        offset = np.stack([imperfection(config, model, case)] * len(batch), axis=-1)
        gaps = np.full(len(batch), case.gap_m)
        offset, rest = seated(model, schedule, gaps, offset)
        drive = drive_of_lanes([forces[velocity] for velocity, _ in batch])
        line = _LineSquares(model.sensor_shapes.shape[1])

        def integrate(laws, gaps=gaps, offset=offset, drive=drive, rest=rest, line=line):
            line.restart()
            return integrate_batch(moving, schedule, gaps, offset, drive, line.add, rest, laws)

        rising = model.fluid_laws.velocity / tube.acting
        laws = [tube.force.laws(rising * velocity * coupled) for velocity, coupled in batch]
        result, grown = _bounded(integrate, laws)
        for lane, (velocity, coupled) in enumerate(batch):
            force_rms = forces[velocity][1]
            own_case = replace(case, load_rms_N=force_rms)
            record = record_dataset(config, model, schedule, result, lane, own_case)
            rms = np.inf if lane in grown else line.rms(lane)
            place = case.load_rms_N, case.gap_m, velocity, start, case.seed
            tallies = _tallies(record, bool(np.isfinite(rms)))
            yield FlowRun(*place, rms, *tallies, force_rms, coupled), record


def _lanes(config: Config) -> list[tuple[float, bool]]:
    """Return (velocity in m/s, whether the fluid-elastic force acts) of the runs."""
    flow = cast(Any, config.flow)
    velocities = sorted(flow.velocity_m_per_s)
    alone = [0.0] if flow.turbulence is None else velocities
    return [(own, False) for own in alone] + [(own, True) for own in velocities]


def at_velocity(config: Config, velocity: float) -> tuple[Config, float]:
    """Return (configuration with the spectrum of the force at a velocity in m/s, force RMS there
    over the load of the grid).

    Both are those of the grid if flow.turbulence is null.
    """
    rule, force = cast(Any, config.flow).turbulence, cast(Any, config.excitation)
    if rule is None:
        return config, 1.0
    if rule.kind == "power":
        return config, float((velocity / rule.at_m_per_s) ** rule.exponent)
    moved = changed_config(config, {"excitation.spectrum.velocity_m_per_s": velocity})
    loads = [load_of_spectrum(config.structure, own) for own in (moved.excitation, force)]
    return moved, loads[0] / loads[1]


class _LineSquares:
    """Sums of squares of the motion along the shape line, whose channels follow the sensors."""

    def __init__(self, sensors: int) -> None:
        self.sensors = sensors
        self.restart()

    def restart(self) -> None:
        """Forget all."""
        self.sum: Any = 0.0
        self.samples = 0

    def add(self, _first: int, displacement: np.ndarray, *_: np.ndarray) -> None:
        """Take a piece (case, channel, sample) in m."""
        line = displacement[:, self.sensors :].astype(float)
        self.sum = self.sum + np.einsum("cps,cps->cp", line, line)
        self.samples += line.shape[-1]

    def rms(self, case: int) -> float:
        """Return the RMS in m of the point that moves most."""
        return float(np.sqrt(self.sum[case].max() / self.samples))


def _bounded(integrate: Any, laws: list[FluidLaws]) -> tuple[BatchResult, set[int]]:
    """Return (result, lanes that grew without bound); these run without flow then."""
    grown: set[int] = set()
    while True:
        try:
            return integrate(laws), grown
        except IntegrationError as error:
            if error.case is None or error.case in grown:
                raise
            grown.add(error.case)
            own = laws[error.case]
            still = {name: np.zeros_like(values) for name, values in vars(own).items()}
            laws = [*laws[: error.case], FluidLaws(**still), *laws[error.case + 1 :]]


def _push(model: Any, amplitude: float) -> np.ndarray:
    """Return (mode,) modal rates from which the lowest mode that the flow moves would reach an
    amplitude in m at the support that moves most.
    """
    rates = np.zeros(model.modes)
    moved = np.any(model.fluid_shapes != 0.0, axis=1) & (model.omega > 0.0)
    lowest = int(np.flatnonzero(moved)[0])
    most = np.linalg.norm(model.contact_shapes[lowest], axis=-1).max(initial=0.0)
    if most > 0.0:
        rates[lowest] = model.omega[lowest] * amplitude / most
    return rates


def _tallies(record: xr.Dataset, bounded: bool) -> tuple[float, float, float]:
    """Return (contact fraction, wear work rate in W, power of the flow in W); NaN if unbounded."""
    if not bounded:
        return np.nan, np.nan, np.nan
    contact = float(record["contact_fraction"].max())
    return contact, float(record["wear_work_rate"].sum()), float(record["fluid_power"])


def _equivalents(
    tube: ModelInFlow, alone: Sequence[tuple[FlowRun, xr.Dataset]]
) -> list[Equivalent]:
    """Return the Equivalent of each velocity; alone: runs under the turbulence alone."""
    made = []
    for velocity in sorted({run.velocity_m_per_s for run, _ in alone}):
        here = [pair for pair in alone if pair[0].velocity_m_per_s == velocity]
        found = [
            [secant_support(each, tube.model, own) for own in tube.supports] for _, each in here
        ]
        k = np.nanmean([[own.k for own in row] for row in found], axis=0)
        c = np.nanmean([[own.c for own in row] for row in found], axis=0)
        first = here[0][0]
        place = first.load_rms_N, first.gap_m, velocity, first.force_rms_N
        made.append(Equivalent(*place, float(k.mean()), float(c.mean()), tube.critical(k, c)[0]))
    return made


def _onset(tube: ModelInFlow, runs: list[FlowRun], tubes: list[Equivalent]) -> Onset:
    """Return the Onset of the runs at one load and gap."""
    none = np.zeros(len(tube.supports))
    still, closed = tube.critical(none, none)[0], tube.critical(tube.held, none)[0]
    starts = [onset_of([run for run in runs if run.start == start]) for start in STARTS]
    equivalent = equivalent_onset(tubes)
    velocities = [own.velocity_m_per_s for own in tubes]
    at = velocities[-1] if np.isnan(equivalent) else equivalent
    k = float(np.interp(at, velocities, [own.k_N_per_m for own in tubes]))
    c = float(np.interp(at, velocities, [own.c_N_s_per_m for own in tubes]))
    return Onset(tubes[0].load_rms_N, tubes[0].gap_m, k, c, still, equivalent, closed, *starts)


def equivalent_onset(tubes: Sequence[Equivalent]) -> float:
    """Return the velocity in m/s that is critical for the k and c of the turbulence there,
    interpolated; NaN if the range has none.
    """
    if len(tubes) == 1:
        return tubes[0].critical_m_per_s
    velocities, critical = (
        np.array([getattr(own, name) for own in tubes])
        for name in ("velocity_m_per_s", "critical_m_per_s")
    )
    unstable = np.flatnonzero(critical <= velocities)
    if not unstable.size:
        return float("nan")
    last = int(unstable[0])
    if last == 0:
        return float(critical[0])
    if not np.isfinite(critical[last - 1]):
        return float(velocities[last])
    pair = slice(last - 1, last + 1)  # a constant V_c is met exactly
    excess = np.log(velocities / critical)[pair]
    return float(np.exp(np.interp(0.0, excess, np.log(velocities[pair]))))


def onset_of(runs: Sequence[FlowRun]) -> float:
    """Return the velocity in m/s at which the response is ONSET times that to the turbulence alone:
    the median over seeds, interpolated; NaN if it never is.
    """

    def median(coupled: bool) -> dict[float, float]:
        found: dict[float, list[float]] = {}
        for run in sorted(runs, key=lambda run: run.velocity_m_per_s):
            if run.coupled == coupled:
                found.setdefault(run.velocity_m_per_s, []).append(run.rms_m)
        return {velocity: float(np.median(rms)) for velocity, rms in found.items()}

    alone, moved = median(False), median(True)
    velocities = np.array([0.0, *moved])
    follows = 0.0 not in alone
    ratio = np.array([1.0, *(rms / alone[own * follows] for own, rms in moved.items())])
    over = np.flatnonzero(ratio > ONSET)
    if not over.size:
        return float("nan")
    last = over[0]
    if not np.isfinite(ratio[last]):
        return float(velocities[last])
    levels = np.log(ratio[last - 1 : last + 1])
    return float(np.interp(np.log(ONSET), levels, velocities[last - 1 : last + 1]))
