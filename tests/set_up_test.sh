#!/usr/bin/env bash
# Tests what ./run and ./test print before they build: no colors in pipes, and an error for another user. The first
# ./run shows a page before it builds the rest.
#   set_up_test.sh SOURCE WORK
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
source=$1 work=$2
fault() { printf '%s\n' "$*" >&2; exit 1; }

rm -rf "$work"
mkdir -p "$work/cmake" "$work/build/release"
cp "$source/run" "$source/test" "$work"
cp "$source/cmake/set_up.sh" "$work/cmake"

said=$(. "$source/cmake/set_up.sh"; say building 2>&1)
[ "$said" = "==> building" ] || fault "in a pipe it says: $(printf %q "$said")"

said=$(. "$source/cmake/set_up.sh"; KEEPOUT_QUIET=1; say building 2>&1)
[ -z "$said" ] || fault "although KEEPOUT_QUIET is set, it says: $said"

# Root may write everywhere. If root runs the test, it calls the programs as another user.
chmod -R a+rX,go-w "$work"
if [ "$(id -u)" -eq 0 ]; then
  as_other=(setpriv --reuid=65534 --regid=65534 --clear-groups)
  "${as_other[@]}" test -r "$work/run" || { echo "skipped: another user cannot read the folder"; exit 0; }
else
  as_other=()
  chmod a-w "$work/build/release"
fi
# Calls the programs directly and by a symbolic link.
mkdir "$work/links"
for program in run test; do
  ln -s "../$program" "$work/links/$program"
  for called in "$work/$program" "$work/links/$program"; do
    told=$("${as_other[@]}" bash "$called" 2>&1) && fault "$called continues in a folder of another user"
    [[ $told == *"may not write to $work"*"belongs to $(id -un)"*"chown -R"* ]] ||
      fault "$called says: $told"
  done
done
chmod -R u+w "$work"

# Tests the order of ./run, with programs that only print their arguments.
rm -rf "$work"
mkdir -p "$work"/{cmake,fixtures,apps/web}
cp "$source/run" "$work"
mkdir "$work/experiments"
cp "$source/experiments/arguments.py" "$source"/experiments/e[0-9]*_*.py "$work/experiments"
printf '#!/bin/sh\nexit "${PAGES_FAIL:-0}"\n' > "$work/apps/web/build"
printf '#!/bin/sh\n' > "$work/fixtures/prepare"
cat > "$work/cmake/set_up.sh" <<'STUB'
say() { printf '==> %s\n' "$*"; }
fail() { say "$*"; exit 1; }
require_own_checkout() { :; }
install_packages() { :; }
configure() { say "configures $1"; touch "$root/build/release/build.ninja"; }
build() {
  rm -f "$root/build/$1/first_page_only"
  compile "$@"
}
compile() {
  local target programs=$root/build/$1/apps/keepout
  say "builds ${*:2}"
  mkdir -p "$programs"
  for target in "${@:2}"; do
    printf '#!/bin/sh\necho %s "$@"\n' "$target" > "$programs/${target/keepout_bench/keepout-bench}"
  done
  chmod +x "$programs"/*
}
STUB
chmod +x "$work/apps/web/build" "$work/fixtures/prepare"
said=$("$work/run" | sed "s,$work/,,; /^==> waiting for /d")
[[ $said == "==> configuring (first_page)
==> configures first_page
==> builds keepout_first_page
==> simulating on the CT skull
keepout_first_page skull out/skull.html
==> open out/skull.html"*"
==> builds keepout keepout_bench keepout_manual keepout_modules
"*"
keepout simulate skull --bench --out out/skull.html" ]] || fault "the first run says: $said"
said=$("$work/run")
[[ $said != *first_page* ]] || fault "the second run says: $said"
rm -r "$work/build"
said=$(PAGES_FAIL=1 "$work/run" 2>&1)
[[ $said == *"going on: reports will be plain pages"*keepout_first_page* ]] ||
  fault "without pages the first run says: $said"

# ./run reports an error in the arguments of the experiments before it builds anything.
for mistake in --ful "--only e1,,e2" "--only e9" "--seed -1"; do
  # shellcheck disable=SC2086
  told=$("$work/run" experiments $mistake 2>&1) && fault "./run experiments $mistake goes on: $told"
  [[ $told == *"usage: ./run experiments"*"error: "* && $told != *builds* ]] || fault "./run experiments $mistake says: $told"
done
told=$("$work/run" experiments --help | tr -s '[:space:]' ' ')
[[ $told == "usage: ./run experiments"*"e6 (counterexamples)"* && $told != *builds* ]] || fault "./run experiments --help says: $told"
