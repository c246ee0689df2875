"""The modes of a tube in a flow with its supports open, closed and equivalent, in words."""

from vibroimpact.config.schema import Config
from vibroimpact.flow.stability import Stability, stability_of_states
from vibroimpact.study.cases import load_values

from .answer import EquivalentError
from .estimate import estimate_equivalent


def modes_in_flow(config: Config) -> str:
    """Return the mode that is nearest to growth at the highest velocity of `flow`, for each state
    of the supports.

    The equivalent k and c are those that the shipped law estimates at the largest load and the
    smallest gap of the grid; that state is left out if the law does not hold.
    """
    assert config.flow is not None, "there is a flow"
    states: dict[str, tuple[float | None, float]] = {"open": (0.0, 0.0), "closed": (None, 0.0)}
    load = max(load_values(config.grid))
    try:
        own = estimate_equivalent(config, load, min(config.grid.gap_m)).groups[0]
        name = f"equivalent to {load:g} N (estimated k {own.k.value:.3g} N/m)"
        states[name] = own.k.value, own.c.value
    except EquivalentError:
        pass
    highest = max(config.flow.velocity_m_per_s)
    told = [
        f"supports {name}: {_nearest(found, highest)}"
        for name, found in stability_of_states(config, states).items()
    ]
    return f"; in the flow at {highest:g} m/s with " + "; ".join(told)


def _nearest(found: Stability, velocity: float) -> str:
    """Return the mode nearest to growth at a velocity in m/s, the highest of all."""
    own = found.eigenvalues
    if own is None:
        row = found.worst(velocity, 0)
        if row is None:
            return "no mode along the force"
        ratio = f"V_eff / V_c {row.ratio_high:.3g}"
        return f"{row.frequency:.4g} Hz, damping {100.0 * row.damping_ratio:.3g} %, {ratio}"
    least = own.damping_ratio[-1].argmin()
    frequency, ratio = own.frequency[-1, least], 100.0 * own.damping_ratio[-1, least]
    grows = f"growth from {own.critical:.4g} m/s" if own.critical == own.critical else "no growth"
    return f"{frequency:.4g} Hz, damping {ratio:.3g} %, {grows}"
