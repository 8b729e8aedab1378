"""A file is whole or not at all."""

import resource
from pathlib import Path

import pytest

from tilenca.base.errors import TilencaError, UsageError
from tilenca.base.whole_file import write_whole


def test_the_new_content_takes_the_place_of_the_old(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    for content in (b"old", b"new"):
        write_whole(path, content, "make room there")
        assert path.read_bytes() == content
    assert list(tmp_path.iterdir()) == [path]


def test_a_disk_that_fills_up_leaves_the_file_before_and_no_half_one(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_bytes(b"before")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(TilencaError, match=r"table\.csv: File too large; make room there$"):
            write_whole(path, bytes(5000), "make room there")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert path.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_is_a_file_is_told_with_the_error_that_is_asked_for(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(UsageError, match="Not a directory; give another"):
        write_whole(tmp_path / "file" / "table.csv", b"", "give another", UsageError)
