# Structure -> reduced model -> simulation -> spectra and statistics; a stand-in for the measured
# campaign of figure 5, where overlay.campaign names no file.
from vibroimpact.study.cases import nearest_loads


rule _basis:
    input:
        matrices=after_model_checks(STUDY_FILES, matrix_files()),
    output:
        model=f"{RESULTS}/model.nc",
        quality=reported(f"{RESULTS}/basis_quality.csv", "basis_quality_table"),
        accuracy=reported(f"{RESULTS}/model_accuracy.csv"),
    log:
        f"{RESULTS}/logs/basis.log",
    benchmark:
        f"{RESULTS}/benchmarks/basis.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=library("basis"),
        config=settings("basis"),
    message:
        "Reduced model of the structure, and its quality against the full model"
    script:
        "../scripts/basis.py"


# One job per batch of cases (rules _simulate_from_0.5 and so on): they are integrated side by side,
# with one file of each kind per case. Where the time series are kept, spectra are made from those
# files by a job of their own. Otherwise the simulation makes them and writes no series. Without an
# identification there are no spectra.
for BATCH, BATCH_CASES in TO_SERIES.items():

    rule _simulate:
        name:
            f"_simulate_{BATCH}"
        input:
            model=f"{RESULTS}/model.nc",
            force=STUDY.excitation.file if STUDY.excitation.kind == "measured" else [],
        output:
            records=files_of_cases("records", BATCH_CASES),
            series=files_of_cases("timeseries", BATCH_CASES if KEPT else []),
        log:
            f"{RESULTS}/logs/simulate_{BATCH}.log",
        benchmark:
            f"{RESULTS}/benchmarks/simulate_{BATCH}.tsv"
        threads: 1
        resources:
            mem_mb=memory(1000),
            runtime=minutes(60),
        params:
            library=library("simulate"),
            config=settings("simulate"),
        message:
            f"Simulation {work_on(BATCH_CASES)}"
        script:
            "../scripts/simulate.py"


for BATCH, BATCH_CASES in TO_SPECTRA.items():

    rule _simulate_to_spectra:
        name:
            f"_simulate_to_spectra_{BATCH}"
        input:
            model=f"{RESULTS}/model.nc",
            force=STUDY.excitation.file if STUDY.excitation.kind == "measured" else [],
        output:
            records=files_of_cases("records", BATCH_CASES),
            spectra=files_of_cases("spectra", BATCH_CASES),
        log:
            f"{RESULTS}/logs/simulate_{BATCH}.log",
        benchmark:
            f"{RESULTS}/benchmarks/simulate_{BATCH}.tsv"
        threads: 1
        resources:
            mem_mb=memory(1000),
            runtime=minutes(60),
        params:
            library=library("simulate_to_spectra"),
            config=settings("simulate_to_spectra"),
        message:
            f"Simulation {work_on(BATCH_CASES)}"
        script:
            "../scripts/simulate_to_spectra.py"


for BATCH, BATCH_CASES in TO_SERIES.items():

    rule _spectra:
        name:
            f"_spectra_{BATCH}"
        input:
            series=files_of_cases("timeseries", BATCH_CASES),
        output:
            spectra=files_of_cases("spectra", BATCH_CASES),
        log:
            f"{RESULTS}/logs/spectra_{BATCH}.log",
        benchmark:
            f"{RESULTS}/benchmarks/spectra_{BATCH}.tsv"
        threads: 1
        resources:
            mem_mb=memory(1000),
            runtime=minutes(20),
        params:
            library=library("spectra"),
            config=settings("spectra"),
        message:
            f"Spectra {work_on(BATCH_CASES)}"
        script:
            "../scripts/spectra.py"


rule _statistics:
    input:
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
        library=library("statistics"),
        config=settings("statistics"),
    message:
        "Contact, wear and stress statistics of every case, as one table"
    script:
        "../scripts/statistics.py"


rule _synthetic_campaign:
    input:
        model=f"{RESULTS}/model.nc",
        force=STUDY.excitation.file if STUDY.excitation.kind == "measured" else [],
    output:
        campaign=f"{RESULTS}/synthetic_campaign.nc",
    log:
        f"{RESULTS}/logs/synthetic_campaign.log",
    benchmark:
        f"{RESULTS}/benchmarks/synthetic_campaign.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(20),
    params:
        library=library("synthetic_campaign"),
        config=settings("synthetic_campaign"),
        loads=nearest_loads(STUDY.grid, STUDY.overlay.load_rms_N),
    message:
        "Synthetic campaign to lay over the simulation"
    script:
        "../scripts/synthetic_campaign.py"
