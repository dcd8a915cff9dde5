"""brdffit map: every kind of file that it reads, and what it says of those that it cannot. SPDX-License-Identifier: MIT"""
import struct
import zipfile

import numpy as np
import pytest

import stacks


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Numbers that every type can hold, and what comes of them as float64."""
    path = tmp_path_factory.mktemp("map")
    stack, light, view = stacks.make(4, 3, noise=0)
    stack = np.round(stack * 64)  # whole, and below 2048: exact as float16 too
    assert 100 < stack.max() < 2048
    np.save(path / "stack.npy", stack)
    stacks.vectors_csv(path / "geometry.csv", light, view)
    stacks.run(path, "stack.npy", "-g", "geometry.csv", "-o", "wanted.npz")
    return path


@pytest.mark.parametrize("kind", ["<f2", ">f2", "<f4", ">f4", ">f8", "<u2", ">u2", "<i2", "<i4", ">i8", "<u8"])
@pytest.mark.parametrize("order", "CF")
def test_types(folder, tmp_path, kind, order):
    np.save(tmp_path / "s.npy", np.array(np.load(folder / "stack.npy").astype(kind), order=order))
    stacks.run(folder, tmp_path / "s.npy", "-g", "geometry.csv", "-o", tmp_path / "m.npz", "--tile", "3")
    assert (tmp_path / "m.npz").read_bytes() == (folder / "wanted.npz").read_bytes()


@pytest.mark.parametrize("version", [(2, 0), (3, 0)])
def test_versions(folder, tmp_path, version):
    with open(tmp_path / "s.npy", "wb") as file:
        np.lib.format.write_array(file, np.load(folder / "stack.npy"), version=version)
    stacks.run(folder, tmp_path / "s.npy", "-g", "geometry.csv", "-o", tmp_path / "m.npz")
    assert (tmp_path / "m.npz").read_bytes() == (folder / "wanted.npz").read_bytes()


def zip64(path, name, data):
    """One stored member, described in zip64's wide fields throughout."""
    import zlib
    crc, size = zlib.crc32(data), len(data)
    local = struct.pack("<4s5H3I2H", b"PK\3\4", 45, 0, 0, 0, 33, crc, 2**32 - 1, 2**32 - 1, len(name), 20)
    local += name + struct.pack("<2H2Q", 1, 16, size, size)
    entry = struct.pack("<4s6H3I5H2I", b"PK\1\2", 45, 45, 0, 0, 0, 33, crc, 2**32 - 1, 2**32 - 1, len(name), 28, 0, 0,
                        0, 0, 2**32 - 1) + name + struct.pack("<2H3Q", 1, 24, size, size, 0)
    start = len(local) + size
    end = struct.pack("<4sQ2H2I4Q", b"PK\6\6", 44, 45, 45, 0, 0, 1, 1, len(entry), start)
    end += struct.pack("<4sIQI", b"PK\6\7", 0, start + len(entry), 1)
    end += struct.pack("<4s4H2IH", b"PK\5\6", 0, 0, 2**16 - 1, 2**16 - 1, 2**32 - 1, 2**32 - 1, 0)
    path.write_bytes(local + data + entry + end)


def test_npz(folder, tmp_path):
    stack = np.load(folder / "stack.npy")
    np.savez(tmp_path / "stored.npz", stack=stack, other=stack[:1])
    np.savez_compressed(tmp_path / "deflated.npz", stack)
    zip64(tmp_path / "wide.npz", b"stack.npy", (folder / "stack.npy").read_bytes())
    assert zipfile.ZipFile(tmp_path / "wide.npz").testzip() is None
    for name in ("stored.npz:stack", "deflated.npz", "wide.npz"):
        stacks.run(folder, tmp_path / name, "-g", "geometry.csv", "-o", tmp_path / "m.npz")
        assert (tmp_path / "m.npz").read_bytes() == (folder / "wanted.npz").read_bytes(), name
    done = stacks.run(folder, tmp_path / "stored.npz", "-g", "geometry.csv", expect=3)
    assert "several arrays: name one (arrays: 2)" in done.stderr
    assert "no array of that name" in stacks.run(folder, tmp_path / "stored.npz:x", "-g", "geometry.csv", expect=3).stderr
    assert zipfile.ZipFile(folder / "wanted.npz").testzip() is None


def test_images(folder, tmp_path):
    """A folder by name; a list in another order that gives the directions; grey images."""
    stack = np.load(folder / "stack.npy")
    names = ["i%03d.pfm" % i for i in range(len(stack))]
    (tmp_path / "images").mkdir()
    for i, (name, image) in enumerate(zip(names, stack)):
        stacks.pfm(tmp_path / "images" / name, image, big_endian=i % 2 == 1)
    stacks.run(folder, tmp_path / "images", "-g", "geometry.csv", "-o", tmp_path / "m.npz", "--tile", "3")
    assert (tmp_path / "m.npz").read_bytes() == (folder / "wanted.npz").read_bytes()
    light, view = stacks.protocol()
    order = np.random.default_rng(2).permutation(len(stack))
    stacks.vectors_csv(tmp_path / "list.csv", light[order], view[order], ["images/" + names[i] for i in order])
    stacks.run(tmp_path, "list.csv", "-o", "l.npz")
    one, other = stacks.maps(tmp_path / "l.npz"), stacks.maps(folder / "wanted.npz")
    assert np.allclose(one["sigma"], other["sigma"], rtol=1e-9)  # sums run in another order
    for name, image in zip(names, stack):
        stacks.pfm(tmp_path / "images" / name, image[..., 1])
    stacks.run(folder, tmp_path / "images", "-g", "geometry.csv", "-o", tmp_path / "grey.npz")
    np.save(tmp_path / "grey.npy", stack[..., 1])
    stacks.run(folder, tmp_path / "grey.npy", "-g", "geometry.csv", "-o", tmp_path / "array.npz")
    assert (tmp_path / "grey.npz").read_bytes() == (tmp_path / "array.npz").read_bytes()


@pytest.mark.parametrize("bits,srgb", [(8, False), (8, True), (16, False)])
def test_png(folder, tmp_path, bits, srgb):
    stack = np.load(folder / "stack.npy")
    values = np.round(stack / stack.max() * (2**bits - 1)).astype("u%d" % (bits // 8))
    (tmp_path / "images").mkdir()
    for i, image in enumerate(values):
        image = np.concatenate([image, image[..., :1]], 2) if i == 5 else image  # an alpha channel
        stacks.png(tmp_path / "images" / ("%03d.png" % i), image)
    linear = values / (2.0**bits - 1)
    if srgb:
        linear = np.where(linear <= 0.04045, linear / 12.92, ((linear + 0.055) / 1.055) ** 2.4)
    np.save(tmp_path / "s.npy", linear.astype("f4"))
    stacks.run(folder, tmp_path / "s.npy", "-g", "geometry.csv", "-o", tmp_path / "a.npz")
    stacks.run(folder, tmp_path / "images", "-g", "geometry.csv", "-o", tmp_path / "b.npz", *["--srgb"] * srgb)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    if bits == 16:
        done = stacks.run(folder, tmp_path / "images", "-g", "geometry.csv", "--srgb", expect=3)
        assert "000.png: --srgb is for 8-bit images" in done.stderr
        (tmp_path / "images" / "007.png").write_bytes((tmp_path / "images" / "007.png").read_bytes()[:60])
        done = stacks.run(folder, tmp_path / "images", "-g", "geometry.csv", "-o", tmp_path / "c.npz", expect=3)
        assert "007.png: the PNG cannot be read" in done.stderr and not (tmp_path / "c.npz").exists()


def refuse(folder, *arguments, says, expect=3):
    done = stacks.run(folder, *arguments, "-o", "never.npz", expect=expect)
    for words in [says] if isinstance(says, str) else says:
        assert words in done.stderr, done.stderr
    assert done.stdout == "" and not (folder / "never.npz").exists()


def test_shapes(folder, tmp_path):
    """What does not fit together is named, with what would fit."""
    stack = np.load(folder / "stack.npy")
    light, view = stacks.protocol()
    stacks.vectors_csv(tmp_path / "short.csv", light[:-1], view[:-1])
    files = {"flat": stack[0, 0], "l83": light[:-1], "light": light, "n": np.zeros((4, 4, 3)), "m": np.ones((3, 4))}
    for name, array in files.items():
        np.save(tmp_path / (name + ".npy"), array)
    at = tmp_path
    refuse(folder, at / "flat.npy", "-g", "geometry.csv", says=["flat.npy: its shape is 3 x 3", "samples x height x width"])
    refuse(folder, "stack.npy", "-g", at / "short.csv", says=["stack.npy: it has 84 samples", "short.csv has 83"])
    refuse(folder, "stack.npy", "--lights", at / "l83.npy",
           says=["l83.npy: its shape is 83 x 3, and should be 84 x 3", "84 x 4 x 3 x 3"])
    refuse(folder, "stack.npy", "-g", "geometry.csv", "--normals", at / "n.npy",
           says="n.npy: its shape is 4 x 4 x 3, and should be 4 x 3 x 3")
    refuse(folder, "stack.npy", "-g", "geometry.csv", "--mask", at / "m.npy",
           says="m.npy: its shape is 3 x 4, and should be 4 x 3")


def test_usage(folder):
    refuse(folder, "stack.npy", says="needs --geometry FILE.csv or --lights", expect=2)
    refuse(folder, "stack.npy", "-g", "geometry.csv", "--lights", "x.npy", says="given twice", expect=2)
    refuse(folder, "stack.npy", "-g", "geometry.csv", "--views", "x.npy", says="--views needs --lights", expect=2)
    refuse(folder, "stack.npy", "-g", "geometry.csv", "--format", "pfm", says="needs a folder", expect=2)
    refuse(folder, "a.npy", "b.npy", says="needs one STACK", expect=2)
    refuse(folder, "none.npy", "-g", "geometry.csv", says="none.npy: there is no such file", expect=1)
    refuse(folder, "stack.npy", "-g", "geometry.csv", "--lobes", "4", says="--lobes does not take '4'", expect=2)


def test_damaged(folder, tmp_path):
    """Files that are cut, lie or are something else: said with the file's name, and the byte where there is one."""
    good = (folder / "stack.npy").read_bytes()
    head = good[:128]
    np.savez_compressed(tmp_path / "good.npz", np.load(folder / "stack.npy"))
    packed = bytearray((tmp_path / "good.npz").read_bytes())
    packed[len(packed) // 2] ^= 0x55
    cases = {
        "cut.npy": (good[:-10], "shorter than its header says (bytes missing: 10)"),
        "long.npy": (good + b"xyz", "longer than its header says (bytes too many: 3)"),
        "head.npy": (good[:40], "ends within the NPY header (at byte: 40)"),
        "huge.npy": (head.replace(b"(84, 4, 3, 3)", b"(99999999999, 99999999999)", 1), "more bytes than can be addressed"),
        "object.npy": (good.replace(b"'<f8'", b"'|O' ", 1), "of a type that is not"),
        "text.npy": (b"a,b\n1,2\n", "neither NPY, NPZ nor PFM"),
        "empty.npy": (b"", "neither NPY, NPZ nor PFM"),
        "version.npy": (good[:6] + b"\x09" + good[7:], "unknown version of NPY"),
        "cut.npz": ((tmp_path / "good.npz").read_bytes()[:-30], "no end record: it is truncated"),
    }
    for name, (content, says) in cases.items():
        (tmp_path / name).write_bytes(content)
        refuse(folder, tmp_path / name, "-g", "geometry.csv", says=[name + ": ", says])
    (tmp_path / "bits.npz").write_bytes(packed)
    refuse(folder, tmp_path / "bits.npz", "-g", "geometry.csv", says=["bits.npz: ", "damaged"], expect=1)
    (tmp_path / "list.csv").write_text("file,theta_i,theta_o\na.pfm,10,20\n ,20,30\n")
    refuse(tmp_path, "list.csv", says="list.csv: line 3: no file is named")
    (tmp_path / "list.csv").write_text("file,theta_i,theta_o\na.pfm,10,20\n")
    refuse(tmp_path, "list.csv", says="a.pfm: there is no such file", expect=1)
    (tmp_path / "geometry.csv").write_text("theta_i,theta_o\n10,20\n20,north\n")
    refuse(folder, "stack.npy", "-g", tmp_path / "geometry.csv", says=["geometry.csv: line 3, field 2"])
