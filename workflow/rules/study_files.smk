# The names of the files of a study, and the inputs and params that rules get from functions.
from functools import cache

from snakemake.logging import logger
from vibroimpact.config.stage_keys import answer_digest, stage_params
from vibroimpact.io.provenance import library_digest
from vibroimpact.reports.captions import read_caption
from vibroimpact.study.cases import all_cases, batches, case_from_id
from vibroimpact_workflow.model_checks import model_warnings

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

TABLES = ("equivalent", "consistency", "consistency_summary", "consistency_collapse")
CAPTIONS = as_input(ROOT / "workflow" / "report")

CASES = [case.id for case in all_cases(STUDY.grid)]
KEPT = STUDY.record.keep_time_series or STUDY.record.every_step  # time series
# The cases that a job simulates: of the default study, those of one load. A job of the
# identification takes those of half a decade, because it needs longer to start and to prepare the
# linear tube than for the cases of one load. It takes 100 at most: Snakemake notes all inputs of a
# job for each of its outputs.
SIMULATED = batches(STUDY.grid, 10)
IDENTIFIED = batches(STUDY.grid, 2, 100)
# By what the simulation writes beside its records.
TO_SERIES = SIMULATED if KEPT or STUDY.identification is None else {}
TO_SPECTRA = {} if TO_SERIES else SIMULATED


@cache
def library(script, scripts=SCRIPTS):
    """The digest of the library files that a script imports, as a param: an edit reruns only the
    stages that import the file.

    It is a function, so that only the digests of jobs that are planned are made. A param costs the
    same whatever the number of files, while each input of each job is looked at again and again.
    """

    @cache
    def digest():
        return library_digest(f"{scripts}/{script}.py", SOURCE, as_input(ROOT))

    return lambda wildcards: digest()


def settings(stage):
    """The part of the configuration that a stage uses."""
    return stage_params(STUDY, stage)


def matrix_files():
    """The files of the matrices that give the structure; an edit of one reruns what follows."""
    if STUDY.structure.kind != "matrices":
        return []
    named = (STUDY.structure.mass, STUDY.structure.stiffness, STUDY.structure.damping)
    return sorted({file for file in named if file})


@cache
def check_model_once(source):
    """Exit with every problem of the model that the files `source` state, or say its warnings."""
    for text in model_warnings(STUDY if source == STUDY_FILES else MODEL, source):
        logger.warning(f"{source}: {text}")


def after_model_checks(source, files):
    """An input function that gives files, or those that a function of wildcards gives.

    The main process, a dry run too, first checks the model that the files `source` state. A job
    reads the Snakefile as well, and checks nothing.
    """

    def checked(wildcards):
        if workflow.is_main_process:
            check_model_once(source)
        return files(wildcards) if callable(files) else files

    return checked


def files_of_cases(folder, cases, suffix="nc"):
    """The files of some cases."""
    return [f"{RESULTS}/{folder}/{case.id}.{suffix}" for case in cases]


def files_of_study(folder, suffix="nc"):
    """The files of all cases."""
    return [f"{RESULTS}/{folder}/{case}.{suffix}" for case in CASES]


def work_on(cases):
    """The loads and the number of the cases that a job works on, for its message."""
    loads = [f"{load:g}" for load in dict.fromkeys((cases[0].load_rms_N, cases[-1].load_rms_N))]
    return f"at {' to '.join(loads)} N RMS: {len(cases)} of {len(CASES)} cases"


def figure_files(group):
    """The files of a group of figures."""
    return [
        f"{RESULTS}/figures/{name}.{suffix}"
        for name in FIGURES[group]
        for suffix in ("png", "pdf", "csv", "txt")
    ]


def series_shown():
    """The time series that the page of a study without spectra shows."""
    kept = STUDY.record.keep_time_series and not STUDY.record.every_step
    return files_of_study("timeseries") if kept and STUDY.identification is None else []


def caption_file(name):
    """The file with the caption, title and category of a figure or table."""
    return f"{CAPTIONS}/{name}.rst"


def page_files(name):
    """The files of a page beside those that its script imports: templates, style and script."""
    folder = Path(SOURCE, "vibroimpact", "reports")
    shared = [folder / each for each in ("page.html", "page.css", "blocks.html")]
    return [str(file) for file in (*shared, folder / f"{name}.html", *folder.glob(f"{name}.js"))]


def reported(path, name=None):
    """An output that `snakemake --report` shows, with the caption of its name."""
    caption = read_caption(caption_file(name or Path(path).stem))
    return report(
        path,
        caption=os.path.abspath(caption_file(caption.name)),
        category=caption.category,
        labels={"shows": caption.title, "file": Path(path).suffix.removeprefix(".").upper()},
    )


def reported_figures(group):
    """The files of a group of figures; the report shows the pictures."""
    return [reported(path) if path.endswith(".png") else path for path in figure_files(group)]


def figures_of_study():
    """The names of the figures that a complete study has, the answer first."""
    groups = reversed(FIGURES) if STUDY.identification is not None else ()
    return [name for group in groups for name in FIGURES[group]]


def jobs_of_study():
    """The names of the benchmark files and logs of the jobs of a complete study."""
    jobs = ["basis", *(f"simulate_{batch}" for batch in SIMULATED)]
    if STUDY.identification is None:
        jobs.append("statistics")
    else:
        jobs += [f"spectra_{batch}" for batch in SIMULATED] if KEPT else []
        jobs += [f"identify_{batch}" for batch in IDENTIFIED]
        jobs += ["consistency", *(f"figures_{group}" for group in FIGURES)]
        jobs += ["synthetic_campaign"] if not STUDY.overlay.campaign else []
    return [*jobs, "study_page"]


def missing_files():
    """Of the files per case that a study lacks, one of each load and kind: its job makes them all.

    A file that was deleted is made again, although what was made from it is there. A study without
    its page makes them anyway. To name every file that is there would cost time at each start.
    """
    if not Path(RESULTS, "index.html").is_file():
        return []
    kinds = ["records/*.nc", "spectra/*.nc", "estimates/*.nc", "estimates/*.csv"]
    missing = {}
    for kind in kinds if STUDY.identification is not None else kinds[:1]:
        there = {file.name for file in Path(RESULTS).glob(kind)}
        for case in CASES:
            path = Path(RESULTS, kind.replace("*", case))
            if path.name not in there:
                missing.setdefault((kind, case_from_id(case).load_rms_N), path.as_posix())
    return list(missing.values())


def targets():
    """The files of a complete study: page, tables, figures, and time series where they are kept.

    Files per case are among them where they are missing.
    Without an identification: page, statistics of every case, and time series where they are kept.
    """
    series = [*(files_of_study("timeseries") if KEPT else []), *missing_files()]
    page = f"{RESULTS}/index.html"
    if STUDY.identification is None:
        return [f"{RESULTS}/statistics.csv", page, *series]
    figures = [file for group in FIGURES for file in figure_files(group)]
    tables = [*(f"{RESULTS}/{name}.csv" for name in TABLES), f"{RESULTS}/consistency.nc"]
    return [*tables, page, *figures, *series]


wildcard_constraints:
    law=r"[a-z_]+\.[A-Za-z0-9_-]+",
