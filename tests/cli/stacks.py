"""Small stacks of images with known truth, written as files. SPDX-License-Identifier: MIT"""
import struct
import zlib

import numpy as np

import harness
import model


def protocol():
    """Light and view of the paper's 84 samples."""
    angles = [(i, a, v) for v in (0, 20, 40, 60) for i in range(0, 61, 10) for a in (0, 90, 180)]
    li, ai, vi = np.array(angles, float).T
    return model.unit(li, ai), model.unit(vi, np.full(len(vi), 180.0))


def make(height, width, channels=3, lobes=1, seed=1, noise=0.01, normals=None):
    """BRDF values, samples x height x width x channels, and their light and view."""
    rng = np.random.default_rng(seed)
    light, view = protocol()
    stack = np.empty((len(light), height, width, channels))
    for row in range(height):
        for column in range(width):
            normal = (0, 0, 1) if normals is None else normals[row, column]
            a, b, c, nl, _ = model.directions_to_abc(light, view, normal)
            radiance = a[:, None] * rng.uniform(0.1, 0.5, channels)
            for p in range(lobes):
                s = 1 / (rng.uniform(0.08, 0.2) if p == 0 else rng.uniform(0.35, 0.6)) ** 2
                radiance = radiance + (b * s * np.exp(-s * c))[:, None] * rng.uniform(0.02, 0.1, channels)
            radiance = radiance * (1 + noise * rng.standard_normal(radiance.shape))
            stack[:, row, column] = radiance / np.maximum(nl, 1e-3)[:, None]
    return stack, light, view


def vectors_csv(path, light, view, files=None):
    with open(path, "w") as file:
        file.write(("file," if files else "") + "lx,ly,lz,vx,vy,vz\n")
        for i, row in enumerate(np.hstack([light, view]).tolist()):
            file.write((files[i] + "," if files else "") + ",".join(map(repr, row)) + "\n")


def texel_csv(path, light, view, values):
    """One texel as `brdffit fit` reads it."""
    with open(path, "w") as file:
        file.write("lx,ly,lz,vx,vy,vz," + ",".join("abcdefgh"[k] + "_" for k in range(values.shape[1])) + "\n")
        for row in np.hstack([light, view, values]).tolist():
            file.write(",".join(map(repr, row)) + "\n")


def pfm(path, image, big_endian=False):
    image = np.asarray(image, "f4")
    kind = "PF" if image.ndim == 3 else "Pf"
    head = "%s\n%d %d\n%s\n" % (kind, image.shape[1], image.shape[0], "1.0" if big_endian else "-1.0")
    path.write_bytes(head.encode() + image[::-1].astype(">f4" if big_endian else "<f4").tobytes())


def read_pfm(path):
    head, size, scale, rest = path.read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    assert scale == b"-1.0"
    image = np.frombuffer(rest, "<f4").reshape(height, width, 3 if head == b"PF" else 1)[::-1]
    return image if head == b"PF" else image[..., 0]


def png(path, image):
    """uint8 or uint16, grey, colour or colour and alpha."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    kind = {1: 0, 3: 2, 4: 6}[image.shape[2]]
    rows = b"".join(b"\0" + row.astype(">u%d" % image.itemsize).tobytes() for row in image)
    head = struct.pack(">IIBBBBB", image.shape[1], image.shape[0], 8 * image.itemsize, kind, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) +
                     chunk(b"IEND", b""))


def run(folder, *arguments, expect=0, **more):
    done = harness.run("map", *map(str, arguments), cwd=folder, **more)
    assert done.returncode == expect, (done.returncode, done.stdout, done.stderr)
    return done


def maps(path):
    """The maps of a .npz or of a folder."""
    if path.is_dir():
        return {file.stem: np.load(file) for file in path.glob("*.npy")}
    with np.load(path) as file:
        return dict(file)


def same(one, other):
    return one.keys() == other.keys() and all(np.array_equal(one[k], other[k], equal_nan=True) for k in one)
