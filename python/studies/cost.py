"""Measures what Python costs: a step over the same step in C++, views, worlds made and dropped, worlds in threads.

PYTHONPATH=build/release/python python3 python/studies/cost.py [WORLDS]   (docs/lab/2026-11-27-python.md)
"""

import resource
import statistics
import sys
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


def resident_mb():
    with open("/proc/self/statm") as pages:
        return int(pages.read().split()[1]) * resource.getpagesize() / 1e6


def overhead(scene, frames):
    """Milliseconds of a call of step() beyond those that its steps report, least and median."""
    world = supple.World(scene, threads=1)
    views = [(body.positions, body.velocities) for body in world.bodies.values()]
    beyond = []
    for _ in range(frames):
        begin = time.perf_counter()
        world.step()
        beyond.append(1000 * (time.perf_counter() - begin) - world.report["step_ms"])
    return min(beyond), statistics.median(beyond), len(views)


def main():
    for name, scene, frames in (("cube, 64 vertices", CUBE, 300), ("twisting-bar", "twisting-bar", 100),
                                ("bunny", "bunny", 100), ("squirrel", "squirrel", 40)):
        least, median, bodies = overhead(scene, frames)
        print(f"step() beyond its steps, {name}, {bodies} bodies with views: {least:.3f} ms, median {median:.3f} ms")
    world = supple.World("bunny", threads=1)
    body = world.bodies["bunny"]
    begin = time.perf_counter()
    for _ in range(100000):
        body.positions
    print(f"a view: {1e3 * (time.perf_counter() - begin):.1f} us for a hundred")
    worlds = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
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
