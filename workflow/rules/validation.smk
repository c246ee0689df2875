# Verification and validation: reference cases, convergence, the paper's claims, prediction; `snakemake -j2 validation`.
VALIDATION = "results/validation"
REFERENCE_GROUPS = ("frequencies", "impacts", "r11_stops_10", "r11_stops_100")
PREDICTION_CASES = ("left_out", "gaps", "second_tube")


def validation_figures(*names):
    """The files of figures of the validation."""
    return [f"{VALIDATION}/figures/validation_{name}.{suffix}" for name in names for suffix in ("png", "pdf", "csv", "txt")]


def page_checks():
    """The tables of comparisons that the page gathers."""
    return [f"{VALIDATION}/checks_{group}.csv" for group in REFERENCE_GROUPS] + [files[-1] for files in CONVERGENCE_TABLES.values()] + [f"{VALIDATION}/checks_judges.csv"]


def page_figures():
    """The figures that the page shows."""
    return [file for files in CONVERGENCE_FIGURE_FILES.values() for file in files] + validation_figures("judges", "claims_peak", "claims_shape", "prediction", "prediction_gain")


wildcard_constraints:
    group="|".join(REFERENCE_GROUPS),
    cases="|".join(PREDICTION_CASES),


rule validation_reference:
    input:
        library=library("validation_reference"),
        configs=[str(path) for path in sorted(Path("config/reference").glob("*.yaml"))],
    output:
        checks=f"{VALIDATION}/checks_{{group}}.csv",
        rows=f"{VALIDATION}/order_{{group}}.csv",
    params:
        config=settings("validation"),
        folder="config/reference",
    log:
        f"{VALIDATION}/logs/reference_{{group}}.log",
    benchmark:
        f"{VALIDATION}/benchmarks/reference_{{group}}.tsv"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=30,
    message:
        "Reference cases: {wildcards.group}"
    script:
        "../scripts/validation_reference.py"


rule validation_claims:
    input:
        library=library("validation_claims"),
        model=f"{RESULTS}/model.nc",
        quality=f"{RESULTS}/basis_quality.csv",
        tables=[f"{RESULTS}/consistency.csv", f"{RESULTS}/consistency_summary.csv", f"{RESULTS}/consistency_collapse.csv"],
        records=files_of_study("records"),
        spectra=files_of_study("spectra"),
        curves=files_of_study("estimates"),
        steps=f"{VALIDATION}/convergence_runs_step.csv",
        modes=f"{VALIDATION}/convergence_runs_modes.csv",
    output:
        table=f"{VALIDATION}/claims.csv",
        figures=validation_figures("claims_peak", "claims_shape"),
    params:
        config=settings("validation"),
    log:
        f"{VALIDATION}/logs/claims.log",
    benchmark:
        f"{VALIDATION}/benchmarks/claims.tsv"
    threads: 1
    resources:
        mem_mb=3000,
        runtime=20,
    message:
        "The paper's claims, measured"
    script:
        "../scripts/validation_claims.py"


rule validation_prediction_cases:
    input:
        library=library("validation_prediction_cases"),
        model=f"{RESULTS}/model.nc",
        table=f"{RESULTS}/consistency_summary.csv",
        records=files_of_study("records"),
        spectra=files_of_study("spectra"),
        second="config/validation/second_tube.yaml",
    output:
        table=f"{VALIDATION}/prediction_{{cases}}.csv",
    params:
        config=settings("validation"),
    log:
        f"{VALIDATION}/logs/prediction_{{cases}}.log",
    benchmark:
        f"{VALIDATION}/benchmarks/prediction_{{cases}}.tsv"
    threads: 1
    resources:
        mem_mb=3000,
        runtime=30,
    message:
        "Equivalent linear tube against the non-linear one: {wildcards.cases}"
    script:
        "../scripts/validation_prediction_cases.py"


rule validation_prediction:
    input:
        library=library("validation_prediction"),
        tables=[f"{VALIDATION}/prediction_{cases}.csv" for cases in PREDICTION_CASES],
    output:
        table=f"{VALIDATION}/prediction.csv",
        summary=f"{VALIDATION}/prediction_summary.csv",
        figures=validation_figures("prediction", "prediction_gain"),
    params:
        config=settings("statistics"),
    log:
        f"{VALIDATION}/logs/prediction.log",
    benchmark:
        f"{VALIDATION}/benchmarks/prediction.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    message:
        "When the equivalent linear model may be used"
    script:
        "../scripts/validation_prediction.py"


rule validation:
    input:
        library=library("validation"),
        checks=page_checks(),
        order=f"{VALIDATION}/order_impacts.csv",
        claims=f"{VALIDATION}/claims.csv",
        prediction=f"{VALIDATION}/prediction_summary.csv",
        figures=page_figures(),
    output:
        table=f"{VALIDATION}/validation.csv",
        page=f"{VALIDATION}/index.html",
        figures=validation_figures("reference"),
    params:
        config=settings("statistics"),
    log:
        f"{VALIDATION}/logs/validation.log",
    benchmark:
        f"{VALIDATION}/benchmarks/validation.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    message:
        f"Validation: every comparison in one table, and the page {VALIDATION}/index.html"
    script:
        "../scripts/validation.py"
