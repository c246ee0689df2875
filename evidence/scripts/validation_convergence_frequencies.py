"""Frequencies against mesh and contact points: rows, checks, figures."""

from pathlib import Path

from evidence.validation.convergence import (
    contact_points as convergence_contact_points,
)
from evidence.validation.convergence import (
    mesh as convergence_mesh,
)
from evidence.validation.figures import convergence as validation_convergence
from vibroimpact.config.reading import check_config
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import write_table
from vibroimpact.reports.figures.drawing import save_plots

redirect_output(snakemake.log[0])
config = check_config(snakemake.params.config, "the study's configuration")
mesh = convergence_mesh.mesh_rows(config)
points = convergence_contact_points.contact_point_rows(config)
refined = convergence_contact_points.refinement_rows(config)
checks = convergence_mesh.mesh_checks(mesh) + convergence_contact_points.checks(
    config, points, refined
)
for rows, path in zip(
    (mesh, points, refined, [check.row() for check in checks]), snakemake.output.tables, strict=True
):
    write_table(rows, path)
plots = validation_convergence.mesh(mesh) + validation_convergence.contact_points(points, refined)
save_plots(plots, Path(snakemake.output.figures[0]).parent)
