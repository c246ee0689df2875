"""Damaged, emptied and foreign files among the results: refused with a sentence, never used."""

import shutil
from pathlib import Path

import pytest
import xarray as xr

from vibroimpact.campaign.file import read_campaign
from vibroimpact.config.stage_keys import answer_digest
from vibroimpact.io.records import (
    RecordError,
    read_given_dataset,
    read_record,
    read_table,
    write_record,
)

REMEDY = "delete it and run again$"


def compare(study):
    """Run the comparison of the methods again."""
    names = ("table", "summary", "collapse", "equivalent", "dataset")
    outputs = {name: study.path(f"again_{name}") for name in names}
    tables = study.files("estimates", "csv")
    inputs = {"model": study.path("model.nc"), "tables": tables}
    study.run(
        "consistency", inputs, outputs, digest=answer_digest(study.config.model_dump(mode="json"))
    )
    return read_table(outputs["table"])


def identify(study):
    """Run the identification again."""
    study.run(
        "identify",
        {
            "model": study.path("model.nc"),
            "records": study.files("records"),
            "spectra": study.files("spectra"),
        },
        {"curves": study.files("estimates"), "tables": study.files("estimates", "csv")},
    )


def empty(path):
    """Leave no byte of a file."""
    path.write_bytes(b"")


def keep_header(path):
    """Leave the first line of a table."""
    path.write_text(path.read_text().splitlines(keepends=True)[0])


def cut_in_a_row(path):
    """Cut a table in the middle of a row."""
    path.write_text(path.read_text()[:-40])


def cut_after_a_row(path):
    """Leave out the last row of a table."""
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:-1]))


def repeat_a_row(path):
    """Write the last row of a table again in place of the one before."""
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join([*lines[:-2], lines[-1], lines[-1]]))


def put_zeros(path):
    """Keep the length of a file and no content, as a power failure may."""
    path.write_bytes(bytes(path.stat().st_size))


def copy_of_another_case(path):
    """Put the table of another seed in its place."""
    shutil.copy(path.with_name(path.name.replace("seed_1", "seed_0")), path)


TABLE_DAMAGES = {
    empty: "is empty",
    keep_header: "has 0 of 8 estimates",
    cut_in_a_row: "row 9 has .* values for .* columns",
    cut_after_a_row: "has 7 of 8 estimates.*'secant'",
    repeat_a_row: "has 8 of 8 estimates.*'statistical_linearisation'",
    put_zeros: "has 0 of 8 estimates",
    copy_of_another_case: "has rows of another case",
}


@pytest.mark.parametrize("damage", TABLE_DAMAGES, ids=lambda damage: damage.__name__)
def test_consistency_refuses_a_table_that_lacks_estimates(study, damage, reliability):
    path = Path(study.files("estimates", "csv")[-1])
    damage(path)
    with pytest.raises(RecordError, match=f"{path.name}: .*({TABLE_DAMAGES[damage]}).*{REMEDY}"):
        compare(study)
    assert not Path(study.path("again_table")).exists()
    reliability.fault(
        "a table of estimates is emptied, cut, or of another case",
        "refused: file, what is missing, remedy",
    )


def test_consistency_has_every_case_and_method(study):
    assert len(compare(study)) == 4 * 8
    assert (
        Path(study.path("again_table")).read_bytes()
        == Path(study.path("consistency.csv")).read_bytes()
    )


def cut_in_half(path):
    """Keep the first half of a file."""
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def put_foreign_netcdf(path):
    """Put a netCDF file of something else in its place."""
    write_record(xr.Dataset({"temperature": ("place", [290.0])}), path)


def put_other_case(path):
    """Put the file of another seed in its place."""
    shutil.copy(path.with_name(path.name.replace("seed_1", "seed_0")), path)


def put_other_study(path):
    """Put the file of the same case of another study in its place."""
    write_record(read_record(path).assign_attrs(study="another"), path)


NETCDF_DAMAGES = {
    empty: "cannot be read as netCDF",
    cut_in_half: "cannot be read as netCDF",
    put_zeros: "cannot be read as netCDF",
    put_foreign_netcdf: "has no variable '.*'",
    put_other_case: "is of case '.*seed_0', not of case '.*seed_1'",
    put_other_study: "is of study 'another', not of study 'tiny'",
}


@pytest.mark.parametrize("damage", NETCDF_DAMAGES, ids=lambda damage: damage.__name__)
@pytest.mark.parametrize("kind", ["records", "spectra"])
def test_identification_refuses_a_damaged_or_foreign_file(study, kind, damage, reliability):
    path = Path(study.files(kind)[-1])
    damage(path)
    with pytest.raises(RecordError, match=f"{path.name}: {NETCDF_DAMAGES[damage]}.*{REMEDY}"):
        identify(study)
    reliability.fault(
        "a netCDF result is cut, empty, foreign, or of another case or study",
        "refused: file, what is wrong, remedy",
    )


def test_statistics_refuse_a_foreign_record(study):
    put_foreign_netcdf(Path(study.files("records")[-1]))
    with pytest.raises(RecordError, match=f"states no case.*{REMEDY}"):
        study.run("statistics", {"records": study.files("records")}, {"table": study.path("t.csv")})


@pytest.mark.parametrize("damage", [empty, cut_in_half, put_zeros], ids=lambda made: made.__name__)
def test_a_broken_campaign_is_never_to_be_deleted(study, damage, reliability):
    path = Path(study.path("synthetic_campaign.nc"))
    damage(path)
    for read in (read_campaign, read_given_dataset):
        with pytest.raises(RecordError, match="campaign.nc: can ?not be read") as refusal:
            read(path)
        assert "delete" not in str(refusal.value)
    reliability.fault("a measured campaign is cut or empty", "refused; never told to delete it")
