# Verification and validation: reference cases, convergence, claims of the paper, prediction.
VALIDATION = "results/validation"
REFERENCE_GROUPS = (
    "frequencies",
    "impacts",
    "tubes",
    "r11_stops_10",
    "r11_stops_100",
    "r11_stops_1000",
    "r11_one_stop",
    "flow",
)
PREDICTION_CASES = ("left_out", "gaps", "second_tube")


CLAIM_FIGURES = [
    f"{VALIDATION}/figures/validation_claims_{name}.{suffix}"
    for name in ("peak", "shape")
    for suffix in ("png", "pdf", "csv", "txt")
]
PREDICTION_FIGURES = [
    f"{VALIDATION}/figures/validation_{name}.{suffix}"
    for name in ("prediction", "prediction_gain")
    for suffix in ("png", "pdf", "csv", "txt")
]
JUDGES_FIGURE = [
    f"{VALIDATION}/figures/validation_judges.{suffix}" for suffix in ("png", "pdf", "csv", "txt")
]
CONVERGENCE_PICTURES = [file for files in CONVERGENCE_FIGURE_FILES.values() for file in files]
PAGE_CHECKS = [
    *(f"{VALIDATION}/checks_{group}.csv" for group in REFERENCE_GROUPS),
    *(files[-1] for files in CONVERGENCE_TABLES.values()),
    f"{VALIDATION}/checks_judges.csv",
]


wildcard_constraints:
    group="|".join(REFERENCE_GROUPS),
    cases="|".join(PREDICTION_CASES),


rule _validation_reference:
    input:
        configs=[str(path) for path in sorted(Path(CONFIGURATIONS, "reference").glob("*.yaml"))],
    output:
        checks=f"{VALIDATION}/checks_{{group}}.csv",
        rows=f"{VALIDATION}/order_{{group}}.csv",
    log:
        f"{VALIDATION}/logs/reference_{{group}}.log",
    benchmark:
        f"{VALIDATION}/benchmarks/reference_{{group}}.tsv"
    threads: 1
    resources:
        mem_mb=memory(2000),
        runtime=minutes(30),
    params:
        library=evidence("validation_reference"),
        config=settings("validation"),
    message:
        "Reference cases: {wildcards.group}"
    script:
        "../scripts/validation_reference.py"


rule _validation_claims:
    input:
        model=f"{RESULTS}/model.nc",
        quality=f"{RESULTS}/basis_quality.csv",
        tables=[
            f"{RESULTS}/consistency.csv",
            f"{RESULTS}/consistency_summary.csv",
            f"{RESULTS}/consistency_collapse.csv",
        ],
        records=files_of_study("records"),
        spectra=files_of_study("spectra"),
        curves=files_of_study("estimates"),
        steps=f"{VALIDATION}/convergence_runs_step.csv",
        modes=f"{VALIDATION}/convergence_runs_modes.csv",
    output:
        table=f"{VALIDATION}/claims.csv",
        figures=CLAIM_FIGURES,
    log:
        f"{VALIDATION}/logs/claims.log",
    benchmark:
        f"{VALIDATION}/benchmarks/claims.tsv"
    threads: 1
    resources:
        mem_mb=memory(3000),
        runtime=minutes(20),
    params:
        library=evidence("validation_claims"),
        config=settings("validation"),
    message:
        "The paper's claims, measured"
    script:
        "../scripts/validation_claims.py"


rule _validation_prediction_cases:
    input:
        model=f"{RESULTS}/model.nc",
        table=f"{RESULTS}/consistency_summary.csv",
        records=files_of_study("records"),
        spectra=files_of_study("spectra"),
        second=f"{CONFIGURATIONS}/validation/second_tube.yaml",
    output:
        table=f"{VALIDATION}/prediction_{{cases}}.csv",
    log:
        f"{VALIDATION}/logs/prediction_{{cases}}.log",
    benchmark:
        f"{VALIDATION}/benchmarks/prediction_{{cases}}.tsv"
    threads: 1
    resources:
        mem_mb=memory(3000),
        runtime=minutes(30),
    params:
        library=evidence("validation_prediction_cases"),
        config=settings("validation"),
    message:
        "Equivalent linear tube against the non-linear one: {wildcards.cases}"
    script:
        "../scripts/validation_prediction_cases.py"


rule _validation_prediction:
    input:
        tables=[f"{VALIDATION}/prediction_{cases}.csv" for cases in PREDICTION_CASES],
    output:
        table=f"{VALIDATION}/prediction.csv",
        summary=f"{VALIDATION}/prediction_summary.csv",
        figures=PREDICTION_FIGURES,
    log:
        f"{VALIDATION}/logs/prediction.log",
    benchmark:
        f"{VALIDATION}/benchmarks/prediction.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=evidence("validation_prediction"),
        config=settings("statistics"),
    message:
        "When the equivalent linear model may be used"
    script:
        "../scripts/validation_prediction.py"


rule validation:
    """Reference cases, frequencies, convergence and the claims of the paper, on one page."""
    input:
        checks=PAGE_CHECKS,
        order=f"{VALIDATION}/order_impacts.csv",
        claims=f"{VALIDATION}/claims.csv",
        prediction=f"{VALIDATION}/prediction_summary.csv",
        figures=CONVERGENCE_PICTURES + JUDGES_FIGURE + CLAIM_FIGURES + PREDICTION_FIGURES,
    output:
        table=f"{VALIDATION}/validation.csv",
        page=f"{VALIDATION}/index.html",
        figures=[
            f"{VALIDATION}/figures/validation_reference.{suffix}"
            for suffix in ("png", "pdf", "csv", "txt")
        ],
    log:
        f"{VALIDATION}/logs/validation.log",
    benchmark:
        f"{VALIDATION}/benchmarks/validation.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=evidence("validation"),
        config=settings("statistics"),
    message:
        f"Validation: every comparison in one table, and the page {VALIDATION}/index.html"
    script:
        "../scripts/validation.py"
