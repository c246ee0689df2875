# Every figure as PNG and PDF, its data as CSV, its caption as text; study_files.smk names them.


rule _figures_model:
    input:
        quality=f"{RESULTS}/basis_quality.csv",
    output:
        figures=reported_figures("model"),
    log:
        f"{RESULTS}/logs/figures_model.log",
    benchmark:
        f"{RESULTS}/benchmarks/figures_model.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=library("figures_model"),
        config=settings("figures_model"),
    message:
        "Figures: layout, modes, contact law, first frequency, reduced model"
    script:
        "../scripts/figures_model.py"


rule _figures_response:
    input:
        model=f"{RESULTS}/model.nc",
        campaign=STUDY.overlay.campaign or f"{RESULTS}/synthetic_campaign.nc",
        spectra=files_of_study("spectra"),
    output:
        figures=reported_figures("response"),
    log:
        f"{RESULTS}/logs/figures_response.log",
    benchmark:
        f"{RESULTS}/benchmarks/figures_response.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=library("figures_response"),
        config=settings("figures_response"),
    message:
        "Figures: campaign over simulation, responses against load, in-plane share"
    script:
        "../scripts/figures_response.py"


rule _figures_identification:
    input:
        model=f"{RESULTS}/model.nc",
        spectra=files_of_study("spectra"),
        curves=files_of_study("estimates"),
        table=f"{RESULTS}/consistency.csv",
    output:
        figures=reported_figures("identification"),
    log:
        f"{RESULTS}/logs/figures_identification.log",
    benchmark:
        f"{RESULTS}/benchmarks/figures_identification.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=library("figures_identification"),
        config=settings("figures_identification"),
    message:
        "Figures: poles, stabilisation, shapes, singular values, broadband"
    script:
        "../scripts/figures_identification.py"


rule _figures_checks:
    input:
        model=f"{RESULTS}/model.nc",
        records=files_of_study("records"),
        table=f"{RESULTS}/consistency.csv",
    output:
        figures=reported_figures("checks"),
    log:
        f"{RESULTS}/logs/figures_checks.log",
    benchmark:
        f"{RESULTS}/benchmarks/figures_checks.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=library("figures_checks"),
        config=settings("figures_checks"),
    message:
        "Figures: equivalent support, collapse, energy balance, contact statistics"
    script:
        "../scripts/figures_checks.py"
