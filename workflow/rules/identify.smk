# Equivalent stiffness and damping per case by every method, and the table that compares the
# methods. One job per batch of cases (rules _identify_from_0.5 and so on).
for BATCH, BATCH_CASES in IDENTIFIED.items():

    rule _identify:
        name:
            f"_identify_{BATCH}"
        input:
            model=f"{RESULTS}/model.nc",
            records=files_of_cases("records", BATCH_CASES),
            spectra=files_of_cases("spectra", BATCH_CASES),
        output:
            curves=files_of_cases("estimates", BATCH_CASES),
            tables=files_of_cases("estimates", BATCH_CASES, "csv"),
        log:
            f"{RESULTS}/logs/identify_{BATCH}.log",
        benchmark:
            f"{RESULTS}/benchmarks/identify_{BATCH}.tsv"
        priority: 1  # spread over the simulations, not after them
        threads: 1
        resources:
            mem_mb=memory(1000),
            runtime=minutes(30),
        params:
            library=library("identify"),
            config=settings("identify"),
        message:
            f"Identification {work_on(BATCH_CASES)}"
        script:
            "../scripts/identify.py"


rule _consistency:
    input:
        model=f"{RESULTS}/model.nc",
        tables=files_of_study("estimates", "csv"),
    output:
        table=reported(f"{RESULTS}/consistency.csv"),
        summary=reported(f"{RESULTS}/consistency_summary.csv"),
        collapse=reported(f"{RESULTS}/consistency_collapse.csv"),
        equivalent=reported(f"{RESULTS}/equivalent.csv"),
        dataset=f"{RESULTS}/consistency.nc",
    log:
        f"{RESULTS}/logs/consistency.log",
    benchmark:
        f"{RESULTS}/benchmarks/consistency.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=library("consistency"),
        config=settings("consistency"),
        digest=answer_digest(STUDY.model_dump(mode="json")),
    message:
        f"Consistency of the methods over {len(CASES)} cases"
    script:
        "../scripts/consistency.py"
