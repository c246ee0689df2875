# Other codes as judges. `make judges` installs those in Python; judges_present.txt names the
# absent.
rule _validation_judges:
    output:
        checks="results/validation/checks_judges.csv",
        oval_bend="results/validation/oval_bend.csv",
        presence="results/validation/judges_present.txt",
        figures=[
            f"results/validation/figures/validation_judges.{suffix}"
            for suffix in ("png", "pdf", "csv", "txt")
        ],
    log:
        "results/validation/logs/judges.log",
    benchmark:
        "results/validation/benchmarks/judges.tsv"
    threads: 1
    resources:
        mem_mb=memory(2000),
        runtime=minutes(10),
    params:
        library=evidence("validation_judges"),
        config=settings("validation"),
    message:
        "Third-party codes judge frequencies, impacts, poles and spectra"
    script:
        "../scripts/validation_judges.py"
