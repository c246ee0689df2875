"""A whole discrepancy run without the workflow, for campaigns by the dozen or in a hurry: the files
are those of the workflow, and what exists is kept.
"""

import multiprocessing
from dataclasses import replace
from functools import partial
from pathlib import Path

from vibroimpact.config.reading import check_config
from vibroimpact.records import read_json

from . import jobs
from .bank import lacking
from .candidates import candidate_named
from .conclusion import conclude
from .cost import Meter, job_cost
from .dag import NULL_PARTS, screened_files
from .prepared import Prepared, prepare
from .run import Run


def run_campaign(
    values,
    campaign,
    folder,
    provenance,
    bank=None,
    tables=None,
    longest_s=None,
    quick=False,
    workers=1,
    without=frozenset(),
    for_all=False,
    draw=0,
):
    """Run a campaign file against a configuration in plain values; results as the workflow's in the
    folder.

    bank: folder of another campaign of the same model, loads and gaps, whose candidates'
    simulations serve this one if it holds all that is looked at; tables {name: LinearTable},
    likewise of its linear candidates, extended here; workers: processes; without: ids of effects
    that are not in the catalogue this time; for_all: this is to be such a bank, of every candidate
    and record that any campaign may ask for; draw: number of the draw of seeds.
    """
    folder, config = Path(folder), check_config(values, "model")
    prepared_file = folder / "prepared.json"
    if not prepared_file.is_file():
        with job_cost(prepared_file, "prepare"):
            prepare(
                config,
                campaign,
                longest_s,
                tables,
                without,
                for_all=for_all,
                draw=draw,
                quick=quick,
            ).write(prepared_file)
    prepared = Prepared.read(prepared_file)
    nulls = [folder / "null" / f"{part}.npz" for part in range(NULL_PARTS)]
    run = Run(config, str(campaign), folder, prepared, (), tuple(nulls), ())
    if run.refused:
        conclude(run, None, [], provenance, Meter("verdict"))
        return
    bank_nulls = [Path(bank) / "null" / file.name for file in nulls] if bank else []
    if bank_nulls and lacking(run.bench, run.records, bank_nulls[0]):
        bank, bank_nulls = None, []
    paths = screened_files(prepared.screened, folder, bank)
    run = replace(run, path_files=tuple(paths), bank_nulls=tuple(bank_nulls))
    _make(workers, {file: partial(jobs.null_part, run, part) for part, file in enumerate(nulls)})
    _make(workers, {file: partial(_path, run, file.stem, quick) for file in paths})
    screened = _kept(folder / "screening.json", lambda file: jobs.screening(run, file, quick))
    files = []
    for kind in ("finalists", "pairs"):
        chosen = (
            screened
            if kind == "finalists"
            else _kept(
                folder / "pairs.json",
                lambda file, files=files: jobs.pairs(run, list(files), screened, file, quick),
            )
        )
        made = {
            folder / kind / f"{name}.npz": partial(_finalist, run, name, chosen, quick)
            for name in chosen[kind]
        }
        _make(workers, made)
        files += made
    conclude(run, screened, files, provenance, Meter("verdict"), quick)


def _path(run, name, quick, file):
    jobs.candidate_path(run, candidate_named(name), file, quick)


def _finalist(run, name, chosen, quick, file):
    jobs.finalist(run, name, chosen, file, quick)


# stage by the folder that its jobs write to
STAGES = {"null": "null", "paths": "candidates", "finalists": "finalists", "pairs": "pairs"}

# {file: function}: inherited by forked processes, since what the functions hold is too large to be
# sent
SHARED: dict = {}


def _make(workers, makers):
    """Call every function of {file: function} whose file is not there yet with it, `workers` at a
    time.
    """
    SHARED.clear()
    SHARED.update({file: make for file, make in makers.items() if not file.is_file()})
    if workers == 1 or len(SHARED) < 2:
        for file in SHARED:
            _made(file)
        return
    with multiprocessing.get_context("fork").Pool(workers) as pool:
        pool.map(_made, SHARED, chunksize=1)


def _made(file):
    with job_cost(file, STAGES[file.parent.name]):
        SHARED[file](file)
    print(file, flush=True)


def _kept(file, make):
    """Return the content of a JSON file, made where it is not there."""
    if not file.is_file():
        with job_cost(file, file.stem):
            make(file)
    return read_json(file)
