# The figures and the report page of a discrepancy run. `snakemake -j2 discrepancy_report --config campaign=FILE` once it has its verdict.

DISCREPANCY_FIGURES = ("discrepancy_map", "discrepancy_psd", "discrepancy_ranking", "discrepancy_profiles", "discrepancy_levels")


rule discrepancy_mode:
    # a full run after a quick one has the same products: it must not take those for its own
    output:
        mode=f"{DISCREPANCY}/mode.txt",
    params:
        mode="quick" if QUICK else "full",
    log:
        f"{DISCREPANCY}/logs/mode.log",
    threads: 1
    resources:
        mem_mb=100,
        runtime=1,
    message:
        "Mode of the discrepancy run: {params.mode}"
    shell:
        "echo {params.mode} > {output.mode} 2> {log}"


rule discrepancy_report:
    input:
        library=library("discrepancy_report"),
        template=f"{SOURCE}/vibroimpact/discrepancy_page.html",
        verdict=f"{DISCREPANCY}/verdict.json",
        map=f"{DISCREPANCY}/map.nc",
        map_after=f"{DISCREPANCY}/map_after.nc",
        ranking=f"{DISCREPANCY}/ranking.csv",
    output:
        page=f"{DISCREPANCY}/report.html",
        figures=[f"{DISCREPANCY}/figures/{name}.{suffix}" for name in DISCREPANCY_FIGURES for suffix in ("png", "pdf", "csv", "txt")],
    params:
        name=LOOKED_AT,
    log:
        f"{DISCREPANCY}/logs/discrepancy_report.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/discrepancy_report.tsv"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=10,
    message:
        f"Report of {LOOKED_AT}: {DISCREPANCY}/report.html"
    script:
        "../scripts/discrepancy_report.py"
