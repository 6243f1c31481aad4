#!/usr/bin/env bash
# dpkg installs the packages, runs their scripts, and removes them without a trace: in a root of its
# own, whose record of packages is a copy of this system's, so that dependencies are truly checked.
#   round_trip_test.sh WORK
# SPDX-FileCopyrightText: 2026 the keepout authors
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/common.sh"
work=$1 root=$1/root

rm -rf "$root"
mkdir -p "$root"/var/lib/dpkg/{info,updates,triggers}
# Without a trace of an earlier installation of ours.
awk -v RS= -v ORS='\n\n' '!/^Package: (lib)?keepout/' /var/lib/dpkg/status > "$root/var/lib/dpkg/status"
in_root() {
  dpkg --root="$root" --log="$work/dpkg.log" --force-not-root --force-script-chrootless "$@" 2>&1 |
    grep -v 'files list file for package' || true
}

for package in "$work"/packages/*.deb; do
  while IFS= read -r need; do
    # "a (>= 1)": as dpkg would ask of this system.
    name=${need%% *}
    [[ $name == libkeepout* ]] || dpkg-query -W -f '${db:Status-Status}\n' "$name" | grep -qx installed ||
      fail "$(basename "$package") needs $name, which is not installed"
  done < <(dpkg -f "$package" Depends | tr ',' '\n' | sed 's/^ *//')
done

in_root --force-depends -i "$work"/packages/*.deb
for name in keepout libkeepout0 libkeepout-dev; do
  dpkg-query --admindir="$root/var/lib/dpkg" -W -f '${db:Status-Status}' "$name" | grep -qx installed ||
    fail "$name is not installed"
done
[ -x "$root/usr/bin/keepout" ] || fail "there is no command"
in_root -r keepout libkeepout-dev libkeepout0
left=$(find "$root/usr" -mindepth 1 2>/dev/null || true)
[ -z "$left" ] || fail "left behind: $left"
