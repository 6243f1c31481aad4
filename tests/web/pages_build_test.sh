#!/usr/bin/env bash
# Tests how ./run builds the pages: when it downloads and builds their parts, and what it reports if it cannot. Scripts
# of this test replace the programs that download, compile and bundle.
#   pages_build_test.sh SOURCE WORK
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
source=$1 work=$2
fault() { printf '%s\n' "$*" >&2; exit 1; }

rm -rf "$work"
mkdir -p "$work"/{apps/web,build/release/apps/keepout,build/wasm,programs}
cp "$source/run" "$work"
cp -r "$source/cmake" "$work"
cp "$source/apps/web/build" "$work/apps/web"
touch "$work"/build/{release,wasm}/build.ninja "$work/build/release/apps/keepout/keepout-bench"
touch "$work/apps/web/"{package.json,.npmrc}
echo 'first' > "$work/apps/web/package-lock.json"
mkdir "$work/apps/web/src"
touch "$work"/{LICENSE,apps/web/src/main.ts,apps/web/build.mjs,build/wasm/keepout.mjs,build/wasm/keepout.wasm}
export calls=$work/calls page=$work/build/web/live.html

# program NAME: replaces a program by the script on stdin, and logs its calls.
program() {
  { printf '#!/bin/bash\necho "%s $*" >> "$calls"\n' "${1##*/}"; cat; } > "$1"
  chmod +x "$1"
}
for name in em++ node cmake; do program "$work/programs/$name" <<< ''; done
program "$work/programs/sudo" <<< 'exec "$@"'
program "$work/programs/apt-get" <<< 'exit 1'
program "$work/programs/dpkg-query" <<< '[ "${*: -1}" = "${not_installed:-}" ] || echo installed'
program "$work/programs/npm" <<'PROGRAM'
[ "$1" != ci ] || rm -rf node_modules/*  # as npm does: files that begin with a dot stay
[ -z "${npm_fails:-}" ] || exit 1
if [ "$1" = ci ]; then
  mkdir -p node_modules
  cp package-lock.json node_modules/what_it_names
else
  cmp package-lock.json node_modules/what_it_names || exit 1
  for page in report report_with_anatomy; do
    printf '%s\n' "${bundled-<!-- keepout report: the record goes here -->}" > "$KEEPOUT_PAGES/$page.html"
  done
  [ -z "$KEEPOUT_WASM" ] || [ -d "$KEEPOUT_WASM" ] || exit 1
  [ -z "$KEEPOUT_WASM" ] ||
    printf '%s\n' "${bundled-<!-- keepout live: the anatomy goes here -->}" > "$KEEPOUT_PAGES/live.html"
fi
PROGRAM
program "$work/build/release/apps/keepout/keepout" <<< ''

# run STATUS ARGS...: runs ./run and checks its status (well, fails). Its output is in `told`, the called programs are
# in `called`.
run() {
  local expected=$1 status=0
  shift
  : > "$calls"
  told=$(cd "$work" && PATH=$work/programs:$PATH ./run "$@" 2>&1) || status=$?
  called=$(grep -v ^dpkg-query "$calls")
  if [ "$expected" = fails ]; then
    [ "$status" -ne 0 ] || fault "./run $* goes on: $told"
    [[ $called != *"keepout $*"* ]] || fault "./run $* goes on to the command"
  else
    [ "$status" -eq 0 ] || fault "./run $* fails: $told"
    [[ $called == *"keepout $*"* ]] || fault "./run $* does not come to the command"
  fi
}
calls_it() { [[ $called == *"$1"* ]] || fault "does not call '$1', but: $called"; }
calls_no() { [[ $called != *"$1"* ]] || fault "calls '$1': $called"; }
says() { [[ $told == *"$1"* ]] || fault "does not say '$1', but: $told"; }

for words in "inspect cube" "inspect live" "live --help" "simulate -h" "replay cube"; do
  # shellcheck disable=SC2086
  run well $words
  calls_no npm
  calls_no wasm
done

# A report does not need the WebAssembly compiler. Without a network, it is a plain page.
npm_fails=yes run well
says "could not be fetched: is there a network?"
says "going on: reports will be plain"
run well
calls_it "npm ci"
calls_no wasm
[ -s "$work/build/web/report_with_anatomy.html" ] || fault "there is no front end"
run well simulate cube
calls_no "npm"
touch "$work/apps/web/src/main.ts"
run well --simd AVX2 bench
calls_it "npm run"
calls_no "npm ci"
touch "$work/apps/web/src/main.ts"
run well inspect cube --json --out page.html
calls_it "npm run"

run well live cube
calls_it "cmake --build --preset wasm"
calls_no "npm ci"
[ -s "$page" ] || fault "there is no page"
[ -L "$work/apps/web/node_modules" ] || fault "the libraries are among the sources"

touch "$work/apps/web/src/main.ts"
run well --simd AVX2 live
calls_it "npm run"
calls_no "npm ci"

echo second > "$work/apps/web/package-lock.json"
npm_fails=yes run fails live
says "could not be fetched: is there a network?"
[ -s "$page" ] || fault "the earlier page is gone"
npm_fails=yes run well inspect cube
echo first > "$work/apps/web/package-lock.json"
run well live
calls_it "npm ci"

calls_it "--omit=dev"

# The packages of the tests include those of the pages.
: > "$calls"
PATH=$work/programs:$PATH "$work/apps/web/build" tests 2>/dev/null
called=$(cat "$calls")
calls_it "npm ci"
calls_no "--omit=dev"
run well live
calls_no "npm ci"

touch "$work/apps/web/src/main.ts"
npm_fails=yes run fails live
calls_no "npm ci"
says "could not be bundled"
bundled=nothing run fails live
says "does not have exactly one line"
grep -qF "anatomy goes here" "$page" || fault "the earlier page is gone"

not_installed=emscripten run fails live
says "installing emscripten"
says "is there a network?"
not_installed=emscripten run well inspect cube
not_installed=chromium run well live
rm "$work/programs/npm"
mkdir "$work/few"
for name in bash cat cmp cp dirname env find grep id ln mkdir mv rm rmdir stat; do
  ln -s "$(command -v $name)" "$work/few/$name"
done
PATH=$work/few
run fails live
says "need npm, which is not installed"
run well inspect cube
run well simulate cube
says "going on: reports will be plain"
