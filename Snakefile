# The study, end to end: `snakemake -j2`, or with another configuration,
# `snakemake -j2 --configfile config/smoke.yaml`.
from snakemake.utils import min_version

min_version("9.0")

if not workflow.configfiles:

    configfile: "config/study.yaml"


report: "workflow/report/study.rst"


include: "workflow/rules/configuration.smk"
include: "workflow/rules/asked_campaign.smk"
include: "workflow/rules/study_files.smk"
include: "workflow/rules/run.smk"
include: "workflow/rules/study.smk"
include: "workflow/rules/identify.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/measured.smk"
include: "workflow/rules/discrepancy.smk"
include: "workflow/rules/on_request.smk"


if (ROOT / "evidence").is_dir():

    include: "evidence/rules/evidence.smk"


localrules:
    all,
    discrepancy,


onstart:
    start_no_timers()
    begin_run()


onsuccess:
    say_success()


onerror:
    say_failure(log)


rule all:
    """The whole study: simulation, spectra, identification, tables and every figure."""
    default_target: True
    input:
        targets(),
    message:
        f"Study '{STUDY.study}' is complete: {RESULTS}/index.html"


rule discrepancy:
    """Compare a measured campaign with a model: --config campaign=FILE [effort=NAME]."""
    input:
        verdict=f"{DISCREPANCY}/verdict.json",
        model=f"{DISCREPANCY}/model_updated.yaml",
        page=f"{DISCREPANCY}/report.html",
    message:
        f"Discrepancy of '{LOOKED_AT}': {DISCREPANCY}/report.html"
