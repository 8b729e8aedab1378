"""The page as one file: everything is in it, and the recording cannot break out of its place."""

import json
import re
import shutil
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tilenca.base import paths
from tilenca.page.alone import HOLE, AloneError, page_alone, with_recording
from tilenca.page.joined import JoinError, joined

DOCUMENT = page_alone(paths.PAGE)


def test_nothing_is_asked_of_anybody() -> None:
    assert "default-src 'none'" in DOCUMENT
    assert "connect-src" not in DOCUMENT
    assert re.findall(r'(?:src|href)="(?!data:|#)[^"]+"', DOCUMENT) == []
    assert DOCUMENT.count("<style>") == (paths.PAGE / "index.html").read_text(encoding="utf-8").count(
        'rel="stylesheet"'
    )
    assert DOCUMENT.count(HOLE) == 1


def test_its_program_stands_in_one_script_that_nothing_ends_early() -> None:
    programs = re.findall(r'<script type="module">(.*?)</script>', DOCUMENT, re.DOTALL)
    assert [program.replace(r"\x3C", "<").strip() for program in programs] == [
        joined(paths.PAGE, "main.js").strip()
    ]
    assert not re.search(r"<!--|<script", programs[0])


@given(st.text())
def test_a_recording_stays_in_its_place_and_is_what_it_was(text: str) -> None:
    line = json.dumps({"time": 0, "port": text, "raw": "</script><script>alert(1)</script>"})
    document = with_recording(DOCUMENT, line)
    assert HOLE not in document
    found = re.search(r'id="recording">\n(.*?)</script>', document, re.DOTALL)
    assert found is not None
    assert json.loads(found[1]) == json.loads(line)


def test_a_page_that_lacks_a_module_or_its_marks_is_refused(tmp_path: Path) -> None:
    broken = tmp_path / "page"
    shutil.copytree(paths.PAGE, broken)
    (broken / "stream" / "led.js").unlink()
    with pytest.raises(JoinError, match=r"led\.js: No such file"):
        page_alone(broken)
    (broken / "index.html").write_text("<p>none</p>")
    with pytest.raises(AloneError, match="what stands behind it"):
        page_alone(broken)
