# A stand-in for the measured campaign of figure 5, where overlay.campaign names no file.
from vibroimpact.study.cases import nearest_loads


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
