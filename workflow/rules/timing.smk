# Where the time of a study went. On request only, since every job would make it out of date.


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
