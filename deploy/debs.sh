#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds a release and packs it: limn-server_*.deb and limn-client_*.deb in build/release/debs, checked by lintian.
set -eu
cd "$(dirname "$0")/.."
case ${1:-} in
  "") ;;
  -h | --help) sed -n '3s/^# //p' "$0"; exit 0 ;;
  *) echo "debs.sh: unknown option '$1'; it takes none" >&2; exit 2 ;;
esac
deploy/packages.sh build run debs
files=$PWD/build/release/debs
rm -rf "$files"
mkdir -p build/release
cmake --preset release -DLIMN_BUILD_TESTS=OFF -DLIMN_BUILD_BENCH=OFF >build/release/configure.log 2>&1 ||
  { cat build/release/configure.log >&2; exit 1; }
cmake --build --preset release --target limn-prepare limn-server limn-client limn-load

# manual PACKAGE PROGRAM DESCRIPTION
manual() {
  mkdir -p "$files/$1/man/man1"
  help2man --no-info --name="$3" --output="$files/$1/man/man1/$2.1" "build/release/bin/$2"
  gzip -9n "$files/$1/man/man1/$2.1"
}
manual server limn-server "serve meshes as silhouette-first streams"
manual server limn-prepare "prepare mesh files for limn-server"
manual client limn-client "draw streamed meshes as stylised lines"
manual client limn-load "load limn-server with scripted clients"

version=$(sed -n 's/^project(limn VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
date=$(git log -1 --format=%cD 2>/dev/null || date -R)
for package in server client; do
  doc=$files/$package/doc/limn-$package
  mkdir -p "$doc"
  {
    echo "Files: *"
    sed -n '1,/^----/p' LICENSE | sed '$d'
    echo "The Apache License 2.0 is in /usr/share/common-licenses/Apache-2.0,"
    echo "the GNU General Public License 3 in /usr/share/common-licenses/GPL-3."
  } >"$doc/copyright"
  printf 'limn-%s (%s) unstable; urgency=medium\n\n  * Release %s.\n\n -- The Limn authors <limn@example.org>  %s\n' \
    "$package" "$version" "$version" "$date" | gzip -9n >"$doc/changelog.gz"
done
(cd build/release && cpack >debs/cpack.log) || { tail -n 20 "$files/cpack.log" >&2; exit 1; }
lintian --fail-on error,warning "$files"/*.deb
ls "$files"/*.deb
