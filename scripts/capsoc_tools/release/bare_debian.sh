#!/usr/bin/env bash
# bare_debian [--keep PATH] SUITE COMMAND...: runs COMMAND as root in a clean clone of HEAD inside a bare Debian of that suite
# (bookworm is Debian 12, trixie is 13), which debootstrap makes for the purpose with git and nothing else. Ends with the exit code
# of COMMAND. --keep copies PATH of that clone, a file or folder that COMMAND made, to build/SUITE here.
# Needs root, debootstrap and Debian's packages. The bare system is kept in ${XDG_CACHE_HOME:-~/.cache}/capsoc/SUITE.tar for the next call.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../../.."

refuse() { echo "bare_debian: $*" >&2; exit 2; }
keep=
if [[ ${1-} == --keep ]]; then
  keep=${2-}
  [[ -n $keep && $keep != /* && /$keep/ != */../* ]] || refuse "--keep needs a path below the clone, for instance build/route"
  shift 2
fi
(($# > 1)) || refuse "give a suite of Debian and a command, for instance: bare_debian trixie ./scripts/demo"
suite=$1
shift
[[ $suite =~ ^[a-z]+$ ]] || refuse "'$suite' is no suite; give bookworm or trixie"
[[ $(id -u) == 0 ]] || refuse "debootstrap and chroot need root; run it as root"
command -v debootstrap >/dev/null || refuse "debootstrap is missing; run: apt-get install debootstrap"
git rev-parse --verify -q HEAD >/dev/null || refuse "there is no commit to clone"

cache=${XDG_CACHE_HOME:-$HOME/.cache}/capsoc
base=$cache/$suite.tar
work=$(mktemp -d "${TMPDIR:-/tmp}/bare_debian.XXXXXX")
box=$work/debian
clean() {
  umount "$box/proc" "$box/dev/pts" "$box/dev" 2>/dev/null || true
  rm -rf --one-file-system "$work"
}
trap clean EXIT

if [[ ! -f $base ]]; then
  mkdir -p "$cache"
  # This machine's mirror and the apt settings that it needs (a proxy, say).
  mirror=$(grep -hoE '^(URIs: *|deb (\[[^]]*\] )?)https?://[^ ]+' /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null |
    grep -v security | head -n 1 | grep -oE 'https?://.*' || true)
  mirror=${mirror:-http://deb.debian.org/debian}
  debootstrap --variant=minbase --include=git,ca-certificates "$suite" "$box" "$mirror" >"$work/log" 2>&1 ||
    refuse "debootstrap failed ($(tail -n 1 "$work/log")); are the suite $suite, the mirror $mirror and its key there?"
  tar -C "$box" -cf "$work/base.tar" .
  mv "$work/base.tar" "$base"
else
  mkdir "$box"
  tar -C "$box" -xf "$base"
fi
grep -lE 'Acquire' /etc/apt/apt.conf.d/* 2>/dev/null | xargs -r cp -t "$box/etc/apt/apt.conf.d/"
cp /etc/resolv.conf /etc/hosts "$box/etc/" 2>/dev/null || true
mount -t proc proc "$box/proc"
mount --bind /dev "$box/dev"
mount --bind /dev/pts "$box/dev/pts"
git clone -q . "$box/root/clone"

code=0
env -i HOME=/root TERM=dumb LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive \
  chroot "$box" sh -c 'cd /root/clone && apt-get update -qq && exec "$@"' sh "$@" || code=$?
echo "bare_debian: $suite: exit $code after $SECONDS s: $*" >&2
if [[ -n $keep ]] && { ((code == 0)) || [[ -e $box/root/clone/$keep ]]; }; then
  mkdir -p "build/$suite"
  cp -r "$box/root/clone/$keep" "build/$suite/" || refuse "COMMAND made no $keep to keep"
  echo "bare_debian: $keep is now build/$suite/$(basename "$keep")" >&2
fi
exit "$code"
