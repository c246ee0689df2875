# The names of the files of a study, and the inputs and params that rules get from functions.
from vibroimpact.config.stage_keys import stage_params
from vibroimpact.provenance import imported_files
from vibroimpact.reports.captions import read_caption
from vibroimpact.study.cases import (
    all_cases,
    case_from_id,
    ids_of_load,
    load_values,
    loads_by_half_decade,
    value_text,
)

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


def matrix_files():
    """The files of the matrices that give the structure; an edit of one reruns what follows."""
    if STUDY.structure.kind != "matrices":
        return []
    named = (STUDY.structure.mass, STUDY.structure.stiffness, STUDY.structure.damping)
    return sorted({file for file in named if file})


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


def series_shown():
    """The time series that the page of a study without spectra shows."""
    kept = STUDY.record.keep_time_series and not STUDY.record.every_step
    return files_of_study("timeseries") if kept and STUDY.identification is None else []


def caption_file(name):
    """The file with the caption, title and category of a figure or table."""
    return f"{CAPTIONS}/{name}.rst"


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
    loads = [value_text(load) for load in load_values(STUDY.grid)]
    jobs = ["basis", *(f"simulate_load_{load}" for load in loads)]
    if STUDY.identification is None:
        jobs.append("statistics")
    else:
        jobs += [f"spectra_load_{load}" for load in loads] if KEPT else []
        jobs += [f"identify_{start}" for start in loads_by_half_decade(STUDY.grid)]
        jobs += ["consistency", *(f"figures_{group}" for group in FIGURES)]
        jobs += ["synthetic_campaign"] if not STUDY.overlay.campaign else []
    return [*jobs, "study_page"]


def missing_files():
    """Of the files per case that a study lacks, one of each load and kind: its job makes them all.

    A file that was deleted is made again, although what was made from it is there. To name every
    file that is there would cost time at each start.
    """
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
    pages = [f"{RESULTS}/index.html", f"{RESULTS}/summary.pdf"]
    if STUDY.identification is None:
        return [f"{RESULTS}/statistics.csv", *pages, *series]
    figures = [file for group in FIGURES for file in figure_files(group)]
    tables = [*(f"{RESULTS}/{name}.csv" for name in TABLES), f"{RESULTS}/consistency.nc"]
    return [*tables, *pages, *figures, *series]


wildcard_constraints:
    law=r"[a-z_]+\.[A-Za-z0-9_-]+",
    load=r"[0-9.e+-]+",
