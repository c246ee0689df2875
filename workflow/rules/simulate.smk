# One job per load: its gaps and seeds are integrated side by side, with one file of each kind per
# case. Where the time series are kept, spectra are made from those files by a rule of their own.
# Otherwise the simulation makes them and writes no series. Without an identification there are no
# spectra.
if KEPT or STUDY.identification is None:

    ruleorder: _simulate > _simulate_to_spectra
    ruleorder: _spectra > _simulate_to_spectra

else:

    ruleorder: _simulate_to_spectra > _spectra
    ruleorder: _simulate_to_spectra > _simulate


rule _simulate:
    input:
        library=library("simulate"),
        model=f"{RESULTS}/model.nc",
        force=STUDY.excitation.file if STUDY.excitation.kind == "measured" else [],
    output:
        records=files_of_load("records"),
        series=series_of_load(),
    log:
        f"{RESULTS}/logs/simulate_load_{{load}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/simulate_load_{{load}}.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(60),
    params:
        config=settings("simulate"),
    message:
        f"Simulation at {{wildcards.load}} N RMS: {CASES_PER_LOAD} of {len(CASES)} cases"
    script:
        "../scripts/simulate.py"


rule _simulate_to_spectra:
    input:
        library=library("simulate_to_spectra"),
        model=f"{RESULTS}/model.nc",
        force=STUDY.excitation.file if STUDY.excitation.kind == "measured" else [],
    output:
        records=files_of_load("records"),
        spectra=files_of_load("spectra"),
    log:
        f"{RESULTS}/logs/simulate_load_{{load}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/simulate_load_{{load}}.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(60),
    params:
        config=settings("simulate_to_spectra"),
    message:
        f"Simulation at {{wildcards.load}} N RMS: {CASES_PER_LOAD} of {len(CASES)} cases"
    script:
        "../scripts/simulate_to_spectra.py"


rule _spectra:
    input:
        library=library("spectra"),
        series=files_of_load("timeseries"),
    output:
        spectra=files_of_load("spectra"),
    log:
        f"{RESULTS}/logs/spectra_load_{{load}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/spectra_load_{{load}}.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(20),
    params:
        config=settings("spectra"),
    message:
        f"Spectra at {{wildcards.load}} N RMS: {CASES_PER_LOAD} of {len(CASES)} cases"
    script:
        "../scripts/spectra.py"


rule _statistics:
    input:
        library=library("statistics"),
        records=files_of_study("records"),
    output:
        table=reported(f"{RESULTS}/statistics.csv"),
    log:
        f"{RESULTS}/logs/statistics.log",
    benchmark:
        f"{RESULTS}/benchmarks/statistics.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        config=settings("statistics"),
    message:
        "Contact, wear and stress statistics of every case, as one table"
    script:
        "../scripts/statistics.py"
