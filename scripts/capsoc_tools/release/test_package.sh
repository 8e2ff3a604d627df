#!/usr/bin/env bash
# test_package [FILE.deb]: makes the Debian packages of build/ (cpack -G DEB) and takes capsoc's, or FILE.deb, installs it in a bare
# Debian 12 made for the purpose with debootstrap, uses it there as a user without rights, and removes it again.
# Needs root, debootstrap and Debian's packages; without a FILE.deb also dpkg-dev, file and a whole build (scripts/setup).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../../.."

refuse() { echo "test_package: $*" >&2; exit 2; }
[[ $(id -u) == 0 ]] || refuse "debootstrap and chroot need root; run it as root"
command -v debootstrap >/dev/null || refuse "debootstrap is missing; run: apt-get install debootstrap"

work=$(mktemp -d "${TMPDIR:-/tmp}/test_package.XXXXXX")
box=$work/debian
clean() {
  umount "$box/proc" "$box/dev" 2>/dev/null || true
  rm -rf --one-file-system "$work"
}
trap clean EXIT

if (($#)); then
  package=$1
  [[ -f $package ]] || refuse "$package: there is no such package"
else
  [[ -f build/CPackConfig.cmake ]] || refuse "there is no build/; run scripts/setup first"
  for tool in dpkg-shlibdeps file; do
    command -v "$tool" >/dev/null || refuse "$tool is missing; run: apt-get install dpkg-dev file"
  done
  cpack --config build/CPackConfig.cmake -G DEB -B "$work/package" >"$work/cpack.log" 2>&1 ||
    { cat "$work/cpack.log" >&2; echo "test_package: cpack failed" >&2; exit 1; }
  package=$(echo "$work"/package/capsoc_*.deb)
fi
echo "package: $(basename "$package"), $(du -h "$package" | cut -f1)"
dpkg-deb --field "$package" Version Depends | sed 's/^/  /'

# This machine's mirror and the apt settings that it needs (a proxy, say).
mirror=$(grep -hoE '^(URIs: *|deb (\[[^]]*\] )?)https?://[^ ]+' /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null |
  grep -v security | head -n 1 | grep -oE 'https?://.*' || true)
mirror=${mirror:-http://deb.debian.org/debian}
debootstrap --variant=minbase bookworm "$box" "$mirror" >"$work/debootstrap.log" 2>&1 ||
  refuse "debootstrap failed ($(tail -n 1 "$work/debootstrap.log")); are the mirror $mirror and its key there?"
grep -lE 'Acquire' /etc/apt/apt.conf.d/* 2>/dev/null | xargs -r cp -t "$box/etc/apt/apt.conf.d/"
cp /etc/resolv.conf /etc/hosts "$box/etc/" 2>/dev/null || true
mount -t proc proc "$box/proc"
mount --bind /dev "$box/dev"
cp "$package" "$box/capsoc.deb"

clear_environment=(env -i HOME=/tmp LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive PATH=/usr/sbin:/usr/bin:/sbin:/bin)
as_root() { "${clear_environment[@]}" chroot "$box" "$@"; }
as_user() { "${clear_environment[@]}" chroot --userspec=65534:65534 "$box" sh -euc "cd /tmp; $1"; }
packages() { as_root dpkg-query -W -f='${Package}\n' | sort; }
fail() { echo "FAILED: $*" >&2; exit 1; }
passed() { printf 'ok  %s\n' "$*"; }
# expect CODE TEXT COMMAND: runs it without rights; its exit code must be CODE and TEXT in what it prints.
expect() {
  local code=0
  as_user "$3" >"$work/out" 2>&1 || code=$?
  [[ $code == "$1" ]] && grep -qF -- "$2" "$work/out" ||
    { cat "$work/out" >&2; fail "$3: exit code $code, expected $1 and '$2'"; }
  passed "$3"
}

packages >"$work/before"
as_root apt-get update -qq >"$work/apt.log" 2>&1 &&
  as_root apt-get install -y --no-install-recommends /capsoc.deb >>"$work/apt.log" 2>&1 ||
  { cat "$work/apt.log" >&2; fail "the package cannot be installed"; }
packages >"$work/after"
added=$(comm -13 "$work/before" "$work/after" | tr '\n' ' ')
echo "installed with it: $added"
for unwanted in -dev gcc-arm g++ cmake python3 verilator; do
  [[ " $added" != *$unwanted* ]] || fail "run-time packages only, but there is $unwanted"
done
passed "run-time packages only"
as_root sh -c 'ldd /usr/bin/capsoc $(dpkg -L capsoc | grep "\.so$")' >"$work/ldd"
for part in bin/capsoc libcapsoc_reference.so libcapsoc_rtl_precise.so libcapsoc_rtl_paper.so; do
  grep -q "^/.*$part:\$" "$work/ldd" || fail "$part is not in the package"
done
! grep 'not found' "$work/ldd" || { cat "$work/ldd" >&2; fail "the program or one of its libraries misses a library"; }
passed "every shared library is found"

expect 0 "(commit " "capsoc --version"
expect 0 "coprocessor" "capsoc info"
expect 0 "exit 0: " "capsoc run --json /tmp/result.json"
grep -q '"path": "/usr/share/capsoc/firmware/selfcal.elf"' "$box/tmp/result.json" || fail "the main job's program is not the package's"
expect 124 "samples, 2.00 simulated s" "capsoc run --simlimit 2 --coprocessor rtl"
expect 124 "samples, 2.00 simulated s" "capsoc run --simlimit 2 --coprocessor lockstep --arithmetic paper"
expect 0 "calibration.json" "capsoc fit /usr/share/capsoc/traces/soc_eq21.toml"
expect 0 "exit 0: " "cp /usr/bin/capsoc /tmp/alone; /tmp/alone run /usr/share/capsoc/firmware/hello.elf --json /tmp/alone.json"
grep -q '"built-in:soc_eq21.toml"' "$box/tmp/alone.json" || fail "a copy without its files does not use the sensor that is built in"
expect 2 "the default program is not there" "/tmp/alone run"
for file in doc/capsoc/copyright doc/capsoc/README.md man/man1/capsoc.1.gz man/man1/capsoc-run.1.gz \
  bash-completion/completions/capsoc zsh/vendor-completions/_capsoc fish/vendor_completions.d/capsoc.fish \
  capsoc/template/Makefile capsoc/include/capsoc_device.h capsoc/svd/capsoc.svd; do
  [[ -f $box/usr/share/$file ]] || fail "/usr/share/$file is missing"
done
passed "man pages, completions, template, register description, copyright"

as_root apt-get purge -y -qq capsoc >"$work/apt.log" 2>&1 || { cat "$work/apt.log" >&2; fail "the package cannot be removed"; }
left=$(find "$box/usr" "$box/etc" "$box/var/lib/dpkg/info" -name '*capsoc*')
[[ -z $left ]] || fail "left behind: $left"
passed "removed without a trace"
