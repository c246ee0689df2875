"""A finished tiny study, made once, and folders on small disks."""

import shutil
import subprocess

import pytest

from tests.support.tiny_study import TinyStudy, tiny_values


@pytest.fixture(scope="session")
def finished_study(tmp_path_factory):
    """A tiny study up to its tables: two loads, one gap, two seeds."""
    study = TinyStudy(tmp_path_factory.mktemp("finished"), tiny_values())
    study.simulate()
    study.identify()
    return study


@pytest.fixture
def study(finished_study, tmp_path):
    """A copy of the finished study that a test may damage."""
    shutil.copytree(finished_study.folder, tmp_path / "tiny")
    return TinyStudy(tmp_path, tiny_values())


@pytest.fixture
def small_disk(tmp_path):
    """mounted(options): the folder of a file system of its own, or a skip where none may be
    mounted.
    """
    folder = tmp_path / "disk"
    folder.mkdir()

    def mounted(options):
        command = ["mount", "-t", "tmpfs", "-o", options, "vibroimpact_test", str(folder)]
        if shutil.which("mount") is None or subprocess.run(command, capture_output=True).returncode:
            pytest.skip("no file system may be mounted here")
        return folder

    yield mounted
    while folder.is_mount():
        subprocess.run(["umount", "--lazy", str(folder)], check=True)
