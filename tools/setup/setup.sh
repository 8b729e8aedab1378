#!/bin/sh
# Makes this clone ready: sh tools/setup/setup.sh [demo|train|test|docs|check|web|fuzz] [--next]
#
# This part finds or installs Python; tools/setup/__main__.py does the rest.
set -eu
cd "$(dirname "$0")/../.."

find_python() {
    for candidate in python3 python3.14 python3.13 python3.12 python3.11; do
        if "$candidate" -c 'import sys, ensurepip, venv; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            echo "$candidate"
            return
        fi
    done
}

python=.venv/bin/python
if ! "$python" -c '' 2>/dev/null; then
    python=$(find_python)
fi
if [ -z "$python" ]; then
    sh tools/setup/apt.sh python3 python3-venv
    python=$(find_python)
fi
if [ -z "$python" ]; then
    echo "setup: Python 3.11 or newer is needed and python3 is $(python3 -V 2>&1 | sed 's/^Python //')." \
        "Type:  sudo apt-get install -y python3.11 python3.11-venv    and then make again." >&2
    exit 1
fi

PYTHONPATH=tools exec "$python" -m setup "$@"
