"""The evidence of a diagnosis: the holding force by channel and band, the law that the records
demand next to the model's, and the prediction of a sensor that is left free.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr
from scipy.signal import resample_poly

from vibroimpact.integration.held_run import hold

from .bench import Bench, in_band, lane_of, sampled_motion, settled
from .comparison import Comparison
from .explanations import Point
from .law import Demand, Places, demand_of, element_force, places_of
from .measurement.sensed_motion import STRAIN
from .measurement.sensor_chain import Measuring
from .measurement.stretches import Stretch

STATES = ("before", "after")
SERIES = ("measured", *STATES)
HOLDING_BANDS = 10  # logarithmic, over the band of the lines
MOST_FREE = 96  # runs with a sensor left free, of both states
LAW_STRETCHES = 3
WAVEFORM_S, CYCLES = 0.25, 25  # of a waveform, at most
FINER = 4  # times the sampling of the runs, as a waveform is drawn
PLACES = (  # of a campaign: positions and directions of its channels and forces
    "force_channel_name",
    *(f"{role}_{key}" for role in ("channel", "force_channel") for key in ("point", "direction")),
)
ACTS = 0.3  # of the power of the sensors: not explained by the drive alone


class HeldState:
    """Runs of one Point on the stretches of a Bench; the first runs are those with all held.

    free: [(stretch, channel)] of the further runs, with one channel left free. records: of the
    channels, then the Places. Raises ConfigError or ValueError for values that no structure can
    have.
    """

    def __init__(self, bench: Bench, point: Point, free: Sequence[tuple[int, int]]):
        model, chain = bench.structure.held_model(point), bench.structure.measuring(point)
        self.bench, self.model, self.chain = bench, model, chain
        self.places = places_of(model)
        # the places are further sensors that are not held
        count = len(self.places.names)
        more = ((0, count), (0, 0))
        observed = replace(
            model,
            sensor_shapes=np.hstack([model.sensor_shapes, self.places.shapes]),
            sensor_names=(*model.sensor_names, *self.places.names),
            sensor_positions=np.pad(model.sensor_positions, more, mode="edge"),
            sensor_directions=np.pad(model.sensor_directions, more, mode="edge"),
        )
        through = Measuring(
            np.r_[chain.gain, np.ones(count)], np.r_[chain.delay, np.zeros(count)], chain.force_gain
        )
        stretches = tuple(
            replace(each, motion=np.pad(each.motion, ((0, 0), (0, count))))
            for each in bench.stretches
        )
        wide = replace(bench, stretches=stretches)
        lanes = [lane_of(wide, stretch, observed, through) for stretch in stretches]
        lanes += [
            lane_of(wide, stretches[at], observed, through, [channel]) for at, channel in free
        ]
        self.records = hold(lanes, bench.schedule, bench.threads, bench.held_below_Hz)
        self.free = {key: len(stretches) + number for number, key in enumerate(free)}

    def at_places(self, stretch: int) -> np.ndarray:
        """Return (2, place, sample): force in N and motion in m with all sensors held."""
        motion = self.records.motion[stretch, len(self.chain.gain) :].astype(float)
        supports = 2 * len(self.model.support_names)
        force = np.zeros_like(motion)
        force[:supports] = self.records.support_force[stretch, :supports]
        rate = self.bench.schedule.sampling_frequency
        for element, moved in enumerate(motion[supports:]):
            force[supports + element] = element_force(self.model.local_laws, element, moved, rate)
        return np.stack([force, motion])

    def left_free(self, stretch: int, channel: int) -> np.ndarray:
        """Return (2, sample) m: the measured motion of a channel with its delay removed, and the
        motion of the model with it left free, as it would be measured.
        """
        measured = sampled_motion(self.bench, stretch, self.chain.delay)[channel]
        free = self.records.motion[self.free[stretch, channel], channel].astype(float)
        return np.stack([measured, self.chain.gain[channel] * free])


def evidence_of(comparison: Comparison, before: Point, after: Point) -> xr.Dataset:
    """Return the evidence for two Points: the model as given, and the completed one.

    holding_force (state, stretch, channel, band): RMS in N.
    demanded_force, demanded_motion (law_stretch, place, sample) and model_force, model_motion
        (state, ..): N and m in the band; resolution (law_stretch, place) and explained, beyond
        (law_stretch,): see law.Demand. Absent if the structure has no support and no element.
    free_error (state, free_stretch, channel): of a predicted velocity over its RMS.
    waveform (series, moment): of the channel `waveform_channel` in the stretch `waveform_stretch`.
        Absent if fewer than two channels measure a motion.

    Raises ConfigError or ValueError for values that no structure can have.
    """
    fitted, apart = comparison.fitted(), comparison.apart()
    bench = replace(fitted, stretches=(*fitted.stretches, *apart.stretches))
    free = _left_free(bench, len(fitted.stretches))
    states = [HeldState(bench, point, free) for point in (before, after)]
    campaign = comparison.structure.campaign
    places = {name: campaign[name].variable for name in PLACES if name in campaign}
    return xr.Dataset(
        _names(comparison, bench, len(fitted.stretches))
        | places
        | _holding(bench, states)
        | _law(comparison, bench, states, after)
        | _free(comparison, bench, states),
        coords={"state": list(STATES), "series": list(SERIES)},
        attrs={
            "before": before.name,
            "after": after.name,
            "strength_N_s_per_m": float(bench.strength),
        },
    )


def _names(comparison, bench, fitted):
    """Return the variables that name channels and stretches."""
    signals, rows = comparison.signals, bench.stretches
    held_out = set(signals.holdout().tolist())
    texts = {
        "channel_name": ("channel", comparison.structure.names),
        "channel_kind": ("channel", signals.kinds),
        "record_name": ("stretch", [str(signals.record_names[row.record]) for row in rows]),
        "split": ("stretch", ["holdout" if row.record in held_out else "fit" for row in rows]),
        "part": ("stretch", ["fitted" if at < fitted else "apart" for at in range(len(rows))]),
    }
    return {name: (dim, np.array(values, object)) for name, (dim, values) in texts.items()} | {
        "load": ("stretch", [row.load for row in rows], {"units": signals.load_unit}),
        "start": ("stretch", [_start(bench, row) for row in rows], {"units": "s"}),
    }


def _start(bench: Bench, stretch: Stretch) -> float:
    """Return the time in s of the sample of its record at which a stretch begins."""
    rate = bench.schedule.sampling_frequency
    return round(stretch.start_s * rate) / rate


def _left_free(bench: Bench, fitted: int) -> list[tuple[int, int]]:
    """Return [(stretch, channel)] to be left free: channels that move in the unfitted stretches of
    the highest and the lowest load, up to MOST_FREE runs.
    """
    order = sorted(range(fitted, len(bench.stretches)), key=lambda at: -bench.stretches[at].load)
    held = bench.measures_motion
    out: list[tuple[int, int]] = []
    for number in dict.fromkeys([order[0], order[-1]]):
        moving = np.flatnonzero(bench.stretches[number].moving & held)
        if len(STATES) * (len(out) + len(moving)) <= MOST_FREE or not out:
            out += [(number, int(channel)) for channel in moving]
    return out if held.sum() > 1 else []


def _holding(bench: Bench, states: list[HeldState]) -> dict:
    """Return the RMS of the settled samples of the holding force with all held by band, as a
    residual of the measured motion.
    """
    inside, rows = settled(bench), []
    for state in states:
        gain = state.chain.gain[:, None]
        force = state.records.force[: len(bench.stretches), : len(gain)]
        rows.append((force.astype(float) * gain)[..., inside])
    series, count = np.stack(rows), len(inside)
    window = np.hanning(count)
    power = 2.0 * np.abs(np.fft.rfft(series * window, axis=-1)) ** 2 / (count * np.sum(window**2))
    edges = np.geomspace(*bench.band, HOLDING_BANDS + 1)
    frequency = np.fft.rfftfreq(count, 1.0 / bench.schedule.sampling_frequency)
    number = np.searchsorted(edges, frequency, side="right") - 1
    bands = [power[..., number == band].sum(axis=-1) for band in range(HOLDING_BANDS)]
    return holding_force(np.sqrt(np.stack(bands, axis=-1)).astype(np.float32), edges)


def holding_force(found: np.ndarray, edges: np.ndarray) -> dict:
    """Return the variables of the holding force (state, stretch, channel, band) in N; edges (band +
    1,): Hz.
    """
    return {
        "holding_force": (("state", "stretch", "channel", "band"), found, {"units": "N"}),
        "band_low": ("band", edges[:-1], {"units": "Hz"}),
        "band_high": ("band", edges[1:], {"units": "Hz"}),
    }


def _law(comparison: Comparison, bench: Bench, states: list[HeldState], point: Point) -> dict:
    """Return the law demanded by the records, on a Point's linear structure, and of both states."""
    places = states[-1].places
    if not places.names:
        return {}
    demands = [demand_of(comparison, bench, stretch, point) for stretch in bench.stretches]
    chosen = _acting(bench, demands)
    shown = [demands[number] for number in chosen]
    model = np.stack([_modelled(comparison.band, state, places, chosen) for state in states])
    dims = ("law_stretch", "place")
    demanded = np.array([(row.force, row.motion) for row in shown], np.float32).swapaxes(0, 1)
    time = settled(bench) / bench.schedule.sampling_frequency
    out = law_against_motion(places.names, places.owners, chosen, demanded, model)
    out["sample_time"] = "sample", time, {"units": "s"}
    for name, rank in (("resolution", 2), ("explained", 1), ("beyond", 1)):
        share = np.array([getattr(row, name) for row in shown])
        out[name] = dims[:rank], share, {"units": "1"}
    return out


def law_against_motion(
    names: Sequence[str],
    owners: Sequence[str],
    chosen: Sequence[int],
    demanded: np.ndarray,
    model: np.ndarray,
) -> dict:
    """Return the variables of the force in N against the motion in m at places of chosen stretches:
    demanded (2, law_stretch, place, sample), and of the model (state, 2, ..).
    """
    dims = ("law_stretch", "place", "sample")
    out: dict = {
        "place_name": ("place", np.array(names, object)),
        "owner_name": ("place", np.array(owners, object)),
        "law_of_stretch": ("law_stretch", np.array(chosen, int)),
    }
    for part, (name, unit) in enumerate((("force", "N"), ("motion", "m"))):
        out[f"demanded_{name}"] = dims, demanded[part], {"units": unit}
        out[f"model_{name}"] = ("state", *dims), model[:, part], {"units": unit}
    return out


def _acting(bench: Bench, demands: list[Demand]) -> list[int]:
    """Return the stretches whose law is shown: the lowest load at which forces other than the drive
    act, at which the law is sharpest, then a middle and the highest load; one per load.
    """
    order = sorted(range(len(demands)), key=lambda number: bench.stretches[number].load)
    first = {bench.stretches[number].record: number for number in reversed(order)}
    order = [number for number in order if first[bench.stretches[number].record] == number]
    acting = [number for number in order if demands[number].beyond > ACTS] or order[-1:]
    places = np.linspace(0, len(acting) - 1, min(LAW_STRETCHES, len(acting))).round().astype(int)
    return [acting[place] for place in places]


def _modelled(band, state: HeldState, places: Places, chosen: list[int]) -> np.ndarray:
    """Return (2, law_stretch, place, sample): force in N and motion in m of a held model within a
    band in Hz; NaN at places that it lacks.
    """
    rows = [in_band(state.bench, state.at_places(number), band, 0) for number in chosen]
    found = np.stack(rows, axis=1).astype(np.float32)
    lacking = np.full((*found.shape[:2], 1, found.shape[-1]), np.nan, found.dtype)
    own = {name: number for number, name in enumerate(state.places.names)}
    return np.concatenate([found, lacking], axis=2)[:, :, [own.get(n, -1) for n in places.names]]


def _free(comparison: Comparison, bench: Bench, states: list[HeldState]) -> dict:
    """Return the errors of predicted sensors, and the waveform of the one that improves most."""
    keys = list(states[0].free)
    if not keys:
        return {}
    stretches = sorted({number for number, _ in keys}, key=lambda at: -bench.stretches[at].load)
    error = np.full((len(states), len(stretches), len(comparison.structure.names)), np.nan)
    velocity = {}
    for number, channel in keys:
        before, after = (
            in_band(bench, state.left_free(number, channel), comparison.band, 1) for state in states
        )
        velocity[number, channel] = np.array([before[0], before[1], after[1]])
        rms = max(float(np.std(before[0])), np.finfo(float).tiny)
        error[:, stretches.index(number), channel] = [
            np.std(measured - predicted) / rms for measured, predicted in (before, after)
        ]
    # the prediction that gains most in the stretch of the highest load; the worst if none gains
    given, completed = np.nan_to_num(error[:, 0])
    gain = np.minimum(given, 2.0) - np.minimum(completed, 2.0)
    told = stretches[0], int(np.argmax(gain if gain.max() > 0.0 else completed))
    unit = "1/s" if comparison.signals.kinds[told[1]] == STRAIN else "m/s"
    return {
        "free_error": (("state", "free_stretch", "channel"), error, {"units": "1"}),
        "free_of_stretch": ("free_stretch", np.array(stretches, int)),
        **_waveform(bench, velocity[told], told, unit, comparison.structure.scale[told[1]]),
    }


def _waveform(bench, series, told, unit, scale):
    """Return the waveform around the largest response; series (3, sample): m/s."""
    rate = FINER * bench.schedule.sampling_frequency
    series = resample_poly(series, FINER, 1, axis=-1)
    crossings = np.mean(np.diff(np.signbit(series[0])))  # per sample
    cycles = round(2.0 * CYCLES / max(float(crossings), 1.0e-9))
    count = min(round(WAVEFORM_S * rate), cycles, series.shape[-1])
    power = np.convolve(series[0] ** 2, np.ones(count), "valid")
    first = int(np.argmax(power))
    inside = slice(first, first + count)
    start = _start(bench, bench.stretches[told[0]]) + settled(bench)[0] * FINER / rate
    time = start + np.arange(first, first + count) / rate
    return {
        "waveform": (("series", "moment"), series[:, inside] / scale, {"units": unit}),
        "moment_time": ("moment", time, {"units": "s"}),
        "waveform_stretch": ((), told[0]),
        "waveform_channel": ((), told[1]),
    }
