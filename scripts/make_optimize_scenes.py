#!/usr/bin/env python3
"""Makes the meshes, textures and cameras of scenes/optimize and of scenes/paper/optimize_mesh.toml.

Needs NumPy. Nothing in them is taken from elsewhere: balls with dents and bumps by formula.
"""

import json
import struct
import sys
import zlib
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "scenes" / "optimize"


def icosphere(subdivisions):
    t = (1 + 5**0.5) / 2
    points = [(-1, t, 0), (1, t, 0), (-1, -t, 0), (1, -t, 0), (0, -1, t), (0, 1, t),
              (0, -1, -t), (0, 1, -t), (t, 0, -1), (t, 0, 1), (-t, 0, -1), (-t, 0, 1)]
    points = [np.array(p) / np.linalg.norm(p) for p in points]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
             (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
             (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(subdivisions):
        middle, new = {}, []

        def between(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                p = points[a] + points[b]
                points.append(p / np.linalg.norm(p))
                middle[key] = len(points) - 1
            return middle[key]

        for a, b, c in faces:
            ab, bc, ca = between(a, b), between(b, c), between(c, a)
            new += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = new
    return np.array(points), np.array(faces)


def globe(rings, sectors):
    """A sphere of latitudes with texture coordinates; its seam and its poles are several vertices."""
    points, uvs, faces = [], [], []
    for r in range(rings + 1):
        for s in range(sectors + 1):
            a, b = np.pi * r / rings, 2 * np.pi * (s % sectors) / sectors
            ring = np.sin(a) if 0 < r < rings else 0.0
            points.append((ring * np.cos(b), ring * np.sin(b), np.cos(a)))
            uvs.append((s / sectors, r / rings))
    at = lambda r, s: r * (sectors + 1) + s
    for r in range(rings):
        for s in range(sectors):
            a, b, c, d = at(r, s), at(r + 1, s), at(r + 1, s + 1), at(r, s + 1)
            if r > 0:
                faces.append((a, b, d))
            if r < rings - 1:
                faces.append((d, b, c))
    return np.array(points), np.array(uvs), np.array(faces)


def dented(points):
    """Three dents, which are concave, and two bumps."""
    radius = np.ones(len(points))
    for direction, depth, width in [((1, 0.2, 0.1), -0.45, 0.45), ((-0.6, 0.8, 0.3), -0.4, 0.4),
                                    ((-0.3, -0.9, -0.2), -0.4, 0.42), ((0.1, 0.1, 1), 0.3, 0.4),
                                    ((0.3, -0.4, -0.9), 0.25, 0.45)]:
        axis = np.array(direction) / np.linalg.norm(direction)
        angle = np.arccos(np.clip(points @ axis, -1, 1))
        radius += depth * np.exp(-((angle / width) ** 2))
    return points * radius[:, None]


def write_ply(path, points, faces, uvs=None):
    fields = ["x", "y", "z"] + ([] if uvs is None else ["u", "v"])
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    header += [f"property float {f}" for f in fields]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    rows = points if uvs is None else np.hstack([points, uvs])
    with open(path, "wb") as file:
        file.write(("\n".join(header) + "\n").encode())
        file.write(rows.astype("<f4").tobytes())
        for face in faces:
            file.write(struct.pack("<Biii", 3, *map(int, face)))


def write_png(path, image):
    height, width, _ = image.shape
    rows = b"".join(b"\0" + image[y].tobytes() for y in range(height))
    chunk = lambda kind, data: (struct.pack(">I", len(data)) + kind + data
                                + struct.pack(">I", zlib.crc32(kind + data)))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
                     + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def stripes(width, height):
    u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    waves = [0.5 + 0.35 * np.sin(2 * np.pi * (4 * u + phase) + 3 * np.cos(6 * np.pi * v))
             for phase in (0, 0.33, 0.66)]
    return (255 * np.stack(waves, axis=-1)).round().astype(np.uint8)


def cameras(path, count, distance):
    """Around the object on a spiral, as NeRF's files have them: looking along -z, +y up."""
    frames = []
    for i in range(count):
        z = 0.85 - 1.7 * (i + 0.5) / count
        angle = i * np.pi * (3 - 5**0.5)
        back = np.array([np.sqrt(1 - z * z) * np.cos(angle), np.sqrt(1 - z * z) * np.sin(angle), z])
        right = np.cross([0, 0, 1], back)
        right /= np.linalg.norm(right)
        up = np.cross(back, right)
        matrix = np.eye(4)
        matrix[:3, :3] = np.stack([right, up, back], axis=1)
        matrix[:3, 3] = distance * back
        frames.append({"file_path": f"view_{i:02}", "transform_matrix": matrix.round(9).tolist()})
    text = json.dumps({"camera_angle_x": 0.65, "w": 128, "h": 128, "frames": frames}, indent=1)
    path.write_text(text + "\n")


def main():
    meshes = FOLDER / "meshes"
    meshes.mkdir(parents=True, exist_ok=True)
    points, faces = icosphere(3)
    write_ply(meshes / "ball.ply", points, faces)
    points, faces = icosphere(4)
    write_ply(meshes / "dented.ply", dented(points), faces)
    points, uvs, faces = globe(24, 48)
    write_ply(meshes / "globe.ply", points, faces, uvs)
    write_ply(meshes / "dented_globe.ply", dented(points), faces, uvs)
    write_png(FOLDER / "stripes.png", stripes(64, 32))
    write_png(FOLDER / "grey.png", np.full((32, 64, 3), 128, np.uint8))
    cameras(FOLDER / "cameras.json", 20, 4.2)
    # The star of the paper's scenes, halfway to a ball.
    star = (ROOT / "scenes/paper/meshes/star.ply").read_bytes()
    start = star.index(b"end_header\n") + 11
    positions = np.frombuffer(star, "<f4", 3 * 2562, start).reshape(-1, 3).astype(float)
    smooth = positions / np.linalg.norm(positions, axis=1)[:, None]
    smooth *= np.median(np.linalg.norm(positions, axis=1))
    write_ply(ROOT / "scenes/paper/meshes/star_start.ply", 0.5 * (positions + smooth),
              np.frombuffer(star, np.dtype([("n", "u1"), ("v", "<i4", 3)]), -1, start + 12 * 2562)["v"])


if __name__ == "__main__":
    sys.exit(main())
