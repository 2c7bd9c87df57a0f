"""Measures what Python costs: a frame over the same frame in C++, views, worlds made and dropped, worlds in threads.

PYTHONPATH=build/release/python python3 python/studies/cost.py build/release/tests/supple_world_study [WORLDS]

The program is a target of the tests that is built on request. What it said: docs/lab/2026-11-27-python.md.
"""

import resource
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import warnings

import supple

warnings.simplefilter("ignore", supple.SuppleWarning)
CUBE = {
    "body": [{"name": "cube", "box": {"extent": [0.2, 0.2, 0.2], "cells": [3, 3, 3]}, "position": [0, 0.1, 0],
              "material": {"model": "neo-hookean", "young": 5e4, "poisson": 0.4}}],
    "collider": [{"name": "ground", "shape": {"half_space": {"normal": [0, 1, 0]}}}],
}
CUBE_FILE = """
[[body]]
name = "cube"
box = { extent = [0.2, 0.2, 0.2], cells = [3, 3, 3] }
position = [0, 0.1, 0]
material = { model = "neo-hookean", young = 5e4, poisson = 0.4 }
[[collider]]
name = "ground"
shape = { half_space = { normal = [0, 1, 0] } }
"""


def resident_mb():
    with open("/proc/self/statm") as pages:
        return int(pages.read().split()[1]) * resource.getpagesize() / 1e6


def frames_in_cpp(program, scene, frames):
    told = subprocess.run([program, scene, str(frames)], check=True, capture_output=True, text=True).stdout
    return [float(line) for line in told.split()]


def frames_here(scene, frames):
    world = supple.World(scene, threads=1)
    views = [(body.positions, body.velocities) for body in world.bodies.values()]
    times = []
    for _ in range(frames):
        begin = time.perf_counter()
        world.step()
        times.append(1000 * (time.perf_counter() - begin))
    assert all(len(x) == len(v) for x, v in views)
    return times


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        small = folder + "/cube.toml"
        with open(small, "w") as file:
            file.write(CUBE_FILE)
        for name, scene, frames in (("cube", small, 300), ("twisting-bar", "twisting-bar", 60), ("bunny", "bunny", 40),
                                    ("squirrel", "squirrel", 20)):
            runs = [(frames_in_cpp(program, scene, frames), frames_here(scene, frames)) for _ in range(7)]
            cpp, here = (statistics.mean(min(times) for times in zip(*(run[k] for run in runs))) for k in (0, 1))
            print(f"{name}: {cpp:.3f} ms a frame in C++, {here - cpp:+.3f} ms in Python, all bodies with views")
    world = supple.World("bunny", threads=1)
    body = world.bodies["bunny"]
    begin = time.perf_counter()
    for _ in range(100000):
        body.positions
    print(f"a view: {1e3 * (time.perf_counter() - begin):.1f} us for a hundred")
    worlds = int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    for count in range(1, worlds + 1):
        world = supple.World(CUBE, threads=1)
        body = world.bodies["cube"]
        body.positions
        world.step()
        state = world.state()
        world.restore(state)
        if count in (worlds // 100, worlds // 10, worlds // 2, worlds):
            print(f"{count} worlds made and dropped: {resident_mb():.1f} MB")
    worlds = [supple.World("bunny", threads=1) for _ in range(4)]
    for at_once in (1, 2, 4):
        begin = time.perf_counter()
        steppers = [threading.Thread(target=world.step, args=(40,)) for world in worlds[:at_once]]
        for stepper in steppers:
            stepper.start()
        for stepper in steppers:
            stepper.join()
        print(f"{at_once} worlds in {at_once} threads: {1000 * (time.perf_counter() - begin) / 40 / at_once:.2f} ms a frame")
        for world in worlds:
            world.restore(supple.World("bunny", threads=1).state())


main()
