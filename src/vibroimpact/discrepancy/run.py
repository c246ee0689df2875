"""A job's view of a discrepancy run: the model, the campaign, and what the jobs before it left."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from vibroimpact.config import check_config
from vibroimpact.discrepancy import jobs, store
from vibroimpact.discrepancy.prepared import Prepared, workbench


@dataclass(frozen=True)
class Run:
    """config: checked Config; campaign: file; folder of the results; prepared; candidates, paths: names and files; nulls, bank_nulls: files."""

    config: object
    campaign: str
    folder: Path
    prepared: Prepared
    candidates: tuple
    path_files: tuple
    nulls: tuple
    bank_nulls: tuple

    @classmethod
    def opened(cls, job):
        """Return the Run of a job's input and params, by their names in the rules."""
        prepared = Path(job.input.prepared)
        return cls(check_config(job.params.config, "model"), str(job.input.campaign), prepared.parent, Prepared.read(prepared),
                   tuple(job.params.get("candidates", ())), *(tuple(job.input.get(name, ())) for name in ("paths", "null", "bank_null")))  # fmt: skip

    @property
    def refused(self):
        """Return whether the campaign can not be tested."""
        return self.prepared.refusal is not None

    @cached_property
    def bench(self):
        """Return the Workbench."""
        return workbench(self.config, self.campaign, self.prepared)

    @cached_property
    def null(self):
        """Return the Null."""
        return store.null_from(self.bench, self.nulls)

    @cached_property
    def paths(self):
        """Return {Candidate: Path} of what was screened."""
        bank = store.null_from(self.bench, self.bank_nulls) if self.bank_nulls else None
        return jobs.known_paths(dict(zip(self.candidates, self.path_files, strict=True)), self.null, bank)
