#!/bin/sh
# Installs those of the named Debian or Ubuntu packages that are missing: sh tools/setup/apt.sh PACKAGE...
#
# Never asks and never waits for a password: as root, or by sudo if that needs none, or it says what to type.
set -eu
log=build/setup/apt.log

if ! command -v dpkg-query >/dev/null; then
    echo "setup: no Debian or Ubuntu: going on in the hope that the likes of these are installed: $*" >&2
    exit 0
fi

installed=$(dpkg-query --show --showformat='${db:Status-Status} ${Package}\n' "$@" 2>/dev/null |
    sed -n 's/^installed //p')
missing=
for package; do
    echo "$installed" | grep -qxF "$package" || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

if [ "$(id -u)" = 0 ]; then
    as_root=env
elif sudo -n true 2>/dev/null; then
    as_root="sudo -n env"
else
    echo "setup: system packages are missing, and this is neither root nor a user whose sudo needs no password." \
        "Type:  sudo apt-get update && sudo apt-get install -y$missing    and then make again." >&2
    exit 1
fi

apt_get() {
    # The options keep it from waiting for ever: for a mirror, for another apt, or for an answer.
    $as_root DEBIAN_FRONTEND=noninteractive apt-get -q -y -o Acquire::http::Timeout=30 \
        -o Acquire::https::Timeout=30 -o Acquire::Retries=2 -o DPkg::Lock::Timeout=120 "$@" </dev/null
}

echo "setup: installing system packages:$missing" >&2
mkdir -p build/setup
# One source of many may be down without harm: whether the packages are to be had is for the install to say.
if [ -z "$(find build/setup/apt-updated -mmin -10 2>/dev/null)" ]; then
    apt_get update >"$log" 2>&1 && touch build/setup/apt-updated || true
fi
# shellcheck disable=SC2086  # a list of words
if ! apt_get install --no-install-recommends $missing >>"$log" 2>&1; then
    tail -n 15 "$log" >&2
    echo "setup: apt-get could not install$missing (the whole story: $log). Try it by hand, then make again." >&2
    exit 1
fi
