#!/usr/bin/env bash
# Tests that an installed keepout has its documentation, manual page and bash completion, wherever it is
# installed. Each page that its help names must exist.
#   documentation_test.sh PREFIX WORK
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/common.sh"
prefix=$1 work=$2

rm -rf "$work"
mkdir -p "$work"
cp -al "$prefix" "$work/moved"
cd "$work"
keepout=$PWD/moved/bin/keepout
docs=$PWD/moved/share/doc/keepout/docs

[ "$("$keepout" docs serve)" = "$docs/serve.md" ] || fail "docs serve says: $("$keepout" docs serve)"
said=$("$keepout" docs)
[ "${said%%$'\n'*}" = "$docs" ] || fail "docs says: $said"
without_links() { sed -Ez 's/\[([^]]*)\]\([^)]*\)/\1/g' "$1"; }
for page in "$here"/../../docs/*.md; do
  name=$(basename "$page" .md)
  cmp <(without_links "$page") <(without_links "$docs/$name.md") || fail "$name.md is not installed as it is"
  grep -q "^  $name  *[A-Z\`k]" <<< "$said" || fail "docs does not list $name: $said"
done
! said=$("$keepout" docs sevre 2>&1) || fail "there is a page 'sevre'"
[[ $said == *"did you mean 'serve'?"* ]] || fail "docs sevre says: $said"

links=0
while IFS=: read -r page target; do
  [ -e "$(dirname "$page")/${target#](}" ] || fail "$page: there is no ${target#](}"
  links=$((links + 1))
done < <(grep -roE '\]\([A-Za-z0-9_-]*[./][A-Za-z0-9_./-]*[)#]' --include='*.md' "$docs/.." | sed 's/[)#]$//')
[ $links -gt 200 ] || fail "only $links links"

commands=$("$keepout" --help | sed -nE '/^Commands/,/^$/s/^  ([a-z]+) {3,}.*/\1/p' | sort -u)
[ "$(wc -l <<< "$commands")" -gt 10 ] || fail "help lists few commands: $commands"
help=$(for command in $commands; do "$keepout" "$command" --help; done)
named=$(grep -oE '[^ ]*docs/[a-z_-]+\.md' <<< "$help" | sort -u)
[ "$(wc -l <<< "$named")" -gt 3 ] || fail "help names few pages: $named"
for page in $named; do
  [[ $page == "$docs"/* && -s $page ]] || fail "help names $page, which is not there"
done

# The manual page must have all commands and options of the help.
manual=moved/share/man/man1/keepout.1.gz
for command in $commands; do
  zgrep -q "^\.SS keepout $command \[OPTIONS\]" "$manual" || fail "the manual page has no $command"
done
for option in $(grep -oE '^ +--[a-z-]+' <<< "$help" | sort -u); do
  zgrep -qF -- "${option//-/\\-}" "$manual" || fail "the manual page has no $option"
done
if command -v man > /dev/null; then
  for page in keepout keepout-bench; do
    warnings=$(cd moved/share/man && LC_ALL=C.UTF-8 MANROFFSEQ='' MANWIDTH=80 \
      man --warnings -E UTF-8 -l -Tutf8 -Z "man1/$page.1.gz" 2>&1 > /dev/null)
    [ -z "$warnings" ] || fail "man says of $page: $warnings"
    shown=$(cd moved/share/man && MANWIDTH=80 man -l "man1/$page.1.gz" | col -b)
    [[ $shown == *"keepout inspect [OPTIONS] MESH"* ]] || fail "man shows of $page: $shown"
  done
else
  echo "there is no man: how it shows the page is not tested"
fi

# completes WORDS... EXPECTED: fails unless the completions of the last word are EXPECTED.
completes() {
  local expected=${*: -1} words=("${@:1:$#-1}") reply
  reply=$(bash -c '
    . "$1"
    COMP_WORDS=("${@:2}") COMP_CWORD=$(($# - 2)) COMPREPLY=()
    $(complete -p keepout | sed -E "s/.* -F ([^ ]+) .*/\1/") "$2"
    echo "${COMPREPLY[*]}"' - moved/share/bash-completion/completions/keepout "$keepout" "${words[@]}")
  [ "$reply" = "$expected" ] || fail "'${words[*]}' is completed to '$reply' instead of '$expected'"
}
cmp moved/share/bash-completion/completions/keepout{,-bench}
completes insp inspect
completes ben bench
completes help insp inspect
completes docs gui guides
completes inspect --self --self-intersections
completes replay cube --index wide_ wide_bvh
completes replay cube --index = wide_ wide_bvh
completes replay --index wide_bvh --solver act active_set
completes --simd SSE2 insp inspect
completes inspect cub cube
completes convert cub cube
completes convert cube cub ''
completes inspect cube cub ''
completes verify cube skul 'skull skull_1m'
completes bench --mesh cub cube
touch "skulk of foxes.stl"
completes inspect skul 'skull skull_1m skulk of foxes.stl'
rm "skulk of foxes.stl"
completes simulate --ben --bench
