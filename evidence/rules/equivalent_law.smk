# The law that estimates an equivalent support without a simulation. On request only: the law that
# ships with the package is made from the default study and copied.


rule equivalent_law:
    """The law of `vibroimpact equivalent --estimate` from this study, and its errors elsewhere."""
    input:
        model=f"{RESULTS}/model.nc",
        table=f"{RESULTS}/consistency_summary.csv",
        tubes=f"{CONFIGURATIONS}/validation/other_tubes.yaml",
    output:
        law=f"{RESULTS}/displacement_law.json",
        errors=f"{RESULTS}/displacement_law_errors.csv",
    log:
        f"{RESULTS}/logs/equivalent_law.log",
    benchmark:
        f"{RESULTS}/benchmarks/equivalent_law.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(20),
    params:
        library=evidence("equivalent_law"),
        config=settings("validation"),
    message:
        f"The law of the equivalent support, and its error on other tubes: {RESULTS}"
    script:
        "../scripts/equivalent_law.py"
