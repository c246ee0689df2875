# Convergence of the tube of the default study: frequencies with mesh and contact points, runs with
# step and modes, spectra with averages.
CONVERGENCE = {
    "frequencies": ("mesh", "contact_points", "contact_points_refined"),
    "statistics": ("period", "statistics"),
    "spectra": ("averages", "leakage", "impacts"),
}
CONVERGENCE_FIGURES = {
    "frequencies": ("mesh", "contact_points"),
    "statistics": ("step", "statistics_step", "statistics_modes"),
    "spectra": ("spectra",),
}
CONVERGENCE_AXES = ("step", "step_exact", "modes", "modes_alone")


# A topic's tables, its checks last; its figures, their data and captions.
CONVERGENCE_TABLES = {
    topic: [
        *(f"results/validation/convergence_{name}.csv" for name in names),
        f"results/validation/checks_convergence_{topic}.csv",
    ]
    for topic, names in CONVERGENCE.items()
}
CONVERGENCE_FIGURE_FILES = {
    topic: [
        f"results/validation/figures/validation_convergence_{name}.{suffix}"
        for name in names
        for suffix in ("png", "pdf", "csv", "txt")
    ]
    for topic, names in CONVERGENCE_FIGURES.items()
}


wildcard_constraints:
    axis="|".join(CONVERGENCE_AXES),


rule _validation_convergence_frequencies:
    output:
        tables=CONVERGENCE_TABLES["frequencies"],
        figures=CONVERGENCE_FIGURE_FILES["frequencies"],
    log:
        "results/validation/logs/convergence_frequencies.log",
    benchmark:
        "results/validation/benchmarks/convergence_frequencies.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=evidence("validation_convergence_frequencies"),
        config=settings("validation"),
    message:
        "Convergence of frequencies with mesh and contact points"
    script:
        "../scripts/validation_convergence_frequencies.py"


rule _validation_convergence_runs:
    output:
        table="results/validation/convergence_runs_{axis}.csv",
    log:
        "results/validation/logs/convergence_runs_{axis}.log",
    benchmark:
        "results/validation/benchmarks/convergence_runs_{axis}.tsv"
    threads: 1
    resources:
        mem_mb=memory(2000),
        runtime=minutes(30),
    params:
        library=evidence("validation_convergence_runs"),
        config=settings("validation"),
    message:
        "Impacting runs along the axis {wildcards.axis}"
    script:
        "../scripts/validation_convergence_runs.py"


rule _validation_convergence_statistics:
    input:
        runs=expand("results/validation/convergence_runs_{axis}.csv", axis=CONVERGENCE_AXES),
    output:
        tables=CONVERGENCE_TABLES["statistics"],
        figures=CONVERGENCE_FIGURE_FILES["statistics"],
    log:
        "results/validation/logs/convergence_statistics.log",
    benchmark:
        "results/validation/benchmarks/convergence_statistics.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=evidence("validation_convergence_statistics"),
        config=settings("validation"),
    message:
        "Convergence of linear modes, energy and response statistics with step and modes"
    script:
        "../scripts/validation_convergence_statistics.py"


rule _validation_convergence_spectra:
    output:
        tables=CONVERGENCE_TABLES["spectra"],
        figures=CONVERGENCE_FIGURE_FILES["spectra"],
    log:
        "results/validation/logs/convergence_spectra.log",
    benchmark:
        "results/validation/benchmarks/convergence_spectra.tsv"
    threads: 1
    resources:
        mem_mb=memory(2500),
        runtime=minutes(20),
    params:
        library=evidence("validation_convergence_spectra"),
        config=settings("validation"),
    message:
        "Effective averages and leakage of spectra, scatter over seeds with impacts"
    script:
        "../scripts/validation_convergence_spectra.py"
