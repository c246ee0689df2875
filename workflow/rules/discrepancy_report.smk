# The figures and the report page of a diagnosis.

DIAGNOSIS_FIGURES = (
    "diagnosis_place",
    "diagnosis_holding",
    "diagnosis_law",
    "diagnosis_ranking",
    "diagnosis_free_sensor",
    "diagnosis_psd",
)


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
