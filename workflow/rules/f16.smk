# Optional: the ground vibration test of an F-16. `snakemake -j2 f16 --config f16_data=FOLDER`


rule f16:
    input:
        completion_files("f16"),
        library=library("f16"),
        records=lambda wildcards: files_of_structure("f16"),
    output:
        poles="results/f16/poles.csv",
    log:
        "results/f16/logs/f16.log",
    benchmark:
        "results/f16/benchmarks/f16.tsv"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        config=settings("f16"),
    message:
        "Pole and shape of the F-16 near 7.3 Hz, by peak and by LSCF"
    script:
        "../scripts/f16.py"
