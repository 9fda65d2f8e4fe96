#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# One picture of every way to draw, same model and camera, into deploy/gallery: the README's table of them.
#   deploy/gallery.sh [MESH-FILE]   (deploy/demo.sh's scan; run that first, it also builds)
set -eu
cd "$(dirname "$0")/.."
client=build/release/bin/limn-client
mesh=${1:-build/demo/armadillo.off}
if [ ! -x "$client" ] || [ ! -f "$mesh" ]; then
  echo "gallery.sh: $client or $mesh is missing: run deploy/demo.sh first" >&2
  exit 1
fi
folder=deploy/gallery
mkdir -p "$folder"
store=$(mktemp -d)
trap 'rm -rf "$store"' EXIT
build/release/bin/limn-prepare "$mesh" --store "$store" --name model >/dev/null
asset=$(find "$store/assets" -mindepth 1 -maxdepth 1 -type d | head -n 1)

# draw FILE MORE-FLAGS...
draw() {
  file=$folder/$1.png
  shift
  "$client" render --asset "$asset" --camera orbit:200,12,2.75 --size 270x270 "$@" --out "$file"
  echo "$file: $(wc -c <"$file") bytes"
}

draw strokes --draw strokes --style pencil --width 2.2
draw shaded --draw shaded --style technical
draw clip --draw clip --hull-faces 500 --style technical
draw image-edges --draw image-edges --style technical --width 1
draw geometry-shader --draw geometry-shader --style technical --width 1.4
# A light to the upper left: what it sees the outline of.
draw light --draw geometry-shader --light -300,300,-300 --style technical --width 1.2 --line-color '#c03018'
for way in wireframe translate z-scale offset fatten; do
  draw "image-precision-$way" --draw "image-precision:$way" --style technical --width 1.6
done
draw image-precision-charcoal --draw image-precision:charcoal --style technical --width 1
