# Equivalent stiffness and damping per case by every method, and the table that compares the
# methods. The loads of half a decade are identified in one job (rules _identify_from_0.316 and so
# on), because a job needs longer to start and to prepare the linear tube than for the cases of one
# load.
from vibroimpact.study.cases import loads_by_half_decade

for START, LOADS in loads_by_half_decade(STUDY.grid).items():

    rule _identify:
        name:
            f"_identify_{START}"
        input:
            library=library("identify"),
            model=f"{RESULTS}/model.nc",
            records=files_of_loads("records", LOADS),
            spectra=files_of_loads("spectra", LOADS),
        output:
            curves=files_of_loads("estimates", LOADS),
            tables=files_of_loads("estimates", LOADS, "csv"),
        log:
            f"{RESULTS}/logs/identify_{START}.log",
        benchmark:
            f"{RESULTS}/benchmarks/identify_{START}.tsv"
        priority: 1  # spread over the simulations, not after them
        threads: 1
        resources:
            mem_mb=memory(1000),
            runtime=minutes(30),
        params:
            config=settings("identify"),
        message:
            (
                f"Identification at {' to '.join(dict.fromkeys((LOADS[0], LOADS[-1])))} N RMS:"
                f" {len(LOADS) * CASES_PER_LOAD} of {len(CASES)} cases"
            )
        script:
            "../scripts/identify.py"


rule _consistency:
    input:
        library=library("consistency"),
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
        config=settings("consistency"),
    message:
        f"Consistency of the methods over {len(CASES)} cases"
    script:
        "../scripts/consistency.py"
