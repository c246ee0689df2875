# The checked configuration, the names of all files, and the functions that give rules their
# inputs and params.
import os
import re
import sys
from pathlib import Path

SOURCE = os.path.relpath(Path(workflow.basedir, "src"))
SCRIPTS = os.path.relpath(Path(workflow.basedir, "workflow", "scripts"))
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
from vibroimpact.completion.study import STUDIES, study_of
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
    return [str(file) for file in imported_files(f"{SCRIPTS}/{script}.py", SOURCE)]


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


COMPLETION_FIGURES = ("frf_overlay", "prediction", "mounting", "where", "restoring_force")
MEASURED = {
    "f16": (
        "f16_data",
        STUDY.f16_data,
        "F16Data_FullMSine_Level*.mat",
        "the F-16 ground vibration test (Noel and Schoukens, 2017)",
    ),
    "silverbox": (
        "silverbox_data",
        STUDY.silverbox_data,
        "SNJP_?m_full_FNSI_*.mat",
        "the Silverbox records (Noel and Schoukens, 2017)",
    ),
}


def measured_files(wildcards):
    """The record files of wildcard {structure} in the configured folder."""
    return files_of_structure(wildcards.structure)


def files_of_structure(structure):
    """The record files of a structure in the configured folder."""
    key, folder, pattern, what = MEASURED[structure]
    found = sorted(Path(folder).glob(pattern))
    if not found:
        shown = pattern.replace("*", "<N>").replace("?", "u")
        sys.exit(
            f"{key} = '{folder}' holds no file {shown}: download {what} from nonlinearbenchmark.org and give its folder: --config {key}=FOLDER"
        )
    return [str(file) for file in found]


def own_study_file(wildcards):
    """What was prepared of a user's campaign; nothing for the structures that are built in."""
    return [] if wildcards.structure in STUDIES else f"results/{wildcards.structure}/study.json"


def study_of_structure(structure):
    """The Study of a structure, None where a user's campaign is refused.

    That of a user's campaign is available once it is prepared.
    """
    if structure in STUDIES:
        return study_of(structure)
    prepared = read_values(checkpoints._completion_prepare.get().output.study)
    return None if prepared["refused"] else study_of(structure, prepared)


# What is completed: the structures that are built in, and the campaign that is looked at where its own modes are asked for.
STRUCTURES = [*STUDIES, *([re.escape(LOOKED_AT)] if OWN is not None else [])]
if len(set(STRUCTURES)) < len(STRUCTURES):
    sys.exit(
        f"campaign = '{REQUEST['campaign']}': results/{STRUCTURES[-1]} belongs to the built-in structure of that name: rename the file"
    )


def law_files(structure, kind):
    """The files of a structure's "candidates", or of "additions" to the best of them."""
    study = study_of_structure(structure)
    return [
        f"results/{structure}/{kind}/{name}.json"
        for name in (getattr(study, kind) if study else ())
    ]


def candidate_files(wildcards):
    """The files of all single candidates of wildcard {structure}."""
    return law_files(wildcards.structure, "candidates")


def addition_files(wildcards):
    """The files of all second effects tried with the best candidate of wildcard {structure}."""
    return law_files(wildcards.structure, "additions")


def completion_figure_files(structure):
    """The figures of a completion; structure may be the wildcard in braces."""
    return [
        f"results/{structure}/figures/{name}.{suffix}"
        for name in COMPLETION_FIGURES
        for suffix in ("png", "pdf", "csv", "txt")
    ]


def completion_files(structure):
    """What a completion of a measured structure holds."""
    tables = ("campaign.nc", "mounting.csv", "prediction.csv", "verdict.json", "model_updated.yaml")
    return [
        *(f"results/{structure}/{name}" for name in tables),
        *completion_figure_files(structure),
    ]


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
    structure="|".join(STRUCTURES),
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
