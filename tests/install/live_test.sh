#!/usr/bin/env bash
# `keepout live` of an installed keepout finds the page that was installed with it, wherever both lie;
# and says what to do where there is none.
#   live_test.sh PREFIX WORK SOURCE
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/common.sh"
prefix=$1 work=$2 source=$3

rm -rf "$work"
mkdir -p "$work"
cp -al "$prefix" "$work/moved"
cd "$work"
export LD_LIBRARY_PATH
LD_LIBRARY_PATH=$(library_folder moved)
page=moved/share/keepout/web/live.html
place='<!-- keepout live: the anatomy goes here -->'

# The page takes minutes to build, so it need not be there; if it is, it is installed too.
if [ -e "$source/build/web/live.html" ]; then
  cmp "$source/build/web/live.html" "$page" || fail "the page that was built is not installed"
elif [ ! -e "$page" ]; then
  mkdir -p "$(dirname "$page")"
  printf '<p>before</p>\n%s\n<p>after</p>\n' "$place" > "$page"
fi

env -u KEEPOUT_WEB moved/bin/keepout live "$here/cube.obj" --no-open --out live.html
for id in settings mesh-0; do
  [ "$(grep -c "^ *<script[^>]* id=\"$id\">" live.html)" = 1 ] || fail "the page has not one $id"
done
! grep -qF -- "$place" live.html || fail "the page has its place for the anatomy still"
[ "$(wc -l < live.html)" -eq $(($(wc -l < "$page") + 1)) ] || fail "the page is not whole"

rm "$page" live.html
! told=$(env -u KEEPOUT_WEB moved/bin/keepout live cube --no-open --out live.html 2>&1) ||
  fail "goes on without its page"
[[ $told == *"there is no $PWD/$page"*"./run live"* ]] || fail "without its page it says: $told"
[ ! -e live.html ] || fail "there is a page all the same"
