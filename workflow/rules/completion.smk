# Measured structures (f16, silverbox): records by their lines, linear models, a job per candidate effect, verdict, prediction, figures.


rule _completion_records:
    input:
        library=library("completion_records"),
        records=measured_files,
    output:
        campaign="results/{structure}/campaign.nc",
    log:
        "results/{structure}/logs/completion_records.log",
    benchmark:
        "results/{structure}/benchmarks/completion_records.tsv"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=30,
    params:
        config=settings("completion_records"),
    message:
        "Records of {wildcards.structure} as a campaign"
    script:
        "../scripts/completion_records.py"


rule _completion_linear:
    input:
        library=library("completion_linear"),
        campaign="results/{structure}/campaign.nc",
    output:
        linear="results/{structure}/linear.json",
        mounting="results/{structure}/mounting.csv",
    log:
        "results/{structure}/logs/completion_linear.log",
    benchmark:
        "results/{structure}/benchmarks/completion_linear.tsv"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=30,
    params:
        config=settings("completion"),
    message:
        "Linear models of {wildcards.structure}, level by level"
    script:
        "../scripts/completion_linear.py"


rule _completion_candidate:
    input:
        library=library("completion_candidate"),
        campaign="results/{structure}/campaign.nc",
        linear="results/{structure}/linear.json",
        study=own_study_file,
    output:
        candidate="results/{structure}/candidates/{law}.json",
    log:
        "results/{structure}/logs/candidate_{law}.log",
    benchmark:
        "results/{structure}/benchmarks/candidate_{law}.tsv"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=30,
    params:
        config=settings("completion"),
    message:
        "{wildcards.structure}: {wildcards.law}"
    script:
        "../scripts/completion_candidate.py"


rule _completion_addition:
    input:
        library=library("completion_addition"),
        campaign="results/{structure}/campaign.nc",
        linear="results/{structure}/linear.json",
        singles=candidate_files,
        study=own_study_file,
    output:
        candidate="results/{structure}/additions/{law}.json",
    log:
        "results/{structure}/logs/addition_{law}.log",
    benchmark:
        "results/{structure}/benchmarks/addition_{law}.tsv"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=30,
    params:
        config=settings("completion"),
    message:
        "{wildcards.structure}: {wildcards.law} as second effect"
    script:
        "../scripts/completion_addition.py"


rule _completion_verdict:
    input:
        library=library("completion_verdict"),
        campaign="results/{structure}/campaign.nc",
        linear="results/{structure}/linear.json",
        singles=candidate_files,
        additions=addition_files,
    output:
        verdict="results/{structure}/verdict.json",
        prediction="results/{structure}/prediction.csv",
        completed="results/{structure}/completed.json",
        model="results/{structure}/model_updated.yaml",
    log:
        "results/{structure}/logs/completion_verdict.log",
    benchmark:
        "results/{structure}/benchmarks/completion_verdict.tsv"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=30,
    params:
        config=settings("completion"),
    message:
        "{wildcards.structure}: verdict and prediction of every level"
    script:
        "../scripts/completion_verdict.py"


rule _completion_figures:
    input:
        library=library("completion_figures"),
        campaign="results/{structure}/campaign.nc",
        linear="results/{structure}/linear.json",
        mounting="results/{structure}/mounting.csv",
        prediction="results/{structure}/prediction.csv",
        verdict="results/{structure}/verdict.json",
        completed="results/{structure}/completed.json",
    output:
        figures=completion_figure_files("{structure}"),
    log:
        "results/{structure}/logs/completion_figures.log",
    benchmark:
        "results/{structure}/benchmarks/completion_figures.tsv"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=30,
    params:
        config=settings("completion"),
    message:
        "{wildcards.structure}: figures"
    script:
        "../scripts/completion_figures.py"
