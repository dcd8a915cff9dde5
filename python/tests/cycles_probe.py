"""What Cycles makes of a material at given directions, without noise: small tilted quads under one sun, seen from above.

A sun of angle 0 that makes an irradiance of 1 at normal incidence, an orthographic camera and no bounces: a pixel in the middle
of a quad is f_r (n.l). SPDX-License-Identifier: MIT
"""
import pathlib

import numpy as np

SIDE = 12  # quads a side


def normals(rng, sun):
    """SIDE^2 unit vectors that light and camera are both above."""
    out = []
    while len(out) < SIDE * SIDE:
        n = rng.standard_normal(3)
        n /= np.linalg.norm(n)
        if n[2] > 0.1 and n @ sun > 0.1:
            out.append(n)
    return np.array(out)


def local(n, d):
    """World directions (3) in frames around the normals, N x 3."""
    helper = np.where(np.abs(n[:, :1]) < 0.5, [[1.0, 0, 0]], [[0, 1.0, 0]])
    x = np.cross(helper, n)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return np.stack([x @ d, np.cross(n, x) @ d, n @ d], 1)


def render(bpy, material, n, sun, folder: pathlib.Path):
    """Radiance of each quad, N x 3. material: a function that makes it, called in an empty scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", 1
    scene.cycles.shading_system = True  # OSL; nodes mean the same
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.max_bounces, scene.cycles.pixel_filter_type, scene.cycles.filter_width = 0, "BOX", 0.01
    scene.render.resolution_x = scene.render.resolution_y = SIDE
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.view_settings.view_transform = "Raw"
    scene.render.filepath = str(folder / "probe.exr")
    corners, faces = [], []
    for i, one in enumerate(n):
        helper = np.array([1.0, 0, 0]) if abs(one[0]) < 0.5 else np.array([0, 1.0, 0])
        x = np.cross(helper, one)
        x /= np.linalg.norm(x)
        y = np.cross(one, x)
        centre = np.array([i % SIDE + 0.5, i // SIDE + 0.5, 0])
        corners += [centre + 0.3 * (a * x + b * y) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        faces.append(tuple(range(4 * i, 4 * i + 4)))
    mesh = bpy.data.meshes.new("quads")
    mesh.from_pydata([tuple(one) for one in corners], [], faces)
    quads = bpy.data.objects.new("quads", mesh)
    quads.visible_shadow = False
    mesh.materials.append(material())
    scene.collection.objects.link(quads)
    lamp = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    lamp.data.energy, lamp.data.angle = 1.0, 0.0
    import mathutils

    lamp.rotation_euler = mathutils.Vector((0, 0, 1)).rotation_difference(mathutils.Vector(sun)).to_euler()
    scene.collection.objects.link(lamp)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", SIDE
    camera.location = (SIDE / 2, SIDE / 2, 10)
    scene.collection.objects.link(camera)
    scene.camera = camera
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    return np.array(image.pixels[:]).reshape(SIDE * SIDE, 4)[:, :3]
