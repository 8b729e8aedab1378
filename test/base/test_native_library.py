"""Libraries that are missing, damaged, foreign or stale are said to be, in one line that names the remedy."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tilenca.base import native_library, paths
from tilenca.base.errors import BuildError
from tilenca.base.native_library import FOLDERS, Files, declarations, find, load, load_files

NAMES = sorted(FOLDERS)


@pytest.mark.parametrize("name", NAMES)
def test_a_library_is_what_its_header_says(name: str) -> None:
    library = load(name)
    version = getattr(library.lib, f"TILENCA_{name.upper()}_ABI_VERSION")
    assert getattr(library.lib, f"tilenca_{name}_abi_version")() == version
    sizes = [
        getattr(library.lib, f"tilenca_{name}_size_of")(kind)
        for kind in (b"tilenca_nothing", library.ffi.NULL)
    ]
    assert sizes == [0, 0]


@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_exported_but_what_the_header_declares(name: str) -> None:
    listing = subprocess.run(
        ["nm", "--dynamic", "--defined-only", str(find(name).library)],
        capture_output=True,
        text=True,
        check=True,
    )
    exported = {line.split()[-1] for line in listing.stdout.splitlines()}
    declared = set(re.findall(r"\b(tilenca_\w+)\(", find(name).header.read_text(encoding="utf-8")))
    assert (
        exported
        == declared
        == {function for function in dir(load(name).lib) if function.startswith("tilenca_")}
    )


def refused(name: str, library: Path, header: Path | None = None) -> str:
    """How the library is refused: one line that names it."""
    with pytest.raises(BuildError) as caught:
        load_files(name, Files(library, header or find(name).header))
    message = str(caught.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize("name", NAMES)
def test_a_missing_library_is_to_be_built(name: str, tmp_path: Path) -> None:
    path = tmp_path / "missing.so"
    remedy = "make setup-train" if name == "rollout" else "make setup"
    assert refused(name, path) == f"{path}: not built yet; run: {remedy}"
    assert refused(name, tmp_path).startswith(f"{tmp_path}: not built yet")  # a folder


@pytest.mark.parametrize("content", [b"", b"x", b"not a library" * 100, b"\x7fELF"])
def test_a_file_of_another_kind_is_no_library(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "other.so"
    path.write_bytes(content)
    assert refused("simulator", path) == f"{path}: no library; remove it and run: make setup"


def test_a_library_that_was_cut_short_is_refused_wherever_it_was_cut(tmp_path: Path) -> None:
    """The system's loader would read beyond the end of some of these, and end the program."""
    whole = find("simulator").library.read_bytes()
    path = tmp_path / "short.so"
    for part in range(1, 40):
        path.write_bytes(whole[: len(whole) * part // 40])
        assert refused("simulator", path) == f"{path}: cut short; remove it and run: make setup"
    path.write_bytes(whole[:-1])
    assert "cut short" in refused("simulator", path)


@pytest.mark.parametrize(
    ("place", "value"), [(18, b"\xb7\x00"), (18, b"\xf3\x00"), (4, b"\x01"), (5, b"\x02")]
)
def test_a_library_for_another_processor_is_refused(place: int, value: bytes, tmp_path: Path) -> None:
    whole = bytearray(find("simulator").library.read_bytes())
    if whole[place : place + len(value)] == value:
        pytest.skip("that is the kind of this machine")
    whole[place : place + len(value)] = value
    path = tmp_path / "foreign.so"
    path.write_bytes(whole)
    assert refused("simulator", path) == (
        f"{path}: for another kind of processor; remove it and run: make setup"
    )


def compiled(tmp_path: Path, source: str) -> Path:
    """A shared library of that C source, at a path of its own: the system loads each path once."""
    path = tmp_path / f"stand_in{len(list(tmp_path.iterdir()))}.so"
    command = ["gcc", "-shared", "-fPIC", "-x", "c", "-", "-o", str(path)]
    subprocess.run(command, input=source, text=True, check=True)
    return path


def stand_in(name: str, version: int, size: int, without: str = "") -> str:
    """A library with a header's functions, which all return 0 but for what the loader asks."""
    given = {f"tilenca_{name}_abi_version": version, f"tilenca_{name}_size_of": size}
    functions = {function for function in dir(load(name).lib) if function.startswith("tilenca_")} - {without}
    return "".join(
        f"long {function}(void) {{ return {given.get(function, 0)}; }}\n" for function in functions
    )


def version_of(name: str) -> int:
    return int(getattr(load(name).lib, f"tilenca_{name}_abi_version")())


@pytest.mark.parametrize("name", NAMES)
def test_a_library_of_another_version_is_stale(name: str, tmp_path: Path) -> None:
    path = compiled(tmp_path, stand_in(name, 999, 0))
    assert re.search(
        rf"^{path}: stale: .*number \(999\).*{name}\.h says; run: make setup", refused(name, path)
    )


@pytest.mark.parametrize("name", NAMES)
def test_a_library_with_other_structures_is_stale(name: str, tmp_path: Path) -> None:
    path = compiled(tmp_path, stand_in(name, version_of(name), 1))
    assert re.search(rf"^{path}: stale: tilenca_\w+ has 1 bytes, .*; run: make setup", refused(name, path))


@pytest.mark.parametrize("name", NAMES)
def test_a_library_without_one_of_the_functions_is_stale(name: str, tmp_path: Path) -> None:
    function = {"emulator": "tilenca_probe_bytes", "simulator": "tilenca_schedule_next"}.get(
        name, "tilenca_rollout_kind"
    )
    path = compiled(tmp_path, stand_in(name, version_of(name), 0, function))
    assert re.search(rf"^{path}: stale: .*{function}.*; run: make setup", refused(name, path))
    path = compiled(tmp_path, "int nothing;")
    assert re.search(rf"^{path}: not usable .*; remove it and run: make setup", refused(name, path))


@pytest.mark.parametrize("content", [None, b"\xff\xfe", b"int f(;", b"<<<<<<< ours\nint f(void);\n"])
def test_a_missing_or_damaged_header_is_named_with_a_remedy(content: bytes | None, tmp_path: Path) -> None:
    header = tmp_path / "simulator.h"
    if content is not None:
        header.write_bytes(content)
    message = refused("simulator", find("simulator").library, header)
    assert message.startswith(f"{header}: not the header of this version")
    assert message.endswith(f"run: git checkout -- {header}")


def test_a_command_ends_in_one_line_and_status_4(tmp_path: Path) -> None:
    (tmp_path / "libtilenca_simulator.so").write_bytes(b"not a library")
    done = subprocess.run(
        [sys.executable, "-m", "tilenca.cli", "simulate", "--shape", "4"],
        env=os.environ | {native_library.OTHER_FOLDER: str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert (done.returncode, done.stdout) == (4, "")
    assert len(done.stderr.splitlines()) == 1
    assert (
        f"{tmp_path}/libtilenca_simulator.so: no library; remove it and unset TILENCA_LIBRARIES"
        in done.stderr
    )


def test_what_is_for_the_preprocessor_is_left_out() -> None:
    for_cpp = '#ifdef __cplusplus\nextern "C" {\n#endif\n'
    header = f'#ifndef A\n#include "b.h"\n{for_cpp}TILENCA_API int f(void);\n#endif\n'
    assert declarations(header) == "int f(void);\n"


@pytest.mark.parametrize("name", NAMES)
def test_an_installed_package_has_its_libraries_inside(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert find(name).library.parent.name == "release"
    monkeypatch.setattr(paths, "CHECKOUT", None)
    monkeypatch.setattr(paths, "PACKAGE", tmp_path)
    library = tmp_path / "lib" / f"libtilenca_{name}.so"
    assert find(name) == Files(library, tmp_path / "lib" / "include" / "tilenca" / f"{name}.h")
    assert refused(name, library) == f"{library}: missing; run: pip install --force-reinstall tilenca-*.whl"


def test_threads_that_load_at_the_same_time_get_the_same_library() -> None:
    program = (
        "import sys\n"
        "from concurrent.futures import ThreadPoolExecutor\n"
        "from tilenca.base.native_library import load\n"
        "sys.setswitchinterval(1e-6)\n"
        "with ThreadPoolExecutor(8) as pool: found = list(pool.map(load, ['simulator'] * 8))\n"
        "print(len({id(library.ffi) for library in found}))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "1\n"
