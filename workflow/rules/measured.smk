# Raw measurements to a campaign file, a first look at one, and the equivalent support of a measured
# tube: `snakemake -j2 equivalent --config equivalent_of=FILE.nc model=config/x.yaml`. No contact is
# simulated for it. Where results/ holds a study of the model, its curve is drawn behind the points.
MEASURED_FIGURES = ("figure_13_equivalent_support", "figure_05_overlay", "figure_06_levels")


rule import_campaign:
    """Turn a folder of raw measurements into a campaign file: --config import=FOLDER."""
    input:
        folder=requested("import", "FOLDER"),
        files=measured_files,
    output:
        campaign=f"results/{IMPORTED}/{IMPORTED}.nc",
        table=f"results/{IMPORTED}/import.csv",
        text=f"results/{IMPORTED}/import.txt",
        checks=f"results/{IMPORTED}/checks.csv",
        figure=[f"results/{IMPORTED}/quicklook.{kind}" for kind in ("png", "pdf", "csv", "txt")],
    log:
        f"results/{IMPORTED}/logs/import_campaign.log",
    benchmark:
        f"results/{IMPORTED}/benchmarks/import_campaign.tsv"
    threads: 1
    resources:
        mem_mb=memory(4000),
        runtime=minutes(20),
    params:
        library=library("import_campaign"),
        folder=REQUEST.get("import"),
    message:
        f"Campaign of the folder {IMPORTED}: results/{IMPORTED}/import.txt says what was found"
    script:
        "../scripts/import_campaign.py"


rule quicklook:
    """Check and draw a campaign file, without a model: --config campaign=FILE."""
    input:
        campaign=asked_campaign,
    output:
        checks=f"results/{LOOKED_AT}/quicklook_checks.csv",
        text=f"results/{LOOKED_AT}/quicklook_checks.txt",
        figure=[f"results/{LOOKED_AT}/quicklook.{kind}" for kind in ("png", "pdf", "csv", "txt")],
    log:
        f"results/{LOOKED_AT}/logs/quicklook.log",
    benchmark:
        f"results/{LOOKED_AT}/benchmarks/quicklook.tsv"
    threads: 1
    resources:
        mem_mb=memory(4000),
        runtime=minutes(10),
    params:
        library=library("quicklook"),
        campaign=REQUEST.get("campaign"),
    message:
        f"Quick look at {LOOKED_AT}: results/{LOOKED_AT}/quicklook.png"
    script:
        "../scripts/quicklook.py"


rule equivalent:
    """Equivalent k and c of a measured tube: --config equivalent_of=FILE.nc [model=FILE.yaml]."""
    input:
        campaign=(
            measured_campaign
            if WITHOUT_MODEL
            else after_model_checks(MODEL_FILES, measured_campaign)
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
