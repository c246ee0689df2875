# Equivalent stiffness and damping per case by every method, then the table that compares the methods.


rule identify:
    input:
        library=library("identify"),
        model=f"{RESULTS}/model.nc",
        records=files_of_load("records"),
        spectra=files_of_load("spectra"),
    output:
        curves=files_of_load("estimates"),
        tables=files_of_load("estimates", "csv"),
    params:
        config=settings("identify"),
    log:
        f"{RESULTS}/logs/identify_load_{{load}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/identify_load_{{load}}.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=30,
    message:
        f"Identification at {{wildcards.load}} N RMS: {CASES_PER_LOAD} of {len(CASES)} cases"
    script:
        "../scripts/identify.py"


rule consistency:
    input:
        library=library("consistency"),
        tables=files_of_study("estimates", "csv"),
    output:
        table=f"{RESULTS}/consistency.csv",
        summary=f"{RESULTS}/consistency_summary.csv",
        collapse=f"{RESULTS}/consistency_collapse.csv",
        dataset=f"{RESULTS}/consistency.nc",
    params:
        config=settings("consistency"),
    log:
        f"{RESULTS}/logs/consistency.log",
    benchmark:
        f"{RESULTS}/benchmarks/consistency.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    message:
        f"Consistency of the methods over {len(CASES)} cases"
    script:
        "../scripts/consistency.py"
