"""A job's view of a discrepancy run: the model, the campaign, and what the jobs before it left."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from vibroimpact.config.reading import check_config

from . import store
from .bank import Source, known_paths
from .candidates import candidate_named
from .prepared import Prepared, workbench


@dataclass(frozen=True)
class Run:
    """config: checked Config; campaign: file; folder of the results; prepared; path_files:
    <candidate>.npz of those that are screened, in this folder or a bank's; nulls, bank_nulls:
    files.
    """

    config: object
    campaign: str
    folder: Path
    prepared: Prepared
    path_files: tuple
    nulls: tuple
    bank_nulls: tuple

    @classmethod
    def opened(cls, job):
        """Return the Run of a job's input and params, by their names in the rules."""
        prepared = Path(job.input.prepared)
        return cls(
            check_config(job.params.config, "model"),
            str(job.input.campaign),
            prepared.parent,
            Prepared.read(prepared),
            *(tuple(job.input.get(name, ())) for name in ("paths", "null", "bank_null")),
        )

    @property
    def refused(self):
        """Return whether the campaign can not be tested."""
        return self.prepared.refusal is not None

    @cached_property
    def bench(self):
        """Return the Workbench."""
        return self._bench(self.prepared.compared_s)

    @cached_property
    def screening_bench(self):
        """Return the Workbench of the seconds that are screened."""
        return self.bench if self.screened_as_compared else self._bench(self.prepared.screened_s)

    @cached_property
    def whole_bench(self):
        """Return the Workbench of whole records."""
        return self._bench(self.prepared.longest_s)

    @property
    def records(self):
        """Return (record,): those whose features are compared; the lowest one is read by its modes
        where it can be, and compared in a bank for campaigns where it can not.
        """
        bench = self.screening_bench  # a job that screens has no other
        records = np.arange(len(bench.signals.load))
        return (
            records[records != bench.signals.lowest]
            if bench.reads_lowest and not self.prepared.for_all
            else records
        )

    @property
    def screened_as_compared(self):
        """Return whether screening looks at all that is compared."""
        return self.prepared.screened_s == self.prepared.compared_s

    @cached_property
    def null(self):
        """Return the Null."""
        return store.null_from(self.bench, self.nulls)

    @cached_property
    def screening_null(self):
        """Return the Null of the seconds that are screened."""
        return (
            self.null
            if self.screened_as_compared
            else store.null_from(self.screening_bench, self.nulls, "screened_")
        )

    @property
    def screened_elsewhere(self):
        """Return whether a bank's candidates stand in for those beside a linear effect that was
        adopted here: a contact damping that gains 275 beside nine times the damping of all modes
        loses 64 as the bank's, with the nominal damping, has it.
        """
        return (
            bool(self.bank_nulls)
            and self.prepared.adopted is not None
            and not candidate_named(self.prepared.adopted["name"]).effect.measured
        )

    def simulated_here(self, candidate):
        """Return whether what was screened of a Candidate are runs of this campaign over all that
        is compared, not moved here from elsewhere.
        """
        return self.screened_as_compared and replace(candidate, alone=False).name in self._own

    @cached_property
    def screened_paths(self):
        """Return {Candidate: Path} of what was screened."""
        return self._paths(self.screening_bench, self.screening_null)

    @cached_property
    def paths(self):
        """Return {Candidate: Path} of what was screened, moved to all that is compared."""
        return self._paths(self.bench, self.null)

    def _bench(self, seconds):
        return workbench(self.config, self.campaign, self.prepared, seconds)

    def _paths(self, bench, null):
        """Return {Candidate: Path}, brought from the screened seconds, and from the bank what is of
        it, to a Workbench and its Null.
        """
        files = {
            Path(file).stem: file for file in self.path_files if Path(file).stem not in self._own
        }
        found = (
            known_paths(
                files, Source(bench, null, self.bank_nulls, "screened_", True), self.prepared
            )
            if files
            else {}
        )
        return found | known_paths(
            self._own,
            (
                None
                if null is self.screening_null
                else Source(bench, null, self.nulls, "screened_", False)
            ),
            self.prepared,
        )

    @cached_property
    def _own(self):
        """Return {candidate name: file} of what was screened by runs of this campaign."""
        return {
            Path(file).stem: file
            for file in self.path_files
            if Path(file).parents[1] == self.folder
        }
