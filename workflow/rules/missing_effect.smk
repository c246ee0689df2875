# A measured campaign against a model, one job from the campaign to the verdict:
# `snakemake discrepancy --config campaign=FILE [model=config/x.yaml]`.
# effort=quick or thorough spends less or more than the standard; draw=1, 2, ... simulates with
# other seeds.


rule _missing_effect:
    input:
        campaign=after_model_checks(MODEL, MODEL_FILES, compared_campaign),
    output:
        verdict=f"{DISCREPANCY}/verdict.json",
        map=f"{DISCREPANCY}/map.nc",
        map_after=f"{DISCREPANCY}/map_after.nc",
        ranking=f"{DISCREPANCY}/ranking.csv",
        model=f"{DISCREPANCY}/model_updated.yaml",
        so_far=f"{DISCREPANCY}/so_far.json",
    log:
        f"{DISCREPANCY}/logs/missing_effect.log",
    benchmark:
        f"{DISCREPANCY}/benchmarks/missing_effect.tsv"
    threads: 8  # or as many as there are: so many runs at a time
    resources:
        mem_mb=memory(3000),
        runtime=minutes(60),
    params:
        library=library("missing_effect"),
        config=MODEL.model_dump(mode="json"),
        effort=EFFORT,
        draw=DRAW,
    message:
        "Search for what is missing, effort {params.effort}"
    script:
        "../scripts/missing_effect.py"
