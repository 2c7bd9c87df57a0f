import json
import os
import subprocess

import pytest


@pytest.fixture(scope="session")
def program():
    return os.environ["SUPPLE_PROGRAM"]


@pytest.fixture
def hashes_of(program, tmp_path):
    """Returns a function that films a scene or replay without pictures, and returns the hash of each frame."""

    def run(verb, scene, *options):
        out = tmp_path / "film"
        subprocess.run([program, verb, str(scene), "--no-images", "--quiet", "--force", "--out", str(out), *options],
                       check=True, capture_output=True)
        return [int(frame["state_hash"], 16) for frame in json.loads((out / "profile.json").read_text())["frames"]]

    return run


@pytest.fixture
def cube():
    """The text of a small scene: a soft cube that falls on the ground."""
    return {
        "fps": 30,
        "frames": 20,
        "body": [{"name": "cube", "box": {"extent": [0.2, 0.2, 0.2], "cells": [3, 3, 3]}, "position": [0, 0.1, 0],
                  "material": {"model": "neo-hookean", "young": 5e4, "poisson": 0.4}}],
        "collider": [{"name": "ground", "friction": 0.5,
                      "shape": {"half_space": {"normal": [0, 1, 0]}}}],
    }
