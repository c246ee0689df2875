# What linear supports predict of the study that they were identified from. On request only:
# `snakemake -j2 supports_prediction --configfile FILE`.


rule supports_prediction:
    """Linear supports against the simulated contacts: one k and c for all, and each its own."""
    input:
        model=f"{RESULTS}/model.nc",
        equivalent=f"{RESULTS}/equivalent.csv",
        records=files_of_study("records"),
        spectra=files_of_study("spectra"),
    output:
        table=f"{RESULTS}/supports_prediction.csv",
        one=f"{RESULTS}/equivalent_one_for_all.csv",
    log:
        f"{RESULTS}/logs/supports_prediction.log",
    benchmark:
        f"{RESULTS}/benchmarks/supports_prediction.tsv"
    threads: 1
    resources:
        mem_mb=memory(2000),
        runtime=minutes(20),
    params:
        library=library("supports_prediction"),
        config=settings("supports_prediction"),
    message:
        f"Linear supports against the simulated contacts of {len(CASES)} cases"
    script:
        "../scripts/supports_prediction.py"
