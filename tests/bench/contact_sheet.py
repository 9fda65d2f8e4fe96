#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A contact sheet: models down, styles across, drawn by limn-client, for somebody to look at.

Usage: contact_sheet.py --out SHEET.png [--models DIR] [--store DIR] [--bin DIR] [NAME...]

NAME is a model by its file's stem (bunny, gears), prepared into the store where it is not there yet. Python's standard
library only. What is in which place is printed.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
import png

MODELS = ["bunny", "armadillo", "fandisk", "gears", "engine", "dragon", "hand"]
STYLES = ["pencil", "ink", "felt-pen", "technical"]
GAP = 4


def asset_of(options, name):
    """The folder of a prepared model, prepared now if need be."""
    entry = options.store / "names" / (name + ".json")
    if not entry.exists():
        found = sorted(f for f in options.models.iterdir() if f.is_file() and f.stem == name)
        if not found:
            sys.exit("contact_sheet.py: no model %s in %s" % (name, options.models))
        subprocess.run([options.bin / "limn-prepare", found[0], "--store", options.store, "--name", name], check=True)
    return options.store / "assets" / json.loads(entry.read_text())["asset"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", default=MODELS, metavar="NAME")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--models", type=pathlib.Path, default=ROOT.parent / "shared/models")
    parser.add_argument("--store", type=pathlib.Path, help="kept for the next sheet (default: a temporary one)")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin")
    parser.add_argument("--styles", default=",".join(STYLES))
    parser.add_argument("--size", type=int, default=512, help="of each picture, pixels")
    parser.add_argument("--camera", default="orbit:30,20")
    parser.add_argument("--flags", default="", help="more flags for limn-client render, in one string")
    options = parser.parse_args()
    styles = options.styles.split(",")
    with tempfile.TemporaryDirectory() as folder:
        options.store = options.store or pathlib.Path(folder) / "store"
        sheet, blank = [], bytes(3 * GAP)
        for name in options.names:
            asset, tiles = asset_of(options, name), []
            for style in styles:
                picture = pathlib.Path(folder) / "picture.png"
                subprocess.run(
                    [options.bin / "limn-client", "render", "--asset", asset, "--style", style, "--camera", options.camera,
                     "--size", "%dx%d" % (options.size, options.size), "--out", picture, *options.flags.split()],
                    check=True)
                tiles.append(png.read(picture)[2])
            print("%s: %s" % (name, ", ".join(styles)), flush=True)
            sheet += [blank.join(row) for row in zip(*tiles)]
            sheet += [bytes(len(sheet[0]))] * GAP
        png.write(options.out, len(sheet[0]) // 3, sheet)


main()
