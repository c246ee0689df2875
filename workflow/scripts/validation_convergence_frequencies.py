"""Frequencies against mesh and contact points: rows, checks, figures."""

import sys
from pathlib import Path

from vibroimpact.config import check_config
from vibroimpact.figures import validation_convergence
from vibroimpact.records import write_table
from vibroimpact.validation import convergence_contact_points, convergence_mesh

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config = check_config(snakemake.params.config, "the study's configuration")
mesh = convergence_mesh.mesh_rows(config)
points, refined = convergence_contact_points.contact_point_rows(config), convergence_contact_points.refinement_rows(config)
checks = convergence_mesh.mesh_checks(mesh) + convergence_contact_points.checks(config, points, refined)
for rows, path in zip((mesh, points, refined, [check.row() for check in checks]), snakemake.output.tables, strict=True):
    write_table(rows, path)
for sheet in validation_convergence.mesh(mesh) + validation_convergence.contact_points(points, refined):
    sheet.save(Path(snakemake.output.figures[0]).parent)
