# A measured campaign against a model, one job from the campaign to the verdict:
# `snakemake discrepancy --config campaign=FILE [model=config/x.yaml]`.
# effort=quick or thorough looks for one or three effects at once, in place of two.


rule _diagnosis:
    input:
        campaign=after_model_checks(MODEL, MODEL_FILES, compared_campaign),
    output:
        verdict=f"{DISCREPANCY}/verdict.json",
        ranking=f"{DISCREPANCY}/ranking.csv",
        spectra=f"{DISCREPANCY}/spectra.nc",
        evidence=f"{DISCREPANCY}/evidence.nc",
        model=f"{DISCREPANCY}/model_updated.yaml",
    log:
        f"{DISCREPANCY}/logs/diagnosis.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/diagnosis.tsv"
    threads: 8  # or as many as there are: so many runs at a time
    resources:
        mem_mb=memory(3000),
        runtime=minutes(60),
    params:
        library=library("diagnosis"),
        config=MODEL.model_dump(mode="json"),
        effort=EFFORT,
    message:
        "Diagnosis, effort {params.effort}"
    script:
        "../scripts/diagnosis.py"
