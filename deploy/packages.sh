#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The Debian 12 packages that Limn needs, in one place. Installs those that are missing, and says nothing if none is.
#   deploy/packages.sh [build] [run] [test] [bench] [demo] [debs]   (default: build run)
#   deploy/packages.sh --list build run              prints the names, installs nothing
set -eu

# Compiler and the libraries that programs are built from.
build="ca-certificates ccache cmake g++ make ninja-build pkg-config
  flatbuffers-compiler libflatbuffers-dev libdraco-dev libglm-dev libexpected-dev libssl-dev
  libwebsockets-dev libev-dev libsystemd-dev prometheus-cpp-dev libcli11-dev libspdlog-dev nlohmann-json3-dev libtomlplusplus-dev libstb-dev
  libegl-dev libgles-dev libosmesa6-dev libglfw3-dev libimgui-dev
  libopenmesh-dev libcgal-dev libtinygltf-dev zlib1g-dev libopencv-core-dev libopencv-imgproc-dev"

# What the programs open at run time and the packages above do not bring: Mesa's software drivers.
run="libegl-mesa0 libgl1-mesa-dri libosmesa6 libwebsockets-evlib-ev"

# Tests, benches, sanitizers and style checks.
test="libgtest-dev libbenchmark-dev draco openssl python3 python3-websockets git xvfb xauth xdotool
  librsvg2-bin clang libclang-rt-14-dev llvm-14 clang-format clang-tidy"

# What benches compare with, where it is there.
bench="libembree-dev libeigen3-dev libmeshoptimizer-dev"

# What deploy/demo.sh itself calls.
demo="python3 tar"

# What deploy/debs.sh packs and checks with.
debs="dpkg-dev fakeroot file git gzip help2man lintian"

die() { printf 'packages.sh: %s\n' "$*" >&2; exit 1; }

list=
case ${1:-} in
  --list) list=yes; shift ;;
  -h | --help) sed -n '3,5s/^# //p' "$0"; exit 0 ;;
esac
[ $# -gt 0 ] || set -- build run
wanted=
for purpose in "$@"; do
  case $purpose in
    build) wanted="$wanted $build" ;;
    run) wanted="$wanted $run" ;;
    test) wanted="$wanted $test" ;;
    bench) wanted="$wanted $bench" ;;
    demo) wanted="$wanted $demo" ;;
    debs) wanted="$wanted $debs" ;;
    *) echo "packages.sh: unknown purpose '$purpose'; use build, run, test, bench, demo or debs" >&2; exit 2 ;;
  esac
done
# Word splitting is the point: the lists are words.
# shellcheck disable=SC2086
wanted=$(printf '%s\n' $wanted | sort -u)
[ -z "$list" ] || { printf '%s\n' "$wanted"; exit 0; }

command -v dpkg-query >/dev/null ||
  die "this is not Debian (no dpkg); install by hand what 'deploy/packages.sh --list $*' prints"

missing=
for package in $wanted; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null ||
    die "packages are missing and there is no sudo; as root: apt-get install --no-install-recommends$missing"
  as_root=sudo
fi
echo "installing:$missing" >&2
log=$(mktemp)
trap 'rm -f "$log"' EXIT
apt() {
  # shellcheck disable=SC2086
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=120 "$@" >"$log" 2>&1 || {
    tail -n 20 "$log" >&2
    die "apt-get $1 failed (above); is this Debian 12 with network access?"
  }
}
apt update
# shellcheck disable=SC2086
apt install --no-install-recommends $missing
