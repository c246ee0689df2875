# The quick mode: `snakemake -j2 discrepancy --config campaign=FILE quick=yes`. It is one job,
# because starting a job per candidate would take as long as the candidates.


rule _discrepancy_quick:
    input:
        campaign=after_model_checks(MODEL, MODEL_FILES, compared_campaign),
        mode=f"{DISCREPANCY}/mode.txt",
    output:
        verdict=f"{DISCREPANCY}/verdict.json",
        map=f"{DISCREPANCY}/map.nc",
        map_after=f"{DISCREPANCY}/map_after.nc",
        ranking=f"{DISCREPANCY}/ranking.csv",
        model=f"{DISCREPANCY}/model_updated.yaml",
    log:
        f"{DISCREPANCY}/logs/quick.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/quick.tsv"
    threads: 2
    resources:
        mem_mb=memory(6000),
        runtime=minutes(20),
    params:
        library=library("discrepancy_quick"),
        config=MODEL.model_dump(mode="json"),
    message:
        "Quick look for what is missing: short records, fewer parameters, no second effect"
    script:
        "../scripts/discrepancy_quick.py"
