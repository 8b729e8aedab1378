"""Fuzzes each target for a while: python -m fuzz [--seconds S] [--target NAME]. Needs `make setup-fuzz`."""

import argparse
import os
import subprocess
import sys

from fuzz.build import CORPUS, ROOT, TARGETS, Suite, build, emulator_library, suite_of

WORK = ROOT / "build" / "fuzz"
LONGEST = 2048  # bytes of one input
SLOW_S = 20  # an input that takes longer counts as a failure
SANITIZERS = "-fsanitize=address,undefined"


def prepare(suite: Suite) -> None:
    """Builds the program of a suite.

    Raises:
        CalledProcessError: it does not build.
        FileNotFoundError: there is no clang, or no CMake.
    """
    print(f"fuzz: building the targets {', '.join(suite.targets)}", file=sys.stderr, flush=True)
    coverage = "-fsanitize=fuzzer-no-link"
    library = emulator_library("clang++", WORK / "emulator", SANITIZERS, coverage) if suite.emulator else None
    options = (SANITIZERS, "-fsanitize=fuzzer")
    build("clang++", suite, "libfuzzer.cpp", WORK / "bin" / suite.name, *options, library=library)


def fuzz(target: str, seconds: int) -> bool:
    """Fuzzes a target on its kept corpus and on what earlier calls have found; whether all was well."""
    program = WORK / "bin" / suite_of(target).name
    found, bad = (WORK / part / target for part in ("found", "bad"))
    for folder in (found, bad):
        folder.mkdir(parents=True, exist_ok=True)
    limits = [f"-max_total_time={seconds}", f"-max_len={LONGEST}", f"-timeout={SLOW_S}"]
    command = [program, *limits, f"-artifact_prefix={bad}/", found, CORPUS / target]
    done = subprocess.run([*map(str, command)], check=False, env=os.environ | {"FUZZ_TARGET": target})
    if done.returncode:
        print(
            f"fuzz: {target} failed on the file above; mend it, and keep that file in {CORPUS / target}",
            file=sys.stderr,
        )
    return done.returncode == 0


def main() -> int:
    """Fuzzes all targets or one, each for its share of the time."""
    parser = argparse.ArgumentParser(
        prog="fuzz", description="Fuzzes what parses in the firmware and the emulator."
    )
    parser.add_argument("--seconds", type=int, default=60, help="in all (default: %(default)s)")
    parser.add_argument("--target", choices=TARGETS, help="this one only")
    args = parser.parse_args()
    targets = [args.target] if args.target else TARGETS
    well: dict[str, bool] = {}
    try:
        for suite in dict.fromkeys(map(suite_of, targets)):
            prepare(suite)
        for target in targets:
            well[target] = fuzz(target, max(args.seconds // len(targets), 1))
    except FileNotFoundError as error:
        print(f"fuzz: no {error.filename}; run make setup-fuzz", file=sys.stderr)
    except subprocess.CalledProcessError:
        print("fuzz: it does not build, see above", file=sys.stderr)
    else:
        for target, was_well in well.items():
            print(f"fuzz: {target}: {'well' if was_well else 'FAILED'}")
        return 0 if all(well.values()) else 1
    return 2


if __name__ == "__main__":
    sys.exit(main())
