#!/usr/bin/env bash
# Tests that the program of ./run's first page writes the page of `keepout simulate` and needs few sources.
#   first_page_test.sh BUILD WORK
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
build=$1 work=$2
fail() { printf '%s\n' "$*" >&2; exit 1; }

inputs=$(ninja -C "$build" -t inputs keepout_first_page)
grep -q 'engine/.*motion_constraint.cpp' <<< "$inputs" || fail "ninja lists no sources: $inputs"
for unneeded in robot/src adapters/fcl benchmarks/ serve/ verify/ keepout_app keepout_judges; do
  ! grep -F "$unneeded" <<< "$inputs" || fail "the first page waits for $unneeded"
done

rm -rf "$work"
mkdir -p "$work"
cd "$work"
program=$build/apps/keepout/keepout_first_page
said=$(KEEPOUT_WEB=/nowhere "$program" cube page.html 2> warned)
[[ $said == *"Report, with tables and settings, no pictures: page.html" ]] || fail "it says: $said"
[ -s page.html ] || fail "there is no page"
grep -q '"command": "keepout simulate cube --out page.html"' page.html.json || fail "there is no record of it"
! said=$("$program" no_mesh.stl none.html 2>&1) || fail "it simulates on a mesh that is missing"
[[ $said == "keepout: no_mesh.stl: there is no such file"* && ! -e none.html ]] || fail "it says: $said"
