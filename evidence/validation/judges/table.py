"""The Checks of all other codes that are installed."""

from dataclasses import dataclass, field

from evidence.validation.check import Check
from vibroimpact.reduction.reduced_model import build_model

from .impacts import Impacts, mesh_checks, mesh_rows, modes_checks, modes_rows
from .modes import calculix_checks, opensees_checks
from .poles import pyoma_checks, sdypy_checks, spectrum_checks
from .presence import JudgeAbsent


@dataclass
class Verdicts:
    """Results of the comparisons with other codes.

    checks: list of Check.
    absent: a sentence for each code that is not installed.
    impacts: {name: Impacts} and rows of the impact comparison, for the figure.
    """

    checks: list[Check] = field(default_factory=list)
    absent: list[str] = field(default_factory=list)
    impacts: dict[str, Impacts] = field(default_factory=dict)
    by_modes: list[dict] = field(default_factory=list)
    by_mesh: list[dict] = field(default_factory=list)

    def presence(self) -> str:
        """Return the text that lists the codes that were used and those that were absent."""
        spoke = sorted({check.case.removeprefix("judge ") for check in self.checks})
        return (
            "\n".join(
                [
                    f"Present: {', '.join(spoke)}.",
                    *(f"Absent: {sentence}." for sentence in self.absent),
                ]
            )
            + "\n"
        )


def all_verdicts(config) -> Verdicts:
    """Return the Verdicts of every code on the study's tube.

    config: of the default study.
    """
    model, verdicts = build_model(config), Verdicts()

    def impacts():
        by_modes, runs = modes_rows(config)
        by_mesh = mesh_rows(config)
        verdicts.by_modes, verdicts.by_mesh, verdicts.impacts = by_modes, by_mesh, runs
        return modes_checks(by_modes) + mesh_checks(by_mesh)

    judges = (
        lambda: opensees_checks(config),
        impacts,
        lambda: calculix_checks(config),
        lambda: sdypy_checks(model),
        lambda: pyoma_checks(model),
        lambda: spectrum_checks(model),
    )
    for judge in judges:
        try:
            verdicts.checks += judge()
        except JudgeAbsent as error:
            verdicts.absent += [str(error)] * (str(error) not in verdicts.absent)
    return verdicts
