#!/bin/sh
# Builds the libraries with sanitizers, and runs tests of all three on them: sh tools/c_api/sanitize.sh [TEST...]
set -eu
cd "$(dirname "$0")/../.."

generator=
if command -v ninja >/dev/null && ! [ -f build/sanitize/Makefile ]; then generator="-G Ninja"; fi
# shellcheck disable=SC2086  # two words or none
cmake --preset sanitize $generator >/dev/null
cmake --build --preset sanitize --parallel "$(nproc)"

if [ $# = 0 ]; then
    set -- test/emulator/test_bad_calls.py test/emulator/test_array.py test/simulator/test_bad_calls.py \
        test/simulator/test_core_library.py test/training/test_bad_calls.py
fi
# Python itself is not built with sanitizers: they must be there before the libraries are. The C++ library, too,
# since the sanitizers look for its throw.
preload="$(g++ -print-file-name=libasan.so) $(g++ -print-file-name=libstdc++.so.6)"
LD_PRELOAD="$preload" ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1 \
    TILENCA_LIBRARIES=build/sanitize .venv/bin/python -m pytest -q -s -p no:cacheprovider "$@"
