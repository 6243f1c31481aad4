#!/usr/bin/env bash
# Tests that dpkg installs the packages, runs their scripts, and removes the packages completely. It uses a
# separate root with a copy of this system's package database, so dpkg checks the dependencies.
#   round_trip_test.sh WORK
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/common.sh"
work=$1 root=$1/root

rm -rf "$root" "$work/commands"
mkdir -p "$root"/var/lib/dpkg/{info,updates,triggers} "$work/commands"
awk -v RS= -v ORS='\n\n' '!/^Package: (lib)?keepout/' /var/lib/dpkg/status > "$root/var/lib/dpkg/status"
# The packages' scripts call ldconfig, which would change this system instead of the root.
printf '#!/bin/sh\necho called >> "%s"\n' "$work/commands/calls" > "$work/commands/ldconfig"
chmod +x "$work/commands/ldconfig"

in_root() {
  if ! PATH=$work/commands:/usr/sbin:/sbin:$PATH dpkg --root="$root" --log="$work/dpkg.log" \
    --force-not-root --force-script-chrootless "$@" > "$work/dpkg.txt" 2>&1; then
    # The copied database has no lists of files.
    grep -v 'files list file for package' "$work/dpkg.txt" >&2
    fail "dpkg $1 failed"
  fi
}
state() { dpkg-query --admindir="$root/var/lib/dpkg" -W -f '${db:Status-Status}' "$1"; }

packages=("$work"/packages/*.deb)
in_root -i "${packages[@]}"
names=()
for package in "${packages[@]}"; do
  names+=("$(dpkg -f "$package" Package)")
  [ "$(state "${names[-1]}")" = installed ] || fail "${names[-1]} is not installed"
done
[ -x "$root/usr/bin/keepout" ] || fail "there is no command"
[ -s "$work/commands/calls" ] || fail "the linker was not told of the new libraries"

in_root -r "${names[@]}"
left=$(find "$root/usr" -mindepth 1 2>/dev/null || true)
[ -z "$left" ] || fail "left behind: $left"
