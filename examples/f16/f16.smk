# The ground vibration test of an F-16: `snakemake -j2 f16 --config f16_data=FOLDER`

F16 = f"{EXAMPLES}/f16"
F16_FILES = downloaded(
    "f16_data",
    "../shared/data/f16_ground_vibration",
    "F16Data_FullMSine_Level*.mat",
    "the F-16 ground vibration test (Noel and Schoukens, 2017)",
)
complete("f16", campaign="results/f16/f16.nc", model=f"{F16}/structure.yaml")


rule f16:
    """Example: which effect makes an aircraft soften with the load, --config f16_data=FOLDER."""
    input:
        report="results/f16/report.html",
        model="results/f16/model_updated.yaml",
        poles="results/f16/poles.csv",
    message:
        "The F-16: results/f16/report.html"


rule _f16_records:
    input:
        program=f"{F16}/records.py",
        records=F16_FILES,
    output:
        campaign="results/f16/f16.nc",
    log:
        "results/f16/logs/f16_records.log",
    benchmark:
        "results/f16/benchmarks/f16_records.tsv"
    threads: 1
    resources:
        mem_mb=memory(1500),
        runtime=minutes(10),
    params:
        library=library_of(f"{F16}/records.py"),
        python=PYTHON,
    message:
        "Records of the F-16 as a campaign"
    shell:
        "{params.python} {input.program:q} {output.campaign:q} {input.records:q} > {log:q} 2>&1"


rule _f16_poles:
    input:
        program=f"{F16}/poles.py",
        records=F16_FILES,
    output:
        poles="results/f16/poles.csv",
    log:
        "results/f16/logs/f16_poles.log",
    benchmark:
        "results/f16/benchmarks/f16_poles.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=library_of(f"{F16}/poles.py"),
        python=PYTHON,
    message:
        "Pole and shape of the F-16 near 7.3 Hz, by peak and by LSCF"
    shell:
        "{params.python} {input.program:q} {output.poles:q} {input.records:q} > {log:q} 2>&1"
