"""From a campaign and a model to a verdict: every stage in order."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.effects.places import TURNED
from vibroimpact.linear_stage import priors
from vibroimpact.linear_stage.candidates import candidate_named
from vibroimpact.linear_stage.linear_analysis import prepare, workbench
from vibroimpact.linear_stage.prepared import Prepared
from vibroimpact.linear_stage.share_explained import share_explained
from vibroimpact.linear_stage.workbench import Workbench
from vibroimpact.run_cost import SIMULATED
from vibroimpact.stopwatch import Stopwatch

from . import alike, constants, race, screening, so_far, verdict
from .decision import Chosen, decide, something_else
from .effort import EFFORTS, Effort
from .gauss_newton import descend
from .linear_sets import linear_sets
from .null import null_of
from .probabilities import posterior
from .refused import write_refused
from .search import Search
from .two_effects import exchanged_too, parts_alone, seek_pairs
from .verification import Closing, closing, telling_record

LEADING = 3  # explanations whose likes are looked at too
OPEN = 0.3  # probability of something else, beside an explanation or alone, from which two effects
# are looked for
ROOM = 20.0  # of log evidence: two effects can gain no less than they cost
LEAST = 0.8  # chi-square per value of a model that explains a record
EXCHANGES = 3  # of the effects of leading pairs for what is like them


@dataclass
class Engine:
    """A checked Config against a campaign file; folder of the results; effort: a key of EFFORTS;
    seed of all draws; threads: runs at a time, of which no number depends. cost {stage: CPU
    seconds}, simulated {stage: records}.
    """

    config: object
    campaign: str
    folder: Path
    effort: str = "standard"
    seed: int = 0
    threads: int = 1
    cost: Stopwatch = field(default_factory=Stopwatch)
    simulated: dict = field(default_factory=dict)

    @property
    def spent(self) -> Effort:
        """Return the Effort."""
        return EFFORTS[self.effort]

    @property
    def spent_so_far(self) -> dict[str, Any]:
        """Return the `cost` of verdict.json."""
        return verdict.cost_rows(self.cost, self.simulated)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Count what a `with` block costs under the name of a stage."""
        known = SIMULATED["records"]
        with self.cost(name):
            yield
        self.simulated[name] = SIMULATED["records"] - known

    def run(self, provenance: dict[str, Any]) -> None:
        """Write verdict.json and what belongs to it into the folder."""
        with self.stage("linear stage"):
            prepared = prepare(self.config, self.campaign, draw=self.seed)
        if prepared.refusal is not None:
            write_refused(self.folder, prepared, provenance, self.spent_so_far)
            so_far.write_refusal(self.folder, prepared)
            return
        search, closed = self.null_stage(prepared), None
        if not (search.null.differs or prepared.other_structure):
            closed = self.verify(prepared, search)
            more = with_telling_record(prepared, closed)
            if more is not prepared:
                found = self.null_stage(more)
                # else what is not known of the sound model may explain that record
                if found.null.differs:
                    prepared, search, closed = more, found, None
        so_far.write(self.folder, search, prepared)
        if search.null.differs and not prepared.other_structure:
            self.search(search, prepared)
        null = search.null
        decision = decide(
            posterior(search),
            search.fits,
            search.estimate,
            linear_sets(prepared),
            float(null.measured @ null.measured),
            null.values,
            search.of_families(),
        )
        if prepared.other_structure:
            decision = something_else(decision)
        if closed is None or decision.chosen is not None:
            closed = self.verify(prepared, search, decision.chosen)
        verdict.write(
            self.folder, prepared, search, (decision, closed), self.spent_so_far, provenance
        )

    def verify(self, prepared: Prepared, search: Search, chosen: Chosen | None = None) -> Closing:
        """Return the Closing of what is Chosen, None for nothing."""
        with self.stage("verification"):
            given, whole = self.whole_benches(prepared)
            return closing(given, whole, search.bench, chosen, prepared.scales)

    def search(self, search: Search, prepared: Prepared) -> None:
        """Run explanations until what is missing is known, or nothing more is to be learned."""
        with self.stage("screening"):
            names = screening.first_explanations(screened(prepared))
            screening.screen(search, names, search.bench.values)
        so_far.write(self.folder, search, prepared)
        with self.stage("refinement"):
            self.refine(search)
            if self.spent.pairs and unexplained(search):
                race.look_wider(search, self.spent.pairs)
                search.look()
                if nothing_near(search):
                    return
                self.refine(search)
        with self.stage("two effects"):
            self.seek_pairs(search, prepared)

    def null_stage(self, prepared: Prepared) -> Search:
        """Return the Search with its Null."""
        with self.stage("null"):
            bench = workbench(self.config, self.campaign, prepared, self.spent.compared_s)
            records = bench.signals.fit()
            if bench.reads_lowest:
                records = records[records != bench.signals.lowest]
            null = null_of(bench, records, 0, self.threads)
        return Search(bench, null, prepared.scales, threads=self.threads, most=self.spent.steps)

    def refine(self, search: Search) -> None:
        """Run what may be the answer until it is known, its other places, what is like it and the
        other laws of its family too.
        """
        race.race(search, self.spent)
        search.look()
        leading = race.leaders(search, LEADING)
        values = search.bench.values
        new = [alike.similar_too(search, values, name) for name in leading]
        new += [alike.elsewhere_too(search, values, name) for name in leading[:1]]
        if any(new):
            race.race(search, self.spent)
        for name in race.leaders(search, 1):
            if alike.similar_too(search, values, name):
                race.race(search, self.spent)
        for name in race.leaders(search, 1):
            if alike.at_its_place(search, name):
                race.race(search, self.spent)
        if unexplained(search):
            self.turn(search)
        for name in race.leaders(search, 1):
            race.race(search, self.spent, laws=alike.laws_of(search, name))
        for name in race.leaders(search, 1):
            descend(search, name)
            race.race(search, self.spent)  # others may come as near

    def turn(self, search: Search) -> None:
        """Run what leads in other directions, and what may act in the one that is found."""
        for name in race.leaders(search, 1):
            if alike.turned_too(search, name):
                race.race(search, self.spent)
        for name in race.leaders(search, 1):
            if candidate_named(name).location == TURNED and alike.at_its_place(search, name):
                race.race(search, self.spent)

    def seek_pairs(self, search: Search, prepared: Prepared) -> None:
        """Look for two effects where one leaves room for a second."""
        if self.spent.pairs and unexplained(search):
            seek_pairs(search, prepared.room, seconds=self.spent.pairs)
            race.race(search, self.spent, pairs=True)
            for _ in range(EXCHANGES):
                leading = race.leaders(search, LEADING, pairs=True)
                new = [exchanged_too(search, name, prepared.room) for name in leading]
                search.look()
                race.race(search, self.spent, pairs=True)
                if not any(new):
                    break
            for name in race.leaders(search, LEADING, pairs=True):
                descend(search, name)
            for name in race.leaders(search, 1, pairs=True):
                parts_alone(search, name)
                race.race(search, self.spent)  # a part alone may be better than all so far
        search.look()

    def whole_benches(self, prepared: Prepared) -> tuple[Workbench, Workbench]:
        """Return (Workbench of the model as given, Workbench with what was adopted), of whole
        records.
        """
        whole = workbench(self.config, self.campaign, prepared)
        if prepared.adopted is None:
            return whole, whole
        bare = replace(prepared, adopted=None, fit=None)
        return workbench(self.config, self.campaign, bare), whole


def with_telling_record(prepared: Prepared, closed: Closing) -> Prepared:
    """Return the Prepared with the held-out record fitted too that disagrees most, itself where
    none does.
    """
    record = telling_record(closed)
    if record is None:
        return prepared
    row = check_row(
        "split",
        "warn",
        "The fitted records agree with the model, this held-out one does not: it is fitted too, and"
        " verified is on the other held-out records. Mark it as fit, and hold out one like it.",
        record=record,
    )
    return replace(prepared, fitted=[record], checks=[*prepared.checks, row])


def open_chance(search: Search) -> float:
    """Return the probability of something else, beside an explanation or alone."""
    return sum(
        np.exp(chance)
        for name, chance in posterior(search).items()
        if name == "something else" or name.endswith(constants.ELSE)
    )


def unexplained(search: Search) -> bool:
    """Return whether more is missing than what leads: something else is as probable, or it leaves
    more than what is named may leave, and there is log evidence left to gain.
    """
    null, leading = search.null, race.leaders(search, 3)
    nothing = float(null.measured @ null.measured)
    left = min((search.fits[name].left for name in leading), default=nothing)
    if 0.25 * (left - LEAST * null.values) < ROOM:
        return False
    explained = share_explained(left, nothing, null.values)
    return explained < priors.EXPLAINED or open_chance(search) > OPEN


def nothing_near(search: Search) -> bool:
    """Return whether no explanation takes as much of the chi-square beyond chance away as a part of
    what is missing does: such a part would be withdrawn, and two of them are not looked for.
    """
    before = float(search.null.measured @ search.null.measured)
    most = max((max(fit.takes, before - fit.left) for fit in search.fits.values()), default=0.0)
    share = share_explained(before - most, before, search.null.values)
    return share < 1.0 - priors.EXPLAINED


def screened(prepared: Prepared) -> list[str]:
    """Return the names of what is run: beside what the lowest record told, or in its place."""
    return [
        candidate.name
        for name in prepared.screened
        for candidate in prepared.beside_or_in_place(candidate_named(name))
    ] or prepared.screened
