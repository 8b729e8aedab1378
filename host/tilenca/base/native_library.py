"""The compiled C++ libraries, called as their public C headers declare them.

Signatures, constants and structures are written once, in C; cffi reads them from the header. Other Python
threads run while a function of a library does.

    simulator = load("simulator")
    simulator.lib.tilenca_simulator_abi_version()
"""

import os
import re
import sys
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from cffi import FFI, CDefError

from tilenca.base import paths
from tilenca.base.errors import BuildError, UsageError
from tilenca.base.project import install_remedy

# The libraries by name (libtilenca_NAME.so, NAME.h): the folder of their sources, and what builds them there.
FOLDERS = {"emulator": "emulator", "simulator": "simulator", "rollout": "rollout_kernel"}
REMEDIES = {"emulator": "run: make setup", "simulator": "run: make setup", "rollout": "run: make setup-train"}
# Another folder of libraries than the release build's, such as that of the sanitizers (CONTRIBUTING.md).
OTHER_FOLDER = "TILENCA_LIBRARIES"

NO_MEMORY = "out of memory"  # as c_api/guard.h says it

ELF_MAGIC = b"\x7fELF"
ELF_HEADER_BYTES = 64


@dataclass(frozen=True)
class Files:
    """Where a library and its public header are."""

    library: Path
    header: Path


class Library:
    """A library that is loaded.

    Attributes:
        ffi: makes and converts C values; knows the header's types.
        lib: has the header's functions and constants as attributes.
        name: a key of `FOLDERS`.
    """

    def __init__(self, ffi: Any, lib: Any, name: str) -> None:
        self.ffi, self.lib, self.name = ffi, lib, name
        self._functions: dict[str, Any] = {}  # those called so far

    def last_error(self) -> str:
        """Why the last function that failed in this thread did."""
        text = getattr(self.lib, f"tilenca_{self.name}_last_error")()
        return str(self.ffi.string(text).decode(errors="replace"))

    def call(self, function: str, *arguments: Any) -> Any:
        """Calls `tilenca_FUNCTION`; returns what it returns.

        Raises:
            MemoryError: there is not enough.
            UsageError: it returned null or a negative number for another reason; with the library's own
                words.
        """
        known = self._functions.get(function)
        if known is None:
            known = self._functions[function] = getattr(self.lib, f"tilenca_{function}")
        try:
            result = known(*arguments)
        except OverflowError as error:
            raise UsageError(f"{function.replace('_', ' ')}: {error}") from error
        kind = type(result)
        failed = result < 0 if kind is int or kind is float else result is not None and not result
        if failed:
            words = self.last_error()
            raise MemoryError(words) if words == NO_MEMORY else UsageError(words)
        return result


def find(name: str) -> Files:
    """The library and its header: those of the installed package, else those of the checkout."""
    file_name = f"libtilenca_{name}.so"
    if paths.CHECKOUT is None:
        installed = paths.PACKAGE / "lib"
        return Files(installed / file_name, installed / "include" / "tilenca" / f"{name}.h")
    built = Path(os.environ.get(OTHER_FOLDER) or paths.BUILD / "release")
    return Files(
        built / file_name, paths.CHECKOUT / "tools" / FOLDERS[name] / "include" / "tilenca" / f"{name}.h"
    )


_loaded: dict[str, Library] = {}
_loading = threading.Lock()


def load(name: str) -> Library:
    """The library of that name; the same for all threads, since C values of two loads do not mix.

    Raises:
        BuildError: it is missing, damaged, for another machine, or not of this version of the header; the
            message names the file and what to run.
    """
    found = _loaded.get(name)
    if found is None:
        with _loading:
            found = _loaded.get(name) or _loaded.setdefault(name, load_files(name, find(name)))
    return found


def load_files(name: str, files: Files) -> Library:
    """Like `load`, from the files given."""
    path = files.library
    remedy = _remedy(name)
    if not path.is_file():
        raise BuildError(f"{path}: {'not built yet' if paths.CHECKOUT else 'missing'}; {remedy}")
    ffi = FFI()
    try:
        ffi.cdef(declarations(files.header.read_text(encoding="utf-8")))
    except (OSError, UnicodeDecodeError, CDefError) as error:
        restore = f"git checkout -- {files.header}" if paths.CHECKOUT else install_remedy()
        raise BuildError(
            f"{files.header}: not the header of this version ({type(error).__name__}); run: {restore}"
        ) from error
    if fault := elf_fault(path):
        raise BuildError(f"{path}: {fault}; remove it and {remedy}")
    try:
        library = Library(ffi, ffi.dlopen(str(path)), name)
        version = getattr(library.lib, f"tilenca_{name}_abi_version")()
    except (OSError, AttributeError) as error:
        raise BuildError(f"{path}: not usable ({error}); remove it and {remedy}") from error
    if difference := _difference(library, version):
        raise BuildError(f"{path}: stale: {difference} than {files.header} says; {remedy}")
    return library


def _remedy(name: str) -> str:
    """What to do about a library that is missing or of no use."""
    if paths.CHECKOUT is None:
        return f"run: {install_remedy()}"
    if os.environ.get(OTHER_FOLDER):
        return f"unset {OTHER_FOLDER}, or build there: cmake --build --preset NAME"
    return REMEDIES[name]


def declarations(header: str) -> str:
    """A public header without what is for the preprocessor, as cffi reads it."""
    for_c = re.sub(r"^#ifdef __cplusplus\n.*?^#endif\n", "", header, flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"^#.*\n", "", for_c, flags=re.MULTILINE).replace("TILENCA_API ", "")


def _difference(library: Library, version: int) -> str:
    """How a loaded library differs from its header; "" if it does not."""
    ffi, lib, name = library.ffi, library.lib, library.name
    if version != getattr(lib, f"TILENCA_{name.upper()}_ABI_VERSION"):
        return f"its interface has another number ({version})"
    try:
        for function in dir(lib):
            getattr(lib, function)
    except AttributeError as error:
        return f"it has other functions ({error})"
    for structure in ffi.list_types()[0]:
        kind = ffi.typeof(structure)
        is_whole = kind.kind == "struct" and kind.fields is not None
        size = getattr(lib, f"tilenca_{name}_size_of")(structure.encode())
        if is_whole and size != ffi.sizeof(kind):
            return f"{structure} has {size} bytes, which is another size"
    return ""


def elf_fault(path: Path) -> str:
    """What is wrong with a shared library as a file; "": nothing.

    The system's loader tells little, and a file that was cut short may crash it.
    """
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            head = file.read(ELF_HEADER_BYTES)
        with Path(sys.executable).open("rb") as file:
            own = file.read(ELF_HEADER_BYTES)
    except OSError as error:
        return f"cannot be read ({error.strerror})"
    if not own.startswith(ELF_MAGIC):
        return ""  # a system of another kind: its loader decides
    if not head.startswith(ELF_MAGIC) or len(head) < ELF_HEADER_BYTES:
        return "no library"
    # Word size and byte order, then the machine.
    if head[4:6] != own[4:6] or head[18:20] != own[18:20]:
        return "for another kind of processor"
    # The table of sections comes last in the file.
    order: Literal["little", "big"] = "little" if head[5] == 1 else "big"
    table, entry, count = ((40, 8), (58, 2), (60, 2)) if head[4] == 2 else ((32, 4), (46, 2), (48, 2))

    def number(place: tuple[int, int]) -> int:
        return int.from_bytes(head[place[0] : place[0] + place[1]], order)

    if number(table) + number(entry) * number(count) > size:
        return "cut short"
    return ""
