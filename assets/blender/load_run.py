# Puts the motion of a run of supple onto meshes in Blender (3.4 or later).
#
#   blender -P load_run.py -- RUN_DIR                          to look at it
#   blender -b -P load_run.py -- RUN_DIR --save run.blend      without a window
#   blender -b -P load_run.py -- RUN_DIR --frame 20 --render picture.png
#
# RUN_DIR is what `supple render` left, or `supple draw --skins`: motion/BODY.obj is the surface at rest and motion/BODY.pc2 where its vertices
# go, in the same order. Each body becomes an object with a Mesh Cache modifier that reads the cache from where it lies.
# supple's y is up, Blender's z: the objects are turned by 90 degrees about x, their vertices are not touched. Frame 0
# of the film is frame 0 of the scene. Colliders are not loaded; their poses are in motion/colliders.csv.
import argparse
import json
import math
import os
import struct
import sys

import bpy
from mathutils import Matrix, Vector

TO_BLENDER = Matrix.Rotation(math.pi / 2, 4, "X")


def read_arguments():
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="load_run.py", description="Loads the motion of a run of supple.")
    parser.add_argument("run", help="folder that supple render or supple draw --skins left")
    parser.add_argument("--frame", type=int, default=0, help="frame to show")
    parser.add_argument("--render", metavar="FILE", help="render that frame with Cycles: a PNG without background")
    parser.add_argument("--save", metavar="FILE", help="save a .blend file")
    return parser.parse_args(words)


def read_surface(path):
    """Points and faces, and the origin that both files of a body far from the world's origin are relative to."""
    points, faces, origin = [], [], (0.0, 0.0, 0.0)
    with open(path) as file:
        for line in file:
            word, *numbers = line.split()
            if word == "#" and numbers[0] == "origin":
                origin = tuple(float(number.rstrip(":")) for number in numbers[1:4])
            elif word == "v":
                points.append(tuple(map(float, numbers[:3])))  # a colour may follow
            elif word == "f":
                faces.append(tuple(int(number.split("/")[0]) - 1 for number in numbers))
    return points, faces, Vector(origin)


def cache_size(path):
    """Points and frames of a PC2 file."""
    with open(path, "rb") as file:
        signature, _, points, _, _, frames = struct.unpack("<12siiffi", file.read(32))
    if signature != b"POINTCACHE2\0":
        sys.exit(f"{path}: not a PC2 point cache")
    return points, frames


def load_body(name, surface, cache):
    """Returns the points at rest, in supple's axes, and the number of frames."""
    points, faces, origin = read_surface(surface)
    cached, frames = cache_size(cache)
    if cached != len(points):
        sys.exit(f"{cache}: {cached} points, and {surface} has {len(points)}")
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    body = bpy.data.objects.new(name, mesh)
    body.matrix_world = TO_BLENDER @ Matrix.Translation(origin)
    bpy.context.scene.collection.objects.link(body)
    motion = body.modifiers.new("motion", "MESH_CACHE")
    motion.cache_format = "PC2"
    motion.filepath = os.path.abspath(cache)
    motion.frame_start = 0
    return [tuple(Vector(point) + origin) for point in points], frames


def film_camera(scene, points):
    """The camera that the scene names; what it leaves open frames the bodies from the front."""
    asked = scene.get("camera", {})
    fov = math.radians(asked.get("fov_deg", 30))
    lower = Vector([min(p[i] for p in points) for i in range(3)])
    upper = Vector([max(p[i] for p in points) for i in range(3)])
    target = Vector(asked.get("target", (lower + upper) / 2))
    away = (upper - lower).length / math.tan(fov / 2)
    eye = Vector(asked.get("position", target + away * Vector((0, 0.16, 1)).normalized()))
    output = scene.get("output", {})
    return eye, target, fov, output.get("width", 1280), output.get("height", 720)


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
        scene = json.load(file)["scene"]
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
    fps = scene.get("fps", 30)
    bpy.context.scene.render.fps = max(1, round(fps))
    bpy.context.scene.render.fps_base = bpy.context.scene.render.fps / fps
    bpy.context.scene.frame_set(arguments.frame)
    if arguments.save:
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(arguments.save))
    if arguments.render:
        render_picture(arguments.render)


main()
