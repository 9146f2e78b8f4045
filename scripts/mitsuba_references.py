#!/usr/bin/env python3
"""Renders scenes/materials/*.xml with Mitsuba 3 and writes what comes out to tests/scene/mitsuba/NAME.txt.

Needs `pip install mitsuba numpy` (made with Mitsuba 3.9.1). Usage, from anywhere:

    python scripts/mitsuba_references.py                # all scenes, about five minutes of two cores
    python scripts/mitsuba_references.py plastic null   # some
    python scripts/mitsuba_references.py --pictures     # scenes/materials/textures/ instead
    python scripts/mitsuba_references.py --keys         # tests/scene/mitsuba/keys.txt instead: names of parameters

Each scene is rendered once for each of SEEDS seeds, independent of each other. A line of a file is a block of 8×8
pixels: its row and column from the top left, the means of its r, g, b, and their standard errors, which come from the
spread among the seeds and are hence themselves known to some 13 % (32 seeds). A block of nothing but plain sky, or
black, has no spread and the error 0, though its mean is rounded (by up to 2e-5 of it). The first line says how it was made.
Mitsuba's results depend a little on the machine (its vector instructions), so another run does not give the same bytes.
"""

from pathlib import Path
import struct
import sys
import zlib

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
mi.set_log_level(mi.LogLevel.Error)

ROOT = Path(__file__).resolve().parent.parent
SCENES = ROOT / "scenes" / "materials"
OUT = ROOT / "tests" / "scene" / "mitsuba"

SEEDS = 32
BLOCK = 8
# Samples per pixel and seed. More where light has to be found by chance.
SPP = {"dielectric": 1024, "roughdielectric_ggx": 1024, "roughdielectric_beckmann": 1024, "null": 512}
SPP_OTHERS = 256


def reference(name):
    scene = mi.load_file(str(SCENES / f"{name}.xml"))
    spp = SPP.get(name, SPP_OTHERS)
    means = []
    for seed in range(SEEDS):
        image = np.array(mi.render(scene, seed=seed, spp=spp)).astype(np.float64)
        assert np.isfinite(image).all(), f"{name}: not finite"
        rows, columns = image.shape[0] // BLOCK, image.shape[1] // BLOCK
        means.append(image.reshape(rows, BLOCK, columns, BLOCK, 3).mean(axis=(1, 3)))
    means = np.array(means)
    mean = means.mean(axis=0)
    error = means.std(axis=0, ddof=1) / np.sqrt(SEEDS)

    size = f"{image.shape[1]}x{image.shape[0]} pixels, blocks of {BLOCK}x{BLOCK}"
    made = f"Mitsuba {mi.__version__}, {mi.variant()}, {spp} samples per pixel x {SEEDS} seeds"
    lines = [f"# {made}; {size}: row, column, mean r g b, standard error r g b"]
    for row in range(rows):
        for column in range(columns):
            values = [*mean[row, column], *error[row, column]]
            lines.append(f"{row} {column} " + " ".join(f"{x:.6g}" for x in values))
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / f"{name}.txt").write_text("\n".join(lines) + "\n")
    relative = error[mean > 0] / mean[mean > 0]
    print(f"{name}: mean {mean.mean():.4f}, error median {np.median(relative):.2%}, largest {relative.max():.2%}")


def keys():
    """All names of parameters, the camera's and film's aside; sizes of buffers and matrices instead of what is in them."""
    lines = [f"# Mitsuba {mi.__version__}, {mi.variant()}, load_file(optimize=False): names that mi.traverse gives"]
    for path in sorted(SCENES.glob("*.xml")):
        lines.append(f"[{path.stem}]")
        values = mi.traverse(mi.load_file(str(path), optimize=False))
        for key in values.keys():
            if key.startswith("cam.") or key == "allow_thread_reordering":
                continue
            value = values[key]
            if "Transform" in type(value).__name__:
                rows = len(value.matrix)
                text = f"{rows}x{rows} matrix"
            elif "Tensor" in type(value).__name__:
                text = "shape " + "x".join(str(n) for n in value.shape)
            elif not hasattr(value, "__len__"):
                text = f"{float(value):.6g}"
            elif len(value) > 3 or len(value) == 0:
                text = f"{len(value)} numbers"
            else:
                text = ", ".join(f"{x:.6g}" for x in value)
            lines.append(f"{key} = {text}")
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / "keys.txt").write_text("\n".join(lines) + "\n")


def png(path, pixels):
    """Writes bytes of shape (height, width, 1 or 3) as an 8-bit PNG."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width, channels = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels.astype(np.uint8))
    kind = {1: 0, 3: 2}[channels]
    header = struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + body)


def exr(path, pixels):
    mi.Bitmap(pixels.astype(np.float32)).write(str(path))


def pictures():
    """Small pictures without any symmetry, so that none can be turned or flipped unnoticed."""
    folder = SCENES / "textures"
    folder.mkdir(parents=True, exist_ok=True)
    y, x = np.mgrid[0:8, 0:8]
    cells = (x // 2 + y // 2) % 2
    colours = np.stack([30 + 25 * x, 220 - 24 * y, 40 + 150 * cells], axis=-1)
    colours[0, :3] = [250, 250, 240]
    colours[6:, 6:] = [200, 20, 20]
    png(folder / "colours.png", colours)
    png(folder / "roughness.png", (20 + 12 * x + 9 * y + 30 * cells)[..., None])

    # Directions as colours, and heights.
    x_tilt, y_tilt = 0.35 * np.sin(1.1 * x + 0.4 * y), 0.3 * np.cos(0.7 * x - 1.3 * y)
    up = np.sqrt(1 - x_tilt**2 - y_tilt**2)
    png(folder / "normals.png", np.round(127.5 * (1 + np.stack([x_tilt, y_tilt, up], axis=-1))))
    png(folder / "heights.png", np.round(128 + 90 * np.sin(0.9 * x + 0.3 * y) * np.cos(0.8 * y))[..., None])

    lamp = np.stack([0.3 + 1.2 * x, 0.5 + 0.6 * y, 1.0 + 3.0 * cells], axis=-1)
    lamp[:2, :2] = [14, 12, 8]
    exr(folder / "lamp.exr", lamp)

    # Rows from +Y down to -Y: a blue sky, brighter on one side, a warm ground, and a sun.
    y, x = np.mgrid[0:16, 0:32]
    side = 1 + 0.5 * np.sin((x + 0.5) / 32 * 2 * np.pi)
    sky = np.where((y < 9)[..., None], [0.15, 0.25, 0.45], [0.2, 0.14, 0.08]) * side[..., None]
    sky[4:6, 20:23] = [40, 34, 24]
    exr(folder / "sky.exr", sky)


def main():
    names = sys.argv[1:]
    if names == ["--pictures"]:
        return pictures()
    if names == ["--keys"]:
        return keys()
    for name in names or sorted(path.stem for path in SCENES.glob("*.xml")):
        reference(name)


if __name__ == "__main__":
    main()
