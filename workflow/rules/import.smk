# Raw measurements to a campaign file, and a first look at one.


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
