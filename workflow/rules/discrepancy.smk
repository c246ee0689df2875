# A measured campaign against a model, one job from the campaign to the verdict:
# `snakemake discrepancy --config campaign=FILE [model=config/x.yaml]`, or model=identified.
# effort=quick or thorough looks for one or three effects at once, in place of two.
DIAGNOSIS_FIGURES = (
    "diagnosis_place",
    "diagnosis_holding",
    "diagnosis_law",
    "diagnosis_ranking",
    "diagnosis_free_sensor",
    "diagnosis_psd",
)


rule _diagnosis:
    input:
        campaign=(
            asked_campaign if WITHOUT_MODEL else after_model_checks(MODEL_FILES, compared_campaign)
        ),
    output:
        verdict=f"{DISCREPANCY}/verdict.json",
        ranking=f"{DISCREPANCY}/ranking.csv",
        spectra=f"{DISCREPANCY}/spectra.nc",
        evidence=f"{DISCREPANCY}/evidence.nc",
        model=f"{DISCREPANCY}/model_updated.yaml",
        prediction=[f"{DISCREPANCY}/prediction.csv"] if WITHOUT_MODEL else [],
    log:
        f"{DISCREPANCY}/logs/diagnosis.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/diagnosis.tsv"
    threads: 8  # or as many as there are: so many runs at a time
    resources:
        mem_mb=memory(3000),
        runtime=minutes(60),
    params:
        library=library("diagnosis"),
        model=MODEL_VALUES,
        effort=EFFORT,
        so_far=f"{DISCREPANCY}/so_far.json",
    message:
        "Diagnosis, effort {params.effort}"
    script:
        "../scripts/diagnosis.py"


rule _discrepancy_report:
    input:
        template=page_files("discrepancy_page"),
        verdict=f"{DISCREPANCY}/verdict.json",
        evidence=f"{DISCREPANCY}/evidence.nc",
        spectra=f"{DISCREPANCY}/spectra.nc",
    output:
        page=f"{DISCREPANCY}/report.html",
        figures=[
            f"{DISCREPANCY}/figures/{name}.{suffix}"
            for name in DIAGNOSIS_FIGURES
            for suffix in ("png", "pdf", "csv", "txt")
        ],
    log:
        f"{DISCREPANCY}/logs/discrepancy_report.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/discrepancy_report.tsv"
    threads: 1
    resources:
        mem_mb=memory(2000),
        runtime=minutes(10),
    params:
        library=library("discrepancy_report"),
        model=MODEL_VALUES,
        name=LOOKED_AT,
    message:
        f"Report of {LOOKED_AT}: {DISCREPANCY}/report.html"
    script:
        "../scripts/discrepancy_report.py"
