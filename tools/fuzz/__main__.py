"""Fuzzes each target for a while: python -m fuzz [--seconds S] [--target NAME]. Needs `make setup-fuzz`."""

import argparse
import subprocess
import sys

from fuzz.build import CORPUS, ROOT, TARGETS, build

WORK = ROOT / "build" / "fuzz"
LONGEST = 2048  # bytes of one input


def fuzz(target: str, seconds: int) -> bool:
    """Fuzzes a target on its kept corpus and on what earlier calls have found; whether all was well."""
    program, found, bad = (WORK / part / target for part in ("bin", "found", "bad"))
    build("clang++", "libfuzzer.cpp", program, "-fsanitize=fuzzer,address,undefined", f"-DTARGET={target}")
    for folder in (found, bad):
        folder.mkdir(parents=True, exist_ok=True)
    command = [program, f"-max_total_time={seconds}", f"-max_len={LONGEST}", f"-artifact_prefix={bad}/"]
    done = subprocess.run([*map(str, command), str(found), str(CORPUS / target)], check=False)
    if done.returncode:
        print(
            f"fuzz: {target} failed on the file above; mend it, and keep that file in {CORPUS / target}",
            file=sys.stderr,
        )
    return done.returncode == 0


def main() -> int:
    """Fuzzes all targets or one, each for its share of the time."""
    parser = argparse.ArgumentParser(prog="fuzz", description="Fuzzes what parses in the firmware.")
    parser.add_argument("--seconds", type=int, default=60, help="in all (default: %(default)s)")
    parser.add_argument("--target", choices=TARGETS, help="this one only")
    args = parser.parse_args()
    targets = [args.target] if args.target else TARGETS
    try:
        well = [fuzz(target, max(args.seconds // len(targets), 1)) for target in targets]
    except FileNotFoundError:
        print("fuzz: no clang++; run make setup-fuzz", file=sys.stderr)
    except subprocess.CalledProcessError:
        print("fuzz: it does not build, see above", file=sys.stderr)
    else:
        return 0 if all(well) else 1
    return 2


if __name__ == "__main__":
    sys.exit(main())
