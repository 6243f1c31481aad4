#!/usr/bin/env bash
# Tests that an installed keepout finds its page templates in any place, and says what to do without them.
#   pages_test.sh PREFIX WORK SOURCE
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/common.sh"
prefix=$1 work=$2 source=$3

rm -rf "$work"
mkdir -p "$work"
cp -al "$prefix" "$work/moved"
cd "$work"
export LD_LIBRARY_PATH
LD_LIBRARY_PATH=$(library_folder moved)
pages=moved/share/keepout/web

# The templates take minutes to build, so they may be missing. Those that exist must be installed.
for name in report report_with_anatomy live; do
  page=$pages/$name.html
  place='<!-- keepout report: the record goes here -->'
  [ $name != live ] || place='<!-- keepout live: the anatomy goes here -->'
  if [ -e "$source/build/web/$name.html" ]; then
    cmp "$source/build/web/$name.html" "$page" || fail "$page that was built is not installed"
  elif [ ! -e "$page" ]; then
    mkdir -p "$pages"
    printf '<p>before</p>\n%s\n<p>after</p>\n' "$place" > "$page"
  fi
done

# is_made NAME LINES ID...: fails unless made.html was made from the template NAME, has one script of each ID,
# and LINES more lines.
is_made() {
  local name=$1 more=$2 id
  shift 2
  for id in "$@"; do
    [ "$(grep -c "<script[^>]* id=\"$id\">" made.html)" = 1 ] || fail "$name: there is not one $id"
  done
  ! grep -qF -- 'goes here -->' made.html || fail "$name: the page has its place still"
  [ "$(wc -l < made.html)" -eq $(($(wc -l < "$pages/$name.html") + more)) ] ||
    fail "$name: the page is not whole"
}
unset KEEPOUT_WEB
moved/bin/keepout live "$here/cube.obj" --no-open --out made.html
is_made live 1 settings mesh-0
moved/bin/keepout live "$here/cube.obj" --robot psm --no-open --out made.html
is_made live 1 settings mesh-0
moved/bin/keepout simulate "$here/cube.obj" --strokes 1 --cycles 10 --out made.html > told
is_made report_with_anatomy 0 record
moved/bin/keepout verify "$here/cube.obj" --steps 500 --out made.html > told
is_made report 0 record

rm -r "$pages" made.html
! told=$(moved/bin/keepout live cube --no-open --out made.html 2>&1) || fail "goes on without its page"
[[ $told == *"there is no $PWD/$pages/live.html"*"./run live makes live.html"* ]] ||
  fail "without its page it says: $told"
[ ! -e made.html ] || fail "there is a page all the same"
told=$(moved/bin/keepout verify "$here/cube.obj" --steps 500 --out made.html 2>&1)
[[ $told == *"plain page"* ]] || fail "without its front end it says: $told"
[ -s made.html ] && [ -s made.html.json ] || fail "there is no plain page, or no record beside it"
