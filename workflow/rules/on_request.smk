# Rules on request only: what linear supports predict of the study that they were identified from,
# and the time that a study took (every job would make it out of date).
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


rule timing:
    """Where the time of a finished study went: table and figure."""
    input:
        benchmarks=[f"{RESULTS}/benchmarks/{job}.tsv" for job in jobs_of_study()],
    output:
        table=reported(f"{RESULTS}/timing.csv", "timing_table"),
        figures=[
            reported(f"{RESULTS}/figures/timing.png"),
            *(f"{RESULTS}/figures/timing.{suffix}" for suffix in ("pdf", "csv", "txt")),
        ],
    log:
        f"{RESULTS}/logs/timing.log",
    benchmark:
        f"{RESULTS}/benchmarks/timing.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=library("timing"),
        config=settings("timing"),
        logs=[f"{RESULTS}/logs/{job}.log" for job in jobs_of_study()],
    message:
        f"Timing of the study: {RESULTS}/timing.csv"
    script:
        "../scripts/timing.py"
