# The Silverbox, an electronic Duffing oscillator:
# `snakemake -j2 silverbox --config silverbox_data=FOLDER`

SILVERBOX = f"{EXAMPLES}/silverbox"
complete(
    "silverbox", campaign="results/silverbox/silverbox.nc", model=f"{SILVERBOX}/structure.yaml"
)


rule silverbox:
    """Example: the springs of an electronic oscillator, --config silverbox_data=FOLDER."""
    input:
        report="results/silverbox/report.html",
        model="results/silverbox/model_updated.yaml",
        published="results/silverbox/published.csv",
    message:
        "The Silverbox: results/silverbox/report.html"


rule _silverbox_records:
    input:
        program=f"{SILVERBOX}/records.py",
        records=downloaded(
            "silverbox_data",
            "../shared/data/silverbox",
            "SNJP_?m_full_FNSI_*.mat",
            "the Silverbox records (Noel and Schoukens, 2017)",
        ),
    output:
        campaign="results/silverbox/silverbox.nc",
    log:
        "results/silverbox/logs/silverbox_records.log",
    benchmark:
        "results/silverbox/benchmarks/silverbox_records.tsv"
    threads: 1
    resources:
        mem_mb=memory(1500),
        runtime=minutes(10),
    params:
        library=library_of(f"{SILVERBOX}/records.py"),
        python=PYTHON,
    message:
        "Records of the Silverbox as a campaign"
    shell:
        "{params.python} {input.program:q} {output.campaign:q} {input.records:q} > {log:q} 2>&1"


rule _silverbox_published:
    input:
        program=f"{SILVERBOX}/published.py",
        verdict="results/silverbox/verdict.json",
        completed="results/silverbox/completed.json",
    output:
        table="results/silverbox/published.csv",
    log:
        "results/silverbox/logs/silverbox_published.log",
    benchmark:
        "results/silverbox/benchmarks/silverbox_published.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=library_of(f"{SILVERBOX}/published.py"),
        python=PYTHON,
    message:
        "Coefficients of the Silverbox beside the published ones"
    shell:
        "{params.python} {input.program:q} {output.table:q} {input.verdict:q} {input.completed:q}"
        " > {log:q} 2>&1"
