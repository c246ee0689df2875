# Structure -> reduced model and its quality report.


rule _basis:
    input:
        matrices=after_model_checks(STUDY, STUDY_FILES, matrix_files()),
    output:
        model=f"{RESULTS}/model.nc",
        quality=reported(f"{RESULTS}/basis_quality.csv", "basis_quality_table"),
        accuracy=reported(f"{RESULTS}/model_accuracy.csv"),
    log:
        f"{RESULTS}/logs/basis.log",
    benchmark:
        f"{RESULTS}/benchmarks/basis.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=library("basis"),
        config=settings("basis"),
    message:
        "Reduced model of the structure, and its quality against the full model"
    script:
        "../scripts/basis.py"
