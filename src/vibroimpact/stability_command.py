"""The command `vibroimpact stability`: its arguments, its output and its files.

The library is imported when the command runs, so that `--help` answers at once.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .config.schema import Config
    from .flow.stability import Eigenvalues, Stability, StabilityRow

SIMULATED = (
    "load",
    "gap",
    "k",
    "V_c open",
    "V_c with k and c",
    "V_c closed",
    "onset from rest",
    "onset from a large motion",
)
HEADER: tuple[str, ...] = (
    "velocity",
    "not holding",
    "mode",
    "f",
    "zeta",
    "V_eff",
    "V_c",
    "V_eff / V_c",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("config", metavar="FILE", help="a configuration with a section flow")
    parser.add_argument(
        "--stiffness",
        type=float,
        metavar="N_PER_M",
        help="stiffness of a support that holds, such as the equivalent k of `vibroimpact"
        " equivalent` (default: its contact stiffness)",
    )
    parser.add_argument(
        "--damping",
        type=float,
        default=0.0,
        metavar="N_S_PER_M",
        help="damping of a support that holds, such as the equivalent c (default: 0)",
    )
    parser.add_argument(
        "--inactive",
        type=int,
        choices=(0, 1, 2),
        default=1,
        help="so many supports at most do not hold, in every combination (default: 1)",
    )
    parser.add_argument(
        "--simulate",
        action="store_true",
        help="simulate the tube with its gaps at every velocity too, and print the velocity at"
        " which its response leaves that without flow, and the critical velocities of equivalent"
        " linear tubes (needs flow.coupling)",
    )
    parser.add_argument(
        "--out", metavar="DIR", help="write stability.csv, eigenvalues.csv and the figure there"
    )
    parser.set_defaults(command=run)


def run(options: argparse.Namespace) -> int:
    """Run the command. Return 1 if there is no answer."""
    from .config.problems import ConfigError
    from .config.reading import load_config
    from .flow.stability import NoFlow, stability
    from .integration.contact_convergence import IntegrationError

    try:
        for name in ("stiffness", "damping"):
            value = getattr(options, name)
            if value is not None and not 0.0 <= value < 1e15:
                raise NoFlow(f"--{name} {value:g} must be between 0 and 1e15")
        config = load_config(options.config)
        found = stability(config, options.stiffness, options.damping, options.inactive)
        if options.out:
            _write(found, Path(options.out))
        sweep = _simulated(config, options.out) if options.simulate else []
    except (ConfigError, IntegrationError, NoFlow) as error:
        print(error, file=sys.stderr)
        return 1
    for warning in found.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    print("\n".join([as_text(found, options.inactive), *sweep]))
    return 0


def as_text(found: Stability, most: int) -> str:
    """Return the worst mode of each velocity as text, with up to `most` supports not holding."""
    cells: list[tuple[str, ...]] = [HEADER]
    for velocity in dict.fromkeys(row.velocity for row in found.rows):
        for inactive in range(most + 1):
            row = found.worst(velocity, inactive)
            if row is not None:
                cells.append(_cells(row))
    told = ["The mode nearest to instability:", *_aligned(cells), *_of_eigenvalues(found)]
    return "\n".join(told)


def _aligned(cells: list[tuple[str, ...]]) -> list[str]:
    """Return the lines of a table."""
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return ["  ".join(map(str.ljust, row, widths)).rstrip() for row in cells]


def _simulated(config: Config, folder: str | None) -> list[str]:
    """Return the lines of the tube with gaps; write its tables and figures into a folder."""
    from .io.records import write_table
    from .reports.figures.drawing import save_plots
    from .reports.figures.flow import flow_sweep_figures
    from .study.flow_sweep import flow_sweep

    found = flow_sweep(config)
    if folder:
        for name, rows in found.tables().items():
            write_table(rows, Path(folder) / f"{name}.csv")
        save_plots(flow_sweep_figures(found), folder)
    cells: list[tuple[str, ...]] = [SIMULATED]
    for own in found.onsets:
        speeds = (
            own.open_m_per_s,
            own.equivalent_m_per_s,
            own.closed_m_per_s,
            own.small_m_per_s,
            own.large_m_per_s,
        )
        cells.append(
            (
                f"{own.load_rms_N:g} N",
                f"{1e3 * own.gap_m:g} mm",
                f"{own.k_N_per_m:.3g} N/m",
                *(f"{speed:.3g}" if speed == speed else "-" for speed in speeds),
            )
        )
    return ["", "With its gaps, in m/s:", *_aligned(cells)]


def _of_eigenvalues(found: Stability) -> Iterator[str]:
    """Yield the result of the eigenvalues, with an empty line before."""
    own = found.eigenvalues
    if own is None:
        return
    yield ""
    if own.critical == own.critical:
        yield f"With the fluid-elastic force an eigenvalue grows from {own.critical:.4g} m/s on."
    else:
        yield f"With the fluid-elastic force no eigenvalue grows up to {own.searched:.4g} m/s."


def _cells(row: StabilityRow) -> tuple[str, ...]:
    """Return the texts of a row."""
    return (
        f"{row.velocity:g} m/s",
        row.inactive or "-",
        f"{row.mode} {row.direction}",
        f"{row.frequency:.4g} Hz",
        f"{100.0 * row.damping_ratio:.3g} %",
        f"{row.effective:.3g} m/s",
        _span(row.critical_low, row.critical_high) + " m/s",
        _span(row.ratio_low, row.ratio_high) + (" unstable" if row.ratio_low >= 1.0 else ""),
    )


def _span(low: float, high: float) -> str:
    """Return a range as text."""
    return f"{low:.3g}" if low == high else f"{low:.3g} to {high:.3g}"


def _write(found: Stability, folder: Path) -> None:
    """Write the tables and the figure."""
    from .io.records import write_table
    from .reports.figures.drawing import save_plots
    from .reports.figures.flow import stability_figure

    folder.mkdir(parents=True, exist_ok=True)
    write_table([row.table_row() for row in found.rows], folder / "stability.csv")
    if found.eigenvalues is not None:
        write_table(list(_eigenvalue_rows(found.eigenvalues)), folder / "eigenvalues.csv")
    save_plots([stability_figure(found)], folder)


def _eigenvalue_rows(own: Eigenvalues) -> Iterator[dict[str, float]]:
    """Yield the rows of eigenvalues.csv."""
    for velocity, *modes in zip(own.velocity, own.frequency, own.damping_ratio, strict=True):
        for mode, (frequency, ratio) in enumerate(zip(*modes, strict=True), 1):
            yield {
                "velocity_m_per_s": velocity,
                "mode": mode,
                "frequency_Hz": frequency,
                "damping_ratio": ratio,
            }
