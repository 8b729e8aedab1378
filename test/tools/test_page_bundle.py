"""The bundle of the page that needs no server of its own has all that it loads."""

import json
import random
from functools import partial
from pathlib import Path

import pytest

from release import page_bundle
from release.page_bundle import BundleError, lay_out, main
from tilenca.base import paths
from tilenca.page.alone import BEHIND
from tilenca.page.chosen import ModelOffer
from tilenca.page.joined import JoinError, joined
from tilenca.page.offer import load_offer


@pytest.fixture
def web(tmp_path: Path, firmware: Path) -> Path:
    """What `make web` builds, with a module that imports another, and no real WebAssembly."""
    folder = tmp_path / "web"
    (folder / "stream").mkdir(parents=True)
    (folder / "stream" / "worker.js").write_text('import { Tile } from "../tile.js";\n// from "./none.js";\n')
    (folder / "tile.js").write_text(
        'import {\n  one,\n  two,\n} from "./sides.js";\nexport { a } from "./a.js";\n'
    )
    (folder / "sides.js").write_text("export const one = 1;\n")
    (folder / "a.js").write_text("export const a = 2;\n")
    (folder / "simulator.js").write_text("")
    (folder / "tilenca_emulator.wasm").write_bytes(b"\0asm")
    (folder / "firmware.elf").write_bytes(firmware.read_bytes())
    return folder


def test_it_has_the_page_the_emulator_and_what_is_offered(web: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    (out / "old").mkdir(parents=True)
    assert main([str(web), str(out)]) == 0
    files = {str(path.relative_to(out)) for path in out.rglob("*") if path.is_file()}
    page = {str(path.relative_to(paths.PAGE)) for path in paths.PAGE.rglob("*") if path.is_file()}
    beside = ["stream/worker.js", "tilenca_emulator.wasm", "firmware.elf", "offer.json"]
    documents = {name for name in page if not name.endswith(".js")}
    assert files == documents | {"main.js", "compare.js", "alone.html"} | {
        f"emulator/{name}" for name in beside
    }
    assert (out / "emulator" / "stream" / "worker.js").read_text() == joined(web, "stream/worker.js")
    assert BEHIND.format("emulator") in (out / "index.html").read_text()
    offer = json.loads((out / "emulator" / "offer.json").read_text())
    assert (offer["period_ms"], offer["updates"]) == (20, 0)
    assert offer["stream"]["drawings"][8]["name"] == "digits/8"


def test_what_is_not_built_is_named(web: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (web / "sides.js").unlink()
    with pytest.raises(JoinError, match=r"sides\.js: No such file"):
        lay_out(web, tmp_path / "half")
    (web / "sides.js").touch()
    (web / "tilenca_emulator.wasm").unlink()
    with pytest.raises(BundleError, match=r"tilenca_emulator.wasm: not there"):
        lay_out(web, tmp_path / "out")
    assert main([str(web), str(tmp_path / "out")]) == 4
    assert capsys.readouterr().err.startswith("page_bundle: ")
    assert not (tmp_path / "out").exists()


def test_a_model_that_cannot_be_added_is_named(
    web: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(web), str(tmp_path / "out"), "nonsense"]) == 4
    told = capsys.readouterr().err
    assert "nonsense: no model to add; there are " in told
    assert " digits-40, " in told


def test_a_model_without_room_is_left_out_and_those_after_it_are_not(
    web: Path,
    tmp_path: Path,
    firmware: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    large = tmp_path / "large.elf"
    large.write_bytes(random.Random(1).randbytes(page_bundle.MOST_GZIPPED))
    images = {"large": large, "small": firmware, "huge": large}
    models = [
        ModelOffer(name, index, load_offer(), partial(Path, image), lambda event: firmware)
        for index, (name, image) in enumerate(images.items())
    ]
    monkeypatch.setattr(page_bundle, "chosen", lambda names: models)
    out = tmp_path / "out"
    lay_out(web, out, list(images))
    assert {path.name for path in (out / "emulator" / "models").iterdir()} == {"small.elf", "small.json"}
    told = capsys.readouterr().err
    assert "large: left out" in told
    assert "huge: left out" in told
    assert "small" not in told


def test_it_wants_two_folders(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 2
    assert "usage" in capsys.readouterr().err
