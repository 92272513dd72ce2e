# SPDX-License-Identifier: GPL-3.0-or-later
"""What all tests share: hypothesis without a deadline, since two cores may be busy with other lanes; files."""

import shutil
from pathlib import Path

import pytest
from hypothesis import settings
from layer_files import make_layer_files

settings.register_profile("isograft", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("isograft")


@pytest.fixture(scope="session")
def made_layer_files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """See layer_files.py."""
    folder = tmp_path_factory.mktemp("layers")
    make_layer_files(folder)
    return folder


@pytest.fixture
def layer_folder(made_layer_files: Path, tmp_path: Path) -> Path:
    """A copy of those files, to write to."""
    return Path(shutil.copytree(made_layer_files, tmp_path / "files"))
