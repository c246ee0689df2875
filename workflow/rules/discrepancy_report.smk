# The figures and the report page of a discrepancy run.

DISCREPANCY_FIGURES = (
    "discrepancy_place",
    "discrepancy_map",
    "discrepancy_psd",
    "discrepancy_ranking",
    "discrepancy_profiles",
)


rule _discrepancy_report:
    input:
        template=f"{SOURCE}/vibroimpact/reports/discrepancy_page.html",
        verdict=f"{DISCREPANCY}/verdict.json",
        map=f"{DISCREPANCY}/map.nc",
        map_after=f"{DISCREPANCY}/map_after.nc",
        ranking=f"{DISCREPANCY}/ranking.csv",
    output:
        page=f"{DISCREPANCY}/report.html",
        figures=[
            f"{DISCREPANCY}/figures/{name}.{suffix}"
            for name in DISCREPANCY_FIGURES
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
        config=MODEL.model_dump(mode="json"),
        name=LOOKED_AT,
        compared_s=EFFORTS[EFFORT].compared_s,
    message:
        f"Report of {LOOKED_AT}: {DISCREPANCY}/report.html"
    script:
        "../scripts/discrepancy_report.py"
