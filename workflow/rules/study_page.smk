# The page of a study, from its tables, records, spectra and figures.


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
