"""Each module has its tests where its name says: host/tilenca/ROOM/x.py in test/ROOM/test_x.py."""

from pathlib import Path

from support.order import LONG, rank
from tilenca.base import paths

PACKAGE, TESTS = paths.ROOT / "host" / "tilenca", paths.ROOT / "test"

# Modules without such a file, and why. The list only shrinks: what has its tests is struck off.
WITHOUT: dict[str, str] = {
    "commands/emulate_runs.py": "the second half of `tilenca emulate`: commands/test_emulate.py runs it",
    "training/progress.py": "a record and its type: nothing in it runs",
}


def mirror(module: Path) -> Path:
    """Where the tests of a module are."""
    return TESTS / module.relative_to(PACKAGE).with_name(f"test_{module.name}")


def test_every_module_has_its_tests_where_its_name_says() -> None:
    modules = [path for path in PACKAGE.rglob("*.py") if path.name != "__init__.py"]
    without = {str(path.relative_to(PACKAGE)) for path in modules if not mirror(path).exists()}
    assert without - WITHOUT.keys() == set(), "write a test of that name"
    assert WITHOUT.keys() - without == set(), "strike it off the list: it has its tests, or is gone"


def test_every_reason_is_given() -> None:
    assert [module for module, reason in WITHOUT.items() if len(reason.split()) < 3] == []


def test_files_with_long_tests_begin_first() -> None:
    assert [name for name in LONG if not (TESTS / name).is_file()] == [], (
        "strike it off the list, or correct it"
    )
    ranks = [rank(TESTS / name) for name in LONG]
    assert ranks == sorted(set(ranks))
    assert ranks[-1] < rank(Path(__file__))
