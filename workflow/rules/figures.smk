# Every figure as PNG and PDF, its data as CSV, its caption as text, named in study_files.smk. The
# page of a study.


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


rule _study_page:
    input:
        page=page_files("study_page"),
        model=f"{RESULTS}/model.nc",
        accuracy=f"{RESULTS}/model_accuracy.csv",
        records=files_of_study("records"),
        series=series_shown(),
        spectra=files_of_study("spectra") if STUDY.identification is not None else [],
        curves=files_of_study("estimates") if STUDY.identification is not None else [],
        tables=(
            [f"{RESULTS}/{name}.csv" for name in TABLES]
            if STUDY.identification is not None
            else []
        ),
        figures=[f"{RESULTS}/figures/{name}.png" for name in figures_of_study()],
        captions=[caption_file(name) for name in figures_of_study()],
    output:
        page=f"{RESULTS}/index.html",
        wear=[f"{RESULTS}/wear.csv"] if STUDY.wear is not None else [],
    log:
        f"{RESULTS}/logs/study_page.log",
    benchmark:
        f"{RESULTS}/benchmarks/study_page.tsv"
    threads: 1
    resources:
        mem_mb=memory(1000),
        runtime=minutes(10),
    params:
        library=library("study_page"),
        config=settings("study_page"),
        jobs=[
            [f"{RESULTS}/{folder}/{job}.{suffix}" for job in jobs_of_study()[:-1]]
            for folder, suffix in (("benchmarks", "tsv"), ("logs", "log"))
        ],
    message:
        f"Page of the study: {RESULTS}/index.html"
    script:
        "../scripts/study_page.py"
