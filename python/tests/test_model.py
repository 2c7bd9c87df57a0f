"""Bodies made of arrays."""

import numpy as np
import pytest

import supple


def block(cells=(4, 2, 2), extent=(0.4, 0.2, 0.2)):
    """Vertices and tetrahedra of a box that is cut into cells of six tetrahedra each."""
    count = np.array(cells) + 1
    grid = np.stack(np.meshgrid(*(np.linspace(0, e, n) for e, n in zip(extent, count)), indexing="ij"), -1)
    number = np.arange(np.prod(count)).reshape(count)
    corners = [number[i:count[0] - 1 + i, j:count[1] - 1 + j, k:count[2] - 1 + k].ravel()
               for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    paths = [(4, 6), (6, 2), (2, 3), (3, 1), (1, 5), (5, 4)]  # around the diagonal from corner 0 to corner 7
    tetrahedra = np.concatenate([np.stack([corners[0], corners[a], corners[b], corners[7]], 1) for a, b in paths])
    return grid.reshape(-1, 3), tetrahedra


def test_free_fall_and_ground():
    vertices, tetrahedra = block()
    model = supple.Model(vertices + [0, 0.3, 0], tetrahedra, {"model": "neo-hookean", "young": 1e5, "poisson": 0.4})
    state = model.state()
    ground = supple.Colliders([{"shape": {"half_space": {"normal": [0, 1, 0]}}, "friction": 0.4}])
    x = state.positions
    report = supple.step(model, state, colliders=ground)
    assert report["contacts"] == 0 and state.time == pytest.approx(1 / 30)
    assert state.velocities.mean(0) == pytest.approx([0, -9.81 / 30, 0])
    for _ in range(90):
        report = supple.step(model, state, colliders=ground)
    assert np.shares_memory(x, state.positions)  # the array that was asked for at the beginning
    assert abs(x[:, 1].min()) < 2e-3 and report["contacts"] > 0
    assert np.abs(state.velocities).max() < 0.05


def test_a_pinned_bar_follows_its_targets():
    vertices, tetrahedra = block()
    ends = np.flatnonzero(vertices[:, 0] == 0)
    model = supple.Model(vertices, tetrahedra, "rubber", pinned=ends)
    state = model.state(threads=2)
    targets = vertices[ends] + [0, 0.1, 0]
    for _ in range(40):
        supple.step(model, state, targets=targets, gravity=(0, 0, 0))
    assert state.positions[ends] == pytest.approx(targets)
    assert state.positions.mean(0) == pytest.approx(vertices.mean(0) + [0, 0.1, 0], abs=2e-3)
    soft = supple.Model(vertices, tetrahedra, "rubber", pinned=ends, pin_stiffness=1e3)
    state = soft.state()
    supple.step(soft, state, targets=targets)
    assert not np.allclose(state.positions[ends], targets)


def test_the_same_bits_as_a_scene():
    extent, cells = [0.4, 0.2, 0.2], [4, 2, 2]
    scene = {"body": [{"name": "bar", "box": {"extent": extent, "cells": cells}, "velocity": [0.5, 2, 0],
                       "material": {"model": "neo-hookean", "young": 2e5, "poisson": 0.3}}]}
    world = supple.World(scene)
    body = world.bodies["bar"]
    model = supple.Model(body.rest, body.tetrahedra, scene["body"][0]["material"])
    state = model.state()
    state.velocities[:] = [0.5, 2, 0]
    for _ in range(10):
        world.step()
        supple.step(model, state)
    assert np.array_equal(state.positions, body.positions)


def test_what_is_written_counts():
    vertices, tetrahedra = block()
    model = supple.Model(vertices, tetrahedra, "jelly")
    state = model.state()
    state.positions[:] = vertices @ np.diag([1.3, 1, 1])
    for _ in range(100):
        supple.step(model, state, gravity=(0, 0, 0))
    extents = [np.linalg.svd(x - x.mean(0), compute_uv=False) for x in (state.positions, vertices)]
    assert extents[0] == pytest.approx(extents[1], rel=1e-3)  # it has come back, and may have turned
