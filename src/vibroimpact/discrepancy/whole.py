"""A whole discrepancy run in one process, job after job, for campaigns by the dozen: the files are those of the workflow, and what exists is kept."""

from pathlib import Path

from vibroimpact.config import check_config
from vibroimpact.discrepancy import jobs
from vibroimpact.discrepancy.candidates import candidate_named
from vibroimpact.discrepancy.conclusion import conclude
from vibroimpact.discrepancy.dag import NULL_PARTS, local_names
from vibroimpact.discrepancy.prepared import Prepared, prepare
from vibroimpact.discrepancy.run import Run


def run_campaign(values, campaign, folder, provenance, bank=None, tables=None, longest_s=None, quick=False, say=print, without=frozenset()):
    """Run a campaign file against a configuration in plain values; results as the workflow's in the folder.

    bank: folder of another campaign of the same model, loads and gaps, whose candidates' simulations serve this one; tables {name: LinearTable}, likewise
    of its linear candidates, extended here; without: ids of effects that are not in the catalogue this time.
    """
    folder, config = Path(folder), check_config(values, "model")
    prepared_file = folder / "prepared.json"
    if not prepared_file.is_file():
        prepare(config, campaign, longest_s, tables, without).write(prepared_file)
    prepared, names = Prepared.read(prepared_file), [name for name in local_names(values) if name.split("@")[0] not in without]
    nulls = [folder / "null" / f"{part}.npz" for part in range(NULL_PARTS)]
    paths = [Path(bank or folder) / "paths" / f"{name}.npz" for name in names]
    bank_nulls = [Path(bank) / "null" / file.name for file in nulls] if bank else []
    run = Run(config, str(campaign), folder, prepared, tuple(names), tuple(paths), tuple(nulls), tuple(bank_nulls))
    if run.refused:
        conclude(run, None, [], provenance)
        return
    for part, file in enumerate(nulls):
        if not file.is_file():
            jobs.null_part(run.bench, part, file)
    for name, file in zip(names, paths, strict=True):
        if not file.is_file():
            jobs.candidate_path(run.bench, candidate_named(name), prepared.scales, file, quick)
            say(f"{folder.name}: {name}")
    screened = _kept(folder / "screening.json", lambda file: jobs.screening(run, file, quick))
    files = []
    for kind, chosen in (("finalists", screened["finalists"]), ("pairs", None)):
        if chosen is None:
            chosen = _kept(folder / "pairs.json", lambda file: jobs.pairs(run, list(files), screened, file, quick))["pairs"]
        for name, unit in chosen.items():
            file = folder / kind / f"{name}.npz"
            if not file.is_file():
                jobs.finalist(run, name, unit, file, quick)
                say(f"{folder.name}: {kind} {name}")
            files.append(file)
    conclude(run, screened, files, provenance, quick)


def _kept(file, make):
    """Return the content of a JSON file, made where it is not there."""
    if not file.is_file():
        make(file)
    return jobs.read_json(file)


