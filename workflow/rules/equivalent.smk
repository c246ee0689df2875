# The equivalent support of a measured tube, one job from the campaign to the page:
# `snakemake -j2 equivalent --config equivalent_of=FILE.nc model=config/x.yaml`. No contact is
# simulated. Where results/ holds a study of the model, its curve is drawn behind the points.
MEASURED_FIGURES = ("figure_13_equivalent_support", "figure_05_overlay", "figure_06_levels")


rule equivalent:
    """Equivalent k and c of a measured tube: --config equivalent_of=FILE.nc [model=FILE.yaml]."""
    input:
        campaign=(
            measured_campaign
            if WITHOUT_MODEL
            else after_model_checks(MODEL, MODEL_FILES, measured_campaign)
        ),
        page=page_files("study_page"),
        captions=[caption_file(f"measured_{name}") for name in MEASURED_FIGURES],
    output:
        tables=[f"results/{MEASURED}/{name}.csv" for name in TABLES[:3]],
        dataset=f"results/{MEASURED}/consistency.nc",
        figures=[
            f"results/{MEASURED}/figures/{name}.{suffix}"
            for name in MEASURED_FIGURES
            for suffix in ("png", "pdf", "csv", "txt")
        ],
        page=f"results/{MEASURED}/equivalent.html",
    log:
        f"results/{MEASURED}/logs/equivalent.log",
    benchmark:
        f"results/{MEASURED}/benchmarks/equivalent.tsv"
    threads: 1
    resources:
        mem_mb=memory(3000),
        runtime=minutes(30),
    params:
        library=library("equivalent"),
        model=MODEL_VALUES,
        name=MEASURED,
        study=None if WITHOUT_MODEL else f"results/{MODEL.study}",
    message:
        f"Equivalent support of {MEASURED}: results/{MEASURED}/equivalent.html"
    script:
        "../scripts/equivalent.py"
