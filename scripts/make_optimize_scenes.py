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
# Texels along the sides of a patch of the texture.
PATCH = 32


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


def cubed_sphere(cells):
    """A sphere of six square patches with texture coordinates: triangles are nearly even. Along seams
    there are two vertices at one place. Patches are three by two in the texture, and keep half a
    texel of PATCH away from their neighbours."""
    points, uvs, faces = [], [], []
    for patch in range(6):
        first = len(points)
        for i in range(cells + 1):
            for j in range(cells + 1):
                s, t = i / cells, j / cells
                points.append(on_patch(patch, s, t))
                inside = [(0.5 + (PATCH - 1) * c) / PATCH for c in (s, t)]
                uvs.append(((patch % 3 + inside[0]) / 3, (patch // 3 + inside[1]) / 2))
        at = lambda i, j: first + i * (cells + 1) + j
        for i in range(cells):
            for j in range(cells):
                a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
                faces += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
    return np.array(points), np.array(uvs), np.array(faces)


def on_patch(patch, s, t):
    """A point of the unit sphere; equal steps of s and t are equal angles."""
    axis, side = patch // 2, 1 - 2 * (patch % 2)
    p = np.zeros(3)
    # The order of the other two axes keeps triangles facing outwards.
    p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = (
        side, side * np.tan(np.pi / 4 * (2 * s - 1)), np.tan(np.pi / 4 * (2 * t - 1)))
    # Places on seams are the same number from either patch.
    return (p / np.linalg.norm(p)).round(12)


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


def stripes():
    """Waves over the sphere, as the texture of cubed_sphere has them."""
    image = np.zeros((2 * PATCH, 3 * PATCH, 3), np.uint8)
    for patch in range(6):
        for i in range(PATCH):
            for j in range(PATCH):
                x, y, z = on_patch(patch, i / (PATCH - 1), j / (PATCH - 1))
                colour = [0.5 + 0.35 * np.sin(5 * x + 3 * np.cos(4 * y + phase) + 4 * z + phase)
                          for phase in (0, 2, 4)]
                row = patch // 3 * PATCH + j
                image[row, patch % 3 * PATCH + i] = np.round(255 * np.array(colour))
    return image


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
    points, uvs, faces = cubed_sphere(16)
    write_ply(meshes / "cubed.ply", points, faces, uvs)
    write_ply(meshes / "dented_cubed.ply", dented(points), faces, uvs)
    write_png(FOLDER / "stripes.png", stripes())
    write_png(FOLDER / "grey.png", np.full((2 * PATCH, 3 * PATCH, 3), 128, np.uint8))
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
