"""A sphere of the material under two lamps and a grey sky, and a picture of it. SPDX-License-Identifier: MIT"""
from __future__ import annotations

_MITSUBA = """<scene version="3.0.0">
<integrator type="path"/>
<sensor type="perspective"><float name="fov" value="24"/>
  <transform name="to_world"><lookat origin="0, -6, 1.5" target="0, 0, 0" up="0, 0, 1"/></transform>
  <film type="hdrfilm"><integer name="width" value="320"/><integer name="height" value="320"/></film>
  <sampler type="independent"><integer name="sample_count" value="128"/></sampler></sensor>
<emitter type="constant"><rgb name="radiance" value="0.25"/></emitter>
<shape type="sphere"><point name="center" x="-5" y="-5" z="6"/><float name="radius" value="0.8"/>
  <emitter type="area"><rgb name="radiance" value="40"/></emitter></shape>
<shape type="sphere"><point name="center" x="6" y="2" z="3"/><float name="radius" value="0.5"/>
  <emitter type="area"><rgb name="radiance" value="30"/></emitter></shape>
%s
<shape type="sphere"><ref id="%s"/></shape>
</scene>
"""

_BLENDER = '''

def render(path, width=320, samples=128):
    """A sphere of the material under two lamps and a grey sky."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", samples
    scene.render.resolution_x = scene.render.resolution_y = width
    scene.render.filepath = path
    bpy.ops.mesh.primitive_uv_sphere_add(segments=128, ring_count=64, radius=1)
    ball = bpy.context.object
    bpy.ops.object.shade_smooth()
    ball.data.materials.append(material())
    for place, energy in (((-5, -5, 6), 2500), ((6, 2, 3), 700)):
        bpy.ops.object.light_add(type="POINT", radius=0.8, location=place)
        bpy.context.object.data.energy = energy
    scene.world = bpy.data.worlds.new("sky")
    scene.world.color = (0.25, 0.25, 0.25)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0, -6, 1.5), (1.3258, 0, 0)
    camera.data.angle = 0.42
    scene.collection.objects.link(camera)
    scene.camera = camera
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    import os

    render(os.path.splitext(os.path.abspath(__file__))[0] + ".png")
'''


def mitsuba(material: str, name: str, whole: bool) -> str:
    """Of a whole scene, or what <include> takes."""
    if whole:
        return _MITSUBA % (material, name)
    return '<scene version="3.0.0">\n%s\n</scene>\n' % material


def blender(material: str, whole: bool) -> str:
    return material + (_BLENDER if whole else "")
