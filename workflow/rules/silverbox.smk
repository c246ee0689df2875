# Optional: the Silverbox, an electronic Duffing oscillator. `snakemake -j2 silverbox --config silverbox_data=FOLDER`


rule silverbox:
    input:
        completion_files("silverbox"),
        library=library("silverbox"),
        verdict="results/silverbox/verdict.json",
        completed="results/silverbox/completed.json",
    output:
        table="results/silverbox/published.csv",
    log:
        "results/silverbox/logs/silverbox.log",
    benchmark:
        "results/silverbox/benchmarks/silverbox.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        config=settings("silverbox"),
    message:
        "Coefficients of the Silverbox beside the published ones"
    script:
        "../scripts/silverbox.py"
