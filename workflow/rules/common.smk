# The checked configuration, the names of all files, and the functions that give rules their
# inputs and params.
import os
import re
import shlex
import sys
from dataclasses import asdict
from pathlib import Path

SOURCE = os.path.relpath(Path(workflow.basedir, "src"))
SCRIPTS = os.path.relpath(Path(workflow.basedir, "workflow", "scripts"))
EXAMPLES = os.path.relpath(Path(workflow.basedir, "examples"))
PYTHON = shlex.quote(sys.executable)
sys.path.insert(0, SOURCE)
# Jobs inherit these: the library needs no installation, and -j jobs use one thread each.
os.environ.update(
    PYTHONPATH=os.path.abspath(SOURCE),
    OMP_NUM_THREADS="1",
    OPENBLAS_NUM_THREADS="1",
    MKL_NUM_THREADS="1",
    NUMBA_NUM_THREADS="1",
)

from vibroimpact.study.cases import (
    all_cases,
    ids_of_load,
    load_values,
    loads_by_half_decade,
    nearest_loads,
    value_text,
)
from vibroimpact.completion.store import read_values
from vibroimpact.completion.structure_file import read_structure
from vibroimpact.completion.study import laws_to_fit
from vibroimpact.config.reading import ConfigError, check_config, load_config, read_yaml
from vibroimpact.discrepancy.dag import (
    NULL_PARTS,
    SUITE_NAME,
    SUITE_S,
    finalist_names,
    frozen_seed,
    numbers_added,
    numbers_judged,
    pair_names,
    screened_files,
    screened_names,
    shard_of,
    suite_name,
)
from vibroimpact.discrepancy.suite_check import CHECKS
from vibroimpact.provenance import imported_files
from vibroimpact.config.stage_keys import stage_params

FIGURES = {
    "model": (
        "figure_01_layout",
        "figure_02_free_modes",
        "figure_03_contact_law",
        "figure_04_first_frequency",
        "basis_quality",
    ),
    "response": (
        "figure_05_overlay",
        "figure_06_levels",
        "figure_07_overlay_of_loads",
        "figure_08_load_and_stiffness",
        "in_plane_share",
    ),
    "identification": (
        "figure_09_poles",
        "figure_09_stabilisation",
        "figure_10_shapes",
        "figure_11_singular_values",
        "figure_12_broadband",
    ),
    "checks": ("figure_13_equivalent_support", "collapse", "energy_balance", "contact_statistics"),
}


# Values of --config that are not keys of the study.
REQUEST = {
    name: str(config.pop(name))
    for name in (
        "import",
        "campaign",
        "model",
        "quick",
        "bank",
        "suite_seed",
        "count",
        "shard",
        "add",
        "seconds",
        "compared_s",
        "draw",
        *(f"{folder.name}_data" for folder in sorted(Path(EXAMPLES).glob("*/"))),
    )
    if name in config
}


def number_asked(name):
    """The number of --config name=NUMBER, None where it is not given.

    Exits with a sentence where it is not a positive number.
    """
    try:
        value = float(REQUEST[name]) if name in REQUEST else None
    except ValueError:
        value = -1
    if value is not None and not value > 0:
        sys.exit(
            f"{name} = '{REQUEST[name]}': give a positive number, as in --config {name}={1 if name == 'draw' else 49}"
        )
    return value


LOOKED_AT = Path(REQUEST.get("campaign", "campaign")).stem
DISCREPANCY = f"results/{LOOKED_AT}"
COMPARED_S = number_asked("compared_s")
DRAW = int(number_asked("draw") or 0)
QUICK = REQUEST.get("quick", "no") not in ("no", "False", "false", "0")


def requested(name, example):
    """The path of --config name=PATH, as an input function.

    Exits with a sentence where it is not given or does not exist.
    """

    def path(wildcards):
        if not os.path.exists(REQUEST.get(name, "")):
            sys.exit(
                f"{name} = '{REQUEST.get(name, '')}' is not there: give it as in --config {name}={example}"
            )
        return REQUEST[name]

    return path


def checked_config():
    """The Config of the files and --config values given to snakemake.

    Exits with a sentence for every problem before any job is planned.
    """
    files = [os.path.relpath(file) for file in workflow.configfiles]
    try:
        for file in files:
            read_yaml(file)
        return check_config(config, " + ".join(files))
    except ConfigError as error:
        sys.exit(str(error))


def checked_model():
    """The Config of the model that a campaign is compared with.

    It is that of --config model=FILE, or the study's where none is given.
    """
    try:
        return load_config(REQUEST["model"]) if "model" in REQUEST and OWN is None else STUDY
    except ConfigError as error:
        sys.exit(str(error))


def own_structure():
    """The StructureFile of --config model=FILE if its modes are to be identified, else None."""
    try:
        return read_structure(REQUEST["model"]) if "model" in REQUEST else None
    except ConfigError as error:
        sys.exit(str(error))


STUDY = checked_config()
OWN = own_structure()
if OWN is not None and QUICK:
    sys.exit(
        f"quick = '{REQUEST['quick']}': a structure that is identified from its campaign has no quick mode: leave it out, or narrow band_Hz and candidates"
    )
MODEL = checked_model()
RESULTS = f"results/{STUDY.study}"
CASES = [case.id for case in all_cases(STUDY.grid)]
KEPT = STUDY.record.keep_time_series or STUDY.record.every_step  # time series
CASES_PER_LOAD = len(CASES) // len(load_values(STUDY.grid))


def library(script):
    """The library files that a script imports; an edit reruns only the stages that import it."""
    return library_of(f"{SCRIPTS}/{script}.py")


def library_of(program):
    """The library files that a program imports."""
    return [str(file) for file in imported_files(program, SOURCE)]


def settings(stage):
    """The part of the configuration that a stage uses."""
    return stage_params(STUDY, stage)


def files_of_load(folder, suffix="nc"):
    """The files of the cases of wildcard {load}, one per gap and seed."""
    return [f"{RESULTS}/{folder}/{case}.{suffix}" for case in ids_of_load(STUDY.grid, "{load}")]


def files_of_loads(folder, loads, suffix="nc"):
    """The files of the cases of some loads."""
    return [
        f"{RESULTS}/{folder}/{case}.{suffix}"
        for load in loads
        for case in ids_of_load(STUDY.grid, load)
    ]


def files_of_study(folder, suffix="nc"):
    """The files of all cases."""
    return [f"{RESULTS}/{folder}/{case}.{suffix}" for case in CASES]


def series_of_load():
    """The time series that a simulation writes.

    There are none where the study neither keeps them nor identifies anything from them.
    """
    return files_of_load("timeseries") if KEPT or STUDY.identification is not None else []


def figure_files(group):
    """The files of a group of figures."""
    return [
        f"{RESULTS}/figures/{name}.{suffix}"
        for name in FIGURES[group]
        for suffix in ("png", "pdf", "csv", "txt")
    ]


def jobs_of_study():
    """The names of the benchmark files and logs of the jobs of a complete study."""
    loads = [value_text(load) for load in load_values(STUDY.grid)]
    jobs = ["basis", *(f"simulate_load_{load}" for load in loads)]
    if STUDY.identification is None:
        jobs.append("statistics")
    else:
        jobs += [f"spectra_load_{load}" for load in loads] if KEPT else []
        jobs += [f"identify_{start}" for start in loads_by_half_decade(STUDY.grid)]
        jobs += ["consistency", *(f"figures_{group}" for group in FIGURES)]
        jobs += ["synthetic_campaign"] if not STUDY.overlay.campaign else []
    return jobs


# Campaigns whose structure is identified from their records: {name of the folder of results:
# (campaign file, StructureFile)}.
COMPLETED = {LOOKED_AT: (REQUEST.get("campaign", ""), OWN)} if OWN is not None else {}


def complete(name, campaign, model):
    """Complete a campaign file with the structure of a YAML file, in results/<name>/.

    A campaign of that name given by --config goes first.
    """
    if "campaign" not in REQUEST or name != LOOKED_AT:
        COMPLETED[name] = (campaign, read_structure(model))


def downloaded(key, default, pattern, what):
    """The files in the folder that --config key=FOLDER gives, as an input.

    The run stops with a sentence where there are none.
    """

    def paths(wildcards):
        folder = REQUEST.get(key, default)
        found = sorted(Path(folder).glob(pattern))
        if not found:
            shown = pattern.replace("*", "<N>").replace("?", "u")
            sys.exit(
                f"{key} = '{folder}' holds no file {shown}: download {what} from"
                f" nonlinearbenchmark.org and give its folder: --config {key}=FOLDER"
            )
        return [str(file) for file in found]

    return paths


def campaign_completed(wildcards):
    """The campaign file of wildcard {structure}; a sentence where --config names one that is not
    there.
    """
    if wildcards.structure == LOOKED_AT and OWN is not None:
        return requested("campaign", "FILE")(wildcards)
    return COMPLETED[wildcards.structure][0]


def structure_completed(wildcards):
    """What is stated of the structure of wildcard {structure}."""
    return asdict(COMPLETED[wildcards.structure][1])


def law_files(structure, kind):
    """The files of a structure's "candidates", or of "additions" to the best of them."""
    prepared = checkpoints._completion_prepare.get(structure=structure).output.study
    return [
        f"results/{structure}/{kind}/{name}.json"
        for name in laws_to_fit(read_values(prepared), kind)
    ]


def candidate_files(wildcards):
    """The files of all single candidates of wildcard {structure}."""
    return law_files(wildcards.structure, "candidates")


def addition_files(wildcards):
    """The files of all second effects tried with the best candidate of wildcard {structure}."""
    return law_files(wildcards.structure, "additions")


def path_files(wildcards):
    """The files of the candidates that are screened, after the linear stage."""
    names = screened_names(checkpoints._discrepancy_prepare.get().output.prepared)
    return [str(file) for file in screened_files(names, DISCREPANCY, BANK)]


def finalist_files(wildcards):
    """The files of the finalists of the screening."""
    names = finalist_names(checkpoints._discrepancy_screening.get().output.screening)
    return [f"{DISCREPANCY}/finalists/{name}.npz" for name in names]


def pair_files(wildcards):
    """The files of the pairs of effects to simulate."""
    return [
        f"{DISCREPANCY}/pairs/{name}.npz"
        for name in pair_names(checkpoints._discrepancy_pairs.get().output.pairs)
    ]


def targets():
    """The files of a complete study: tables, figures, and time series where they are kept.

    Without an identification: statistics of every case, and time series where they are kept.
    """
    series = files_of_study("timeseries") if KEPT else []
    if STUDY.identification is None:
        return [f"{RESULTS}/statistics.csv", *series]
    figures = [file for group in FIGURES for file in figure_files(group)]
    tables = [
        f"{RESULTS}/{name}"
        for name in (
            "consistency.csv",
            "consistency_summary.csv",
            "consistency_collapse.csv",
            "consistency.nc",
        )
    ]
    return [*tables, *figures, *series]


wildcard_constraints:
    law=r"[a-z_]+\.[A-Za-z0-9_-]+",
    load=r"[0-9.e+-]+",


def suite_campaigns(suite, added):
    """The numbers of the campaigns to judge.

    They are those of the shard that are not in the campaigns.csv files `added`; with count=judged,
    those that have a verdict.
    """
    count = REQUEST.get("count", "12")
    try:
        known = numbers_added(added, Path(suite).name)
        numbers = (
            numbers_judged(suite)
            if count == "judged"
            else shard_of(count, REQUEST.get("shard", "0/1"))
        )
    except ValueError as problem:
        sys.exit(str(problem))
    return [number for number in numbers if number not in known]


def plain_verdicts(seed, suite, campaigns):
    """The verdicts of the plain suite of the same seed, as an input function.

    Exits with a sentence where `suite` is the plain one itself.
    """

    def paths(wildcards):
        plain = f"results/{suite_name(seed)}"
        if suite == plain:
            sys.exit(
                "suite_difference compares with the plain suite: say what is other, as in --config seconds=49 or draw=1"
            )
        return [f"{plain}/campaign_{number:04d}/verdict.json" for number in campaigns]

    return paths
