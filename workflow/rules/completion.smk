# A structure identified from its own records: linear models, a job per candidate effect, verdict,
# prediction, report. It serves the examples and
# `snakemake -j2 discrepancy --config campaign=FILE model=FILE.yaml`, where the model is of kind
# identified and has no modes.


ruleorder: _completion_outcome > _diagnosis
ruleorder: _completion_report > _discrepancy_report


wildcard_constraints:
    structure="|".join(map(re.escape, COMPLETED)),


checkpoint _completion_prepare:
    input:
        campaign=campaign_completed,
    output:
        campaign="results/{structure}/campaign.nc",
        study="results/{structure}/study.json",
        linear="results/{structure}/linear.json",
        mounting="results/{structure}/mounting.csv",
    log:
        "results/{structure}/logs/completion_prepare.log",
    benchmark:
        "results/{structure}/benchmarks/completion_prepare.tsv"
    threads: 1
    resources:
        mem_mb=memory(2000),
        runtime=minutes(30),
    params:
        library=library("completion_prepare"),
        structure=structure_completed,
    message:
        "{wildcards.structure}: records, linear models, places"
    script:
        "../scripts/completion_prepare.py"


rule _completion_candidate:
    input:
        campaign="results/{structure}/campaign.nc",
        study="results/{structure}/study.json",
        linear="results/{structure}/linear.json",
    output:
        candidate="results/{structure}/candidates/{law}.json",
    log:
        "results/{structure}/logs/candidate_{law}.log",
    benchmark:
        "results/{structure}/benchmarks/candidate_{law}.tsv"
    threads: 1
    resources:
        mem_mb=memory(1500),
        runtime=minutes(30),
    params:
        library=library("completion_candidate"),
        law="{law}",
    message:
        "{wildcards.structure}: {wildcards.law}"
    script:
        "../scripts/completion_candidate.py"


rule _completion_addition:
    input:
        campaign="results/{structure}/campaign.nc",
        study="results/{structure}/study.json",
        linear="results/{structure}/linear.json",
        singles=candidate_files,
    output:
        candidate="results/{structure}/additions/{law}.json",
    log:
        "results/{structure}/logs/addition_{law}.log",
    benchmark:
        "results/{structure}/benchmarks/addition_{law}.tsv"
    threads: 1
    resources:
        mem_mb=memory(1500),
        runtime=minutes(30),
    params:
        library=library("completion_addition"),
        law="{law}",
    message:
        "{wildcards.structure}: {wildcards.law} as second effect"
    script:
        "../scripts/completion_addition.py"


rule _completion_outcome:
    input:
        campaign="results/{structure}/campaign.nc",
        study="results/{structure}/study.json",
        linear="results/{structure}/linear.json",
        singles=candidate_files,
        additions=addition_files,
    output:
        verdict="results/{structure}/verdict.json",
        prediction="results/{structure}/prediction.csv",
        completed="results/{structure}/completed.json",
        model="results/{structure}/model_updated.yaml",
    log:
        "results/{structure}/logs/completion_outcome.log",
    benchmark:
        "results/{structure}/benchmarks/completion_outcome.tsv"
    threads: 1
    resources:
        mem_mb=memory(1500),
        runtime=minutes(30),
    params:
        library=library("completion_outcome"),
        structure=structure_completed,
    message:
        "{wildcards.structure}: verdict and prediction of every level"
    script:
        "../scripts/completion_outcome.py"


rule _completion_report:
    input:
        template=f"{SOURCE}/vibroimpact/reports/discrepancy_page.html",
        campaign="results/{structure}/campaign.nc",
        study="results/{structure}/study.json",
        linear="results/{structure}/linear.json",
        mounting="results/{structure}/mounting.csv",
        prediction="results/{structure}/prediction.csv",
        verdict="results/{structure}/verdict.json",
        completed="results/{structure}/completed.json",
    output:
        page="results/{structure}/report.html",
        figures=directory("results/{structure}/figures"),
    log:
        "results/{structure}/logs/completion_report.log",
    benchmark:
        "results/{structure}/benchmarks/completion_report.tsv"
    threads: 1
    resources:
        mem_mb=memory(1500),
        runtime=minutes(10),
    params:
        library=library("completion_report"),
        name="{structure}",
    message:
        "{wildcards.structure}: results/{wildcards.structure}/report.html"
    script:
        "../scripts/completion_report.py"
