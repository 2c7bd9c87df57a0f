# Puts the motion of a run of supple onto meshes in Blender (3.4 or later).
#
#   blender -P load_run.py -- RUN_DIR                          to look at it
#   blender -b -P load_run.py -- RUN_DIR --save run.blend      without a window
#   blender -b -P load_run.py -- RUN_DIR --frame 20 --render picture.png
#
# RUN_DIR is what `supple render` left, or `supple draw --skins`: motion/BODY.obj is the surface at rest and motion/BODY.pc2 where its vertices
# go, in the same order. Each body becomes an object with a Mesh Cache modifier that reads the cache from where it lies,
# and with the colours and textures that its files name.
# supple's y is up, Blender's z: the objects are turned by 90 degrees about x, their vertices are not touched. Frame 0
# of the film is frame 0 of the scene. Colliders are not loaded; their poses are in motion/colliders.csv.
import argparse
import json
import math
import os
import struct
import sys
from fractions import Fraction

import bpy
from mathutils import Matrix, Vector

COLORS = "vertex colours"  # a layer that is called "color" is black in Cycles
TO_BLENDER = Matrix.Rotation(math.pi / 2, 4, "X")


def set_rate(given):
    """Takes frames a second: a number, or a fraction such as "30000/1001", for which 29.97 stands as well."""
    rate = float(Fraction(str(given)))
    whole = max(1, round(rate))
    of_television = abs(1.001 * rate - whole) < 5e-3 < abs(rate - whole)
    bpy.context.scene.render.fps = whole
    bpy.context.scene.render.fps_base = 1.001 if of_television else whole / rate


def read_arguments():
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="load_run.py", description="Loads the motion of a run of supple.")
    parser.add_argument("run", help="folder that supple render or supple draw --skins left")
    parser.add_argument("--frame", type=int, default=0, help="frame to show")
    parser.add_argument("--render", metavar="FILE", help="render that frame with Cycles: a PNG without background")
    parser.add_argument("--save", metavar="FILE", help="save a .blend file")
    return parser.parse_args(words)


class Surface:
    """What an OBJ file of supple says: by vertex its place, its colour (or nothing) and its place in the texture, by
    face its vertices and the name of its material; and the origin that both files of a body far from the world's origin
    are relative to."""

    def __init__(self, path):
        self.points, self.colors, self.places, self.faces, self.materials = [], [], [], [], []
        self.origin, self.material_file, material = Vector(), None, None
        with open(path) as file:
            for line in file:
                word, *rest = line.split()
                if word == "#" and rest[0] == "origin":
                    self.origin = Vector([float(number.rstrip(":")) for number in rest[1:4]])
                elif word == "mtllib":
                    self.material_file = os.path.join(os.path.dirname(path), " ".join(rest))
                elif word == "usemtl":
                    material = rest[0]
                elif word == "v":
                    numbers = [float(number) for number in rest]
                    self.points.append(tuple(numbers[:3]))
                    if len(numbers) == 6:
                        self.colors.append(numbers[3:])
                elif word == "vt":
                    self.places.append([float(number) for number in rest[:2]])
                elif word == "f":
                    self.faces.append([int(corner.split("/")[0]) - 1 for corner in rest])
                    self.materials.append(material)


def read_materials(path):
    """The texture's file, or None, of each material."""
    textures, name = {}, None
    with open(path) as file:
        for line in file:
            word, *rest = line.split() or [""]
            if word == "newmtl":
                name = rest[0]
                textures[name] = None
            elif word == "map_Kd":
                textures[name] = os.path.join(os.path.dirname(path), " ".join(rest))
    return textures


def new_material(name, texture, has_colors):
    """The colours of the vertices, multiplied with the texture, where there are any."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    base = nodes["Principled BSDF"].inputs["Base Color"]
    sources = []
    if has_colors:
        colors = nodes.new("ShaderNodeVertexColor")
        colors.layer_name = COLORS
        sources.append(colors.outputs["Color"])
    if texture:
        image = nodes.new("ShaderNodeTexImage")
        image.image = bpy.data.images.load(os.path.abspath(texture))
        sources.append(image.outputs["Color"])
    if len(sources) == 2:
        product = nodes.new("ShaderNodeMixRGB")
        product.blend_type = "MULTIPLY"
        product.inputs["Fac"].default_value = 1
        for source, factor in zip(sources, ("Color1", "Color2")):
            links.new(source, product.inputs[factor])
        sources = [product.outputs["Color"]]
    if sources:
        links.new(sources[0], base)
    return material


def linear(level):
    """A colour's level in sRGB as light."""
    return level / 12.92 if level <= 0.04045 else ((level + 0.055) / 1.055) ** 2.4


def add_colors(mesh, surface):
    """Gives the mesh what the surface says of colours. Corners of faces have the texture's places of their vertices."""
    has_colors = len(surface.colors) == len(surface.points) > 0
    if has_colors:
        layer = mesh.color_attributes.new(COLORS, "FLOAT_COLOR", "POINT")
        layer.data.foreach_set("color", [v for c in surface.colors for v in (*map(linear, c), 1.0)])
    if len(surface.places) == len(surface.points):
        layer = mesh.uv_layers.new(name="texture")
        corners = [None] * len(mesh.loops)
        mesh.loops.foreach_get("vertex_index", corners)
        layer.data.foreach_set("uv", [v for vertex in corners for v in surface.places[vertex]])
    textures = read_materials(surface.material_file) if surface.material_file else {}
    if not textures and not has_colors:
        return
    names = list(textures) or ["colors"]
    for name in names:
        mesh.materials.append(new_material(name, textures.get(name), has_colors))
    of_face = [names.index(name) if name in textures else 0 for name in surface.materials]
    mesh.polygons.foreach_set("material_index", of_face)


def cache_size(path):
    """Points and frames of a PC2 file."""
    with open(path, "rb") as file:
        signature, _, points, _, _, frames = struct.unpack("<12siiffi", file.read(32))
    if signature != b"POINTCACHE2\0":
        sys.exit(f"{path}: not a PC2 point cache")
    return points, frames


def load_body(name, surface, cache):
    """Returns the points at rest, in supple's axes, and the number of frames."""
    rest = Surface(surface)
    cached, frames = cache_size(cache)
    if cached != len(rest.points):
        sys.exit(f"{cache}: {cached} points, and {surface} has {len(rest.points)}")
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(rest.points, [], rest.faces)
    add_colors(mesh, rest)
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    body = bpy.data.objects.new(name, mesh)
    body.matrix_world = TO_BLENDER @ Matrix.Translation(rest.origin)
    bpy.context.scene.collection.objects.link(body)
    motion = body.modifiers.new("motion", "MESH_CACHE")
    motion.cache_format = "PC2"
    motion.filepath = os.path.abspath(cache)
    motion.frame_start = 0
    return [tuple(Vector(point) + rest.origin) for point in rest.points], frames


NAMED_SIZES = {"portrait": (1080, 1920), "square": (1080, 1080), "720p": (1280, 720), "1080p": (1920, 1080),
               "4k": (3840, 2160)}


def picture_size(output):
    """Width and height of the film's pictures; output.size counts before width and height."""
    size = output.get("size")
    if size in NAMED_SIZES:
        return NAMED_SIZES[size]
    if size:
        return tuple(int(side) for side in size.split("x"))
    return output.get("width", 1280), output.get("height", 720)


def film_camera(scene, points):
    """The camera that the scene names; what it leaves open frames the bodies from the front."""
    asked = scene.get("camera", {})
    fov = math.radians(asked.get("fov_deg", 30))
    lower = Vector([min(p[i] for p in points) for i in range(3)])
    upper = Vector([max(p[i] for p in points) for i in range(3)])
    target = Vector(asked.get("target", (lower + upper) / 2))
    away = (upper - lower).length / math.tan(fov / 2)
    eye = Vector(asked.get("position", target + away * Vector((0, 0.16, 1)).normalized()))
    return (eye, target, fov) + picture_size(scene.get("output", {}))


def add_camera(scene, points):
    eye, target, fov, width, height = film_camera(scene, points)
    camera = bpy.data.objects.new("film", bpy.data.cameras.new("film"))
    camera.data.sensor_fit = "VERTICAL"
    camera.data.angle = fov
    camera.data.clip_start = 0.001 * (eye - target).length
    camera.data.clip_end = 1000 * (eye - target).length
    eye, target = TO_BLENDER @ eye, TO_BLENDER @ target
    camera.location = eye
    camera.rotation_euler = (target - eye).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100


def render_picture(file):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 16
    scene.cycles.use_denoising = False
    scene.render.film_transparent = True
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.filepath = os.path.abspath(file)
    bpy.ops.render.render(write_still=True)


def main():
    arguments = read_arguments()
    records = (os.path.join(arguments.run, name) for name in ("run.json", "skins.json"))
    with open(next(filter(os.path.exists, records), "run.json")) as file:
        record = json.load(file)
    scene = record["scene"]
    motion = os.path.join(arguments.run, "motion")
    names = sorted(name[:-4] for name in os.listdir(motion) if name.endswith(".pc2"))
    for body in list(bpy.data.objects):
        bpy.data.objects.remove(body)
    points, frames = [], 1
    for name in names:
        surface, cache = (os.path.join(motion, name + ending) for ending in (".obj", ".pc2"))
        own_points, own_frames = load_body(name, surface, cache)
        points += own_points
        frames = max(frames, own_frames)
    add_camera(scene, points)
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 3
    sun.rotation_euler = (math.radians(50), 0, math.radians(30))
    bpy.context.scene.collection.objects.link(sun)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 0, frames - 1
    set_rate(record.get("rate", scene.get("fps", 30)))
    bpy.context.scene.frame_set(arguments.frame)
    if arguments.save:
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(arguments.save))
    if arguments.render:
        render_picture(arguments.render)


main()
