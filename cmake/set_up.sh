# Sourced by ./run and ./test: installs what is missing, configures and builds.
# SPDX-License-Identifier: BSD-3-Clause

# If KEEPOUT_QUIET is set: no notices, only errors.
say() {
  [ -z "${KEEPOUT_QUIET:-}" ] || return 0
  if [ -t 2 ] && [ -z "${NO_COLOR:-}" ]; then
    printf '\033[1m==> %s\033[0m\n' "$*" >&2
  else
    printf '==> %s\n' "$*" >&2
  fi
}
fail() { printf 'keepout: %s\n' "$*" >&2; exit 1; }

# require_own_checkout: fails if files that another user has built, fetched or written here are not writable.
require_own_checkout() {
  local path blocked
  blocked=$(
    find "$root" -maxdepth 0 ! -writable
    for path in "$root/build" "$root/out" "${KEEPOUT_CACHE:-$root/.cache}"; do
      [ ! -e "$path" ] || find "$path" -maxdepth 2 ! -writable 2>/dev/null || true
    done
  )
  blocked=${blocked%%$'\n'*}
  [ -z "$blocked" ] || fail "$(id -un) may not write to $blocked, which belongs to $(stat -c %U "$blocked").
If nobody else works here, make all of it yours:
  sudo chown -R $(id -un) ${root@Q}
Otherwise work in a copy of the sources of your own:
  mkdir ~/keepout && tar -C ${root@Q} --exclude=./build --exclude=./out --exclude=./.cache -c . |
    tar -C ~/keepout -x && ~/keepout/run"
}

# install_packages [LIST [PURPOSE]]: installs the missing Debian packages of cmake/LIST, by default
# debian_packages.txt. Skips packages for another purpose; for the purpose `first`, all that are not marked so.
# Needs no network if all are installed. If without_asking is set, fails instead of asking for a password.
install_packages() {
  local list=${1:-debian_packages.txt} purpose=${2:-}
  command -v apt-get >/dev/null || fail "this needs Debian 12 (apt-get); on another system install
the counterparts of cmake/$list yourself and use the CMake presets (README, Build)"
  local package condition word missing=()
  while read -r package condition word; do
    [ "$condition" = unless ] && command -v "$word" >/dev/null && continue
    [ "$condition" = for ] && [ "$word" != "$purpose" ] && continue
    [ "$purpose" = first ] && [ "$condition" != first ] && continue
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] ||
      missing+=("$package")
  done < <(grep -v '^#' "$root/cmake/$list")
  [ ${#missing[@]} -eq 0 ] && return
  say "installing ${missing[*]}"
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || fail "to install ${missing[*]}, run this as root or install sudo"
    as_root=(sudo ${without_asking:+-n})
  fi
  "${as_root[@]}" apt-get update -q >&2 || fail "apt-get update failed: is there a network?"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -q -y --no-install-recommends "${missing[@]}" >&2 ||
    fail "could not install ${missing[*]}: see apt-get's message above"
}

# configure PRESET
configure() {
  say "configuring ($1)"
  (cd "$root" && cmake --preset "$1" ${KEEPOUT_QUIET:+--log-level=WARNING} >&2) || fail "configuring failed: see above"
}

# compile PRESET [TARGET...]: builds what has changed. Precondition: configured.
compile() {
  local preset=$1
  shift
  say "building ($preset)"
  (cd "$root" && cmake --build --preset "$preset" ${1:+--target "$@"} ${KEEPOUT_QUIET:+-- --quiet} >&2) ||
    fail "building failed: see above; to start afresh, remove build/$preset"
}

# build PRESET [TARGET...]: configures once, or again if it was for the first page of ./run only, and compiles.
build() {
  local folder=$root/build/$1
  if [ ! -f "$folder/build.ninja" ] || [ -e "$folder/first_page_only" ]; then
    rm -f "$folder/CMakeCache.txt"
    configure "$1"
    rm -f "$folder/first_page_only"
  fi
  compile "$@"
}
