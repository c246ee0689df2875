# What a run is asked for, and its checked configuration: every problem ends it before a job is
# planned.
import os
import shlex
import sys
from pathlib import Path

# The folder that holds Snakefile, workflow/ and config/: a checkout with the library in
# src/, or vibroimpact/share/ of the installed package. That of the package also serves a module
# that Snakemake reads from a repository in the network.
if workflow.current_basedir.is_local:
    ROOT = Path(workflow.current_basedir.get_path_or_uri(secret_free=True)).parents[1]
else:
    from vibroimpact import workflow_snakefile

    ROOT = Path(workflow_snakefile()).parent
IN_CHECKOUT = (ROOT / "src" / "vibroimpact").is_dir()


def as_input(path):
    """A path as rules name it: relative below the working folder, else absolute.

    A study that is moved then finds the same inputs of an installed library.
    """
    here = Path.cwd()
    return str(path.relative_to(here) if path.is_relative_to(here) else path)


SOURCE = as_input(ROOT / "src" if IN_CHECKOUT else ROOT.parents[1])
SCRIPTS = as_input(ROOT / "workflow" / "scripts")
CONFIGURATIONS = as_input(ROOT / "config")
# Snakemake writes sys.executable into commands as it stands: a path with a space needs quotes.
PYTHON = sys.executable if sys.executable.startswith("'") else shlex.quote(sys.executable)
sys.executable = PYTHON
# Jobs inherit these. The library of a checkout needs no installation; -j jobs use one thread each.
if IN_CHECKOUT:
    sys.path.insert(0, SOURCE)
    os.environ.update(PYTHONPATH=os.path.abspath(SOURCE))
sys.path.append(str(ROOT / "workflow"))
os.environ.update(
    OMP_NUM_THREADS="1",
    OPENBLAS_NUM_THREADS="1",
    MKL_NUM_THREADS="1",
    NUMBA_NUM_THREADS="1",
)

from vibroimpact.config.reading import ConfigError, check_config, read_yaml
from vibroimpact_workflow.asked_numbers import asked_number
from vibroimpact_workflow.resources import memory, minutes

# Values of --config that are not keys of the study.
REQUEST = {
    name: str(config.pop(name))
    for name in (
        "import",
        "campaign",
        "equivalent_of",
        "model",
        "effort",
        "draw_seed",
        "count",
        "shard",
        "add",
    )
    if name in config
}


for name, value in REQUEST.items():
    if not value.strip():
        sys.exit(f"{name} = '': give a value, or leave it out")


def number_asked(name, example, whole=False):
    """The number of --config name=NUMBER, None where it is not given.

    Exits with a sentence where it is not a positive number, or not whole where that is asked.
    """
    try:
        return asked_number(name, REQUEST[name], example, whole) if name in REQUEST else None
    except ValueError as problem:
        sys.exit(str(problem))


def asked_effort():
    """The value of --config effort=NAME, "standard" where it is not given.

    Exits with a sentence where it is none that there is.
    """
    if "effort" not in REQUEST:
        return "standard"
    from vibroimpact.diagnosis.diagnose_command import EFFORTS

    if REQUEST["effort"] not in EFFORTS:
        told = f"give one of {', '.join(EFFORTS)}, or leave it out"
        sys.exit(f"effort = '{REQUEST['effort']}': {told}")
    return REQUEST["effort"]


LOOKED_AT = Path(REQUEST.get("campaign", "campaign")).stem
DISCREPANCY = f"results/{LOOKED_AT}"
MEASURED = Path(REQUEST.get("equivalent_of", "campaign")).stem
EFFORT = asked_effort()


def requested(name, example):
    """The path of --config name=PATH, as an input function.

    Exits with a sentence where it is not given or does not exist.
    """

    kind, is_there = ("folder", os.path.isdir) if example == "FOLDER" else ("file", os.path.isfile)

    def path(wildcards):
        if not is_there(REQUEST.get(name, "")):
            what = f"is no {kind}" if os.path.exists(REQUEST.get(name, "")) else "is not there"
            sys.exit(
                f"{name} = '{REQUEST.get(name, '')}' {what}: give it as in"
                f" --config {name}={example}"
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
    """The model that a campaign is compared with, or the statement of a structure without one, and
    its plain values.

    It is that of --config model=FILE, or the study's where none is given.
    """
    if "model" not in REQUEST:
        return STUDY, STUDY.model_dump(mode="json")
    from vibroimpact.diagnosis.identified.structure_file import model_of, values_of

    try:
        model = model_of(REQUEST["model"])
    except ConfigError as error:
        sys.exit(str(error))
    return model, values_of(model)


STUDY = checked_config()
STUDY_FILES = " + ".join(os.path.relpath(file) for file in workflow.configfiles)
MODEL, MODEL_VALUES = checked_model()
WITHOUT_MODEL = not isinstance(MODEL, type(STUDY))  # modes come from the campaign itself
MODEL_FILES = STUDY_FILES if MODEL is STUDY else REQUEST["model"]
RESULTS = f"results/{STUDY.study}"
