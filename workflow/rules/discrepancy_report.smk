# The figures and the report page of a discrepancy run. `snakemake -j2 discrepancy_report --config campaign=FILE` once it has its verdict.

DISCREPANCY_FIGURES = ("discrepancy_map", "discrepancy_psd", "discrepancy_ranking", "discrepancy_profiles", "discrepancy_levels")


rule discrepancy_report:
    input:
        library=library("discrepancy_report"),
        template=f"{SOURCE}/vibroimpact/discrepancy_page.html",
        verdict=f"results/{LOOKED_AT}/verdict.json",
        map=f"results/{LOOKED_AT}/map.nc",
        map_after=f"results/{LOOKED_AT}/map_after.nc",
        ranking=f"results/{LOOKED_AT}/ranking.csv",
    output:
        page=f"results/{LOOKED_AT}/report.html",
        figures=[f"results/{LOOKED_AT}/figures/{name}.{suffix}" for name in DISCREPANCY_FIGURES for suffix in ("png", "pdf", "csv", "txt")],
    params:
        name=LOOKED_AT,
    log:
        f"results/{LOOKED_AT}/logs/discrepancy_report.log",
    benchmark:
        f"results/{LOOKED_AT}/benchmarks/discrepancy_report.tsv"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=10,
    message:
        f"Report of {LOOKED_AT}: results/{LOOKED_AT}/report.html"
    script:
        "../scripts/discrepancy_report.py"
