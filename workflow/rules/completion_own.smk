# A campaign of one's own completed: `snakemake -j2 discrepancy --config campaign=FILE model=FILE.yaml`, structure.kind identified without modes.

from dataclasses import asdict

if OWN is not None:

    ruleorder: _completion_prepare > _completion_records
    ruleorder: _completion_prepare > _completion_linear
    ruleorder: _completion_outcome > _completion_verdict
    ruleorder: _completion_outcome > _discrepancy_verdict
    ruleorder: _completion_report > _discrepancy_report

    checkpoint _completion_prepare:
        input:
            library=library("completion_prepare"),
            campaign=requested("campaign", "FILE"),
        output:
            campaign=f"results/{LOOKED_AT}/campaign.nc",
            study=f"results/{LOOKED_AT}/study.json",
            linear=f"results/{LOOKED_AT}/linear.json",
            mounting=f"results/{LOOKED_AT}/mounting.csv",
        log:
            f"results/{LOOKED_AT}/logs/completion_prepare.log",
        benchmark:
            f"results/{LOOKED_AT}/benchmarks/completion_prepare.tsv"
        threads: 1
        resources:
            mem_mb=2000,
            runtime=30,
        params:
            structure=asdict(OWN),
        message:
            f"{LOOKED_AT}: records, linear models, places"
        script:
            "../scripts/completion_prepare.py"

    rule _completion_outcome:
        input:
            library=library("completion_outcome"),
            campaign=f"results/{LOOKED_AT}/campaign.nc",
            study=f"results/{LOOKED_AT}/study.json",
            linear=f"results/{LOOKED_AT}/linear.json",
            singles=lambda wildcards: law_files(LOOKED_AT, "candidates"),
            additions=lambda wildcards: law_files(LOOKED_AT, "additions"),
        output:
            verdict=f"results/{LOOKED_AT}/verdict.json",
            prediction=f"results/{LOOKED_AT}/prediction.csv",
            completed=f"results/{LOOKED_AT}/completed.json",
            model=f"results/{LOOKED_AT}/model_updated.yaml",
        log:
            f"results/{LOOKED_AT}/logs/completion_outcome.log",
        benchmark:
            f"results/{LOOKED_AT}/benchmarks/completion_outcome.tsv"
        threads: 1
        resources:
            mem_mb=1500,
            runtime=30,
        params:
            structure=asdict(OWN),
        message:
            f"{LOOKED_AT}: verdict and prediction of every level"
        script:
            "../scripts/completion_outcome.py"

    rule _completion_report:
        input:
            library=library("completion_report"),
            template=f"{SOURCE}/vibroimpact/reports/discrepancy_page.html",
            campaign=f"results/{LOOKED_AT}/campaign.nc",
            study=f"results/{LOOKED_AT}/study.json",
            linear=f"results/{LOOKED_AT}/linear.json",
            mounting=f"results/{LOOKED_AT}/mounting.csv",
            prediction=f"results/{LOOKED_AT}/prediction.csv",
            verdict=f"results/{LOOKED_AT}/verdict.json",
            completed=f"results/{LOOKED_AT}/completed.json",
        output:
            page=f"results/{LOOKED_AT}/report.html",
            figures=directory(f"results/{LOOKED_AT}/figures"),
        log:
            f"results/{LOOKED_AT}/logs/completion_report.log",
        benchmark:
            f"results/{LOOKED_AT}/benchmarks/completion_report.tsv"
        threads: 1
        resources:
            mem_mb=1500,
            runtime=10,
        params:
            name=LOOKED_AT,
        message:
            f"{LOOKED_AT}: results/{LOOKED_AT}/report.html"
        script:
            "../scripts/completion_report.py"
