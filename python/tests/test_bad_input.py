"""What is wrong ends in an exception that names it, and never in a crash."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import supple
from test_model import block


def refused(call, *words, kind=supple.InputError):
    with pytest.raises(kind) as told:
        call()
    assert all(word in str(told.value) for word in words), str(told.value)
    return told.value


def test_errors_have_file_line_and_column(tmp_path):
    (tmp_path / "scene.toml").write_text('[[body]]\nbox = { extent = [1, 1, 0] }\nmaterial = "rubbr"\n')
    error = refused(lambda: supple.World(tmp_path / "scene.toml"), "scene.toml:2:", "did you mean 'rubber'")
    assert [(problem.line, problem.file) for problem in error.problems] == [
        (2, str(tmp_path / "scene.toml")), (3, str(tmp_path / "scene.toml"))]
    assert isinstance(error, ValueError)


@pytest.mark.parametrize("source, kind", [
    ("no-such-scene", supple.InputError), (3, TypeError), (None, TypeError), ({}, supple.InputError),
    ({"body": 7}, supple.InputError), ({"body": [{"box": {"extent": [1, 1, 1]}, "weight": object()}]}, supple.InputError),
    ({"body": [float("nan")]}, supple.InputError), ("\0", (supple.InputError, ValueError)), ("", supple.InputError),
    ({"a": [[[[[[[[[[[[[[[[[[[[[[1]]]]]]]]]]]]]]]]]]]]]]}, supple.InputError)])
def test_scenes_that_are_none(source, kind):
    with pytest.raises(kind):
        supple.World(source)


def test_values_that_cannot_be(cube):
    world = supple.World(cube)
    refused(lambda: world.set("body.cub.material.young", 1), "did you mean 'cube'")
    refused(lambda: world.set("body.cube.material.young", -1), "must be above 0")
    refused(lambda: world.set("body.cube.material.young", float("nan")), "young")
    refused(lambda: world.set("body.cube.material.young", "a\nb\"c"), "young")
    refused(lambda: world.set("body.cube.material.young", 1, start=2), "ramps")
    refused(lambda: world.set("body.cube.material.young", 1, over=-1), "over")
    refused(lambda: world.set("body.cube.material.young", 1e4, over=1, ease="slow"), "ease", "smooth")
    refused(lambda: world.set("body.cube.material.young", object()), "object")
    refused(lambda: world.set("", 1))
    refused(lambda: world.set("fps", 60), "cannot change")
    refused(lambda: world.set("body.cube.solver.method", "newtonn"), "did you mean")
    refused(lambda: world.step(-1))
    refused(lambda: world.bodies["cube"].field("colour"), "stretch")
    refused(lambda: supple.render(world, size=(15, 15)), "width")
    refused(lambda: supple.render(world, camera={"distance": -1}), "distance")
    refused(lambda: supple.render(world, set={"look.light": "moon"}), "studio")
    hashes = []
    for other in (world, supple.World(cube)):  # nothing of this has changed anything
        other.step(5)
        hashes.append(other.hash())
    assert hashes[0] == hashes[1]


def test_grabs_that_cannot_be(cube):
    world = supple.World(cube)
    refused(lambda: world.grab("cub", [0], stiffness=10), "did you mean 'cube'")
    refused(lambda: world.grab("cube", [64], stiffness=10), "no vertex 64", "63")
    refused(lambda: world.grab("cube", [-1], stiffness=10), "-1")
    refused(lambda: world.grab("cube", [], stiffness=10), "no vertices")
    refused(lambda: world.grab("cube", [0], stiffness=0), "stiffness")
    refused(lambda: world.grab("cube", [0], stiffness=float("inf")), "stiffness")
    refused(lambda: world.grab("cube", [0], stiffness=1, name="a.b"), "letters")
    hand = world.grab("cube", [0, 1], stiffness=10, name="hand")
    refused(lambda: world.grab("cube", [2], stiffness=10, name="hand"), "two handles")
    refused(lambda: world.grab("cube", [0, 1], stiffness=10), "no other handle holds")
    refused(hand.release, "after")
    refused(lambda: hand.move([0, 0]), "three numbers")
    refused(lambda: hand.move([0, float("nan"), 0]), "finite")
    world.step()
    hand.release()
    refused(hand.release, "let go")
    world.step(3)


def test_states_of_other_worlds(cube):
    world, other = supple.World(cube), supple.World("rolling")
    refused(lambda: world.restore(other.state()), "other bodies")
    with pytest.raises(TypeError):
        world.restore(None)


@pytest.mark.parametrize("change, words", [
    (dict(vertices=np.zeros((3, 2))), ["n x 3"]), (dict(vertices="text"), ["vertices"]),
    (dict(vertices=np.full((45, 3), np.nan)), ["row 0 is not finite"]),
    (dict(tetrahedra=np.array([[0, 1, 2, 99]])), ["vertex 99 does not exist", "element 0"]),
    (dict(tetrahedra=np.array([[0, 1, 2, -3]])), ["element 0"]), (dict(tetrahedra=[[0, 1, 2]]), ["m x 4"]),
    (dict(tetrahedra=np.zeros((0, 4), int)), ["no elements"]), (dict(tetrahedra=[[0.5, 1, 2, 3]]), ["whole numbers"]),
    (dict(material="rubbr"), ["did you mean 'rubber'"]), (dict(material={"model": "neo-hookean", "young": -1}), ["young"]),
    (dict(density=0), ["density"]), (dict(time_step=0), ["time_step"]), (dict(pinned=[99]), ["no vertex 99"]),
    (dict(pinned=[1, 1]), ["twice"]), (dict(pinned=range(45)), ["every vertex"]), (dict(pin_stiffness=-1, pinned=[0]), ["pin"]),
    (dict(solver={"iterations": 0}), ["iterations"]), (dict(solver={"iteration": 5}), ["did you mean"])])
def test_models_that_cannot_be(change, words):
    vertices, tetrahedra = block()
    arguments = {"vertices": vertices, "tetrahedra": tetrahedra, "material": "rubber", **change}
    refused(lambda: supple.Model(**arguments), *words)


def test_steps_that_cannot_be():
    vertices, tetrahedra = block()
    model = supple.Model(vertices, tetrahedra, "rubber", pinned=[0, 1, 2])
    state = model.state()
    refused(lambda: supple.step(model, state, targets=np.zeros((2, 3))), "2 x 3", "3 x 3")
    refused(lambda: supple.step(model, state, gravity=[0, np.inf, 0]), "gravity")
    refused(lambda: supple.Colliders([{"shape": {"sphere": {"radius": -1}}}]), "radius")
    refused(lambda: supple.Colliders([{}]), "shape")
    refused(lambda: supple.step(supple.Model(vertices, tetrahedra, "rubber"), state), "another model")
    with pytest.raises(TypeError):
        supple.step(model, None)
    state.positions[5, 1] = np.nan
    refused(lambda: supple.step(model, state), "row 5")
    state.positions[5, 1] = 1e200
    with pytest.raises((supple.StepFailed, supple.InputError)):
        supple.step(model, state)


def test_a_failed_step_is_told_and_undone(cube):
    del cube["collider"]
    body = cube["body"][0]
    body["material"] = {"model": "polynomial", "mu": 1e9}
    body["solver"] = {"line_search": "none", "levels": 1}  # no search keeps it from growing without bounds
    body["handles"] = [{"name": "hook", "select": {"box": [[0, 0, 0], [0.1, 1, 1]]}}]
    world = supple.World(cube)
    world.step(2)
    before, hash_before = world.state(), world.hash()
    world.set("gravity", [0, -1e6, 0])
    with pytest.raises(supple.StepFailed, match="cube.*beyond all bounds"):
        world.step(30)
    with pytest.raises(RuntimeError, match="restore"):
        world.step()
    with pytest.raises(RuntimeError, match="restore"):
        world.state()
    world.restore(before)
    assert world.frame == 2 and world.hash() == hash_before
    world.step()


def test_a_world_in_two_threads_is_refused():
    world = supple.World("bunny-torus", threads=1)
    told = []
    thread = threading.Thread(target=lambda: world.step(20))
    thread.start()
    while thread.is_alive():
        try:
            world.hash()
        except RuntimeError as error:
            told.append(str(error))
        time.sleep(0.001)
    thread.join()
    assert any("another thread" in text for text in told)
    assert world.frame == 20


def test_pictures_from_any_thread(cube):
    world = supple.World(cube)
    pictures = []
    for _ in range(3):
        thread = threading.Thread(target=lambda: pictures.append(supple.render(world, size=(64, 48))))
        thread.start()
        thread.join()
    assert np.array_equal(pictures[0], pictures[2])


def test_a_fork_of_the_process_is_told(cube):
    world = supple.World(cube, threads=2)
    world.step()
    child = os.fork()
    if child == 0:
        try:
            world.step()
            os._exit(1)
        except RuntimeError as error:
            fresh = supple.World(cube, threads=2)  # this one is the child's own
            fresh.step(2)
            del world
            os._exit(0 if "another process" in str(error) and fresh.frame == 2 else 2)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    world.step()


INTERRUPTED = """
import os, signal, threading, supple
scene = {"fps": 30, "substeps": SUBSTEPS, "body": [{"name": "cube", "box": {"extent": [1, 1, 1], "cells": [10, 10, 10]},
         "material": "rubber"}]}
whole = supple.World(scene, threads=1)
whole.step(3)
world = supple.World(scene, threads=1)
threading.Timer(DELAY, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
try:
    world.step(1000)
except KeyboardInterrupt:
    frames = world.frame
    world.step()   # finishes the frame, or makes the next one
    while world.frame < 3:
        world.step()
    while whole.frame < world.frame:
        whole.step()
    assert world.hash() == whole.hash(), (world.frame, frames)
    print("interrupted in", frames)
"""


@pytest.mark.parametrize("substeps, delay", [(1, 0.3), (400, 1.0)])
def test_an_interrupt_ends_a_step_cleanly(substeps, delay):
    text = INTERRUPTED.replace("SUBSTEPS", str(substeps)).replace("DELAY", str(delay))
    told = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True)
    assert told.returncode == 0 and "interrupted in" in told.stdout, told.stderr


def test_films_that_cannot_be(tmp_path):
    refused(lambda: supple.Film(tmp_path / "film.txt"), ".mp4")
    refused(lambda: supple.Film(tmp_path / "film.mp4", fps=0), "fps")
    film = supple.Film(tmp_path / "film.mp4")
    refused(lambda: film.add(np.zeros((4, 4), np.uint8)), "height x width x 3")
    refused(lambda: film.add(np.zeros((3, 3, 3), np.uint8)), "even")
    film.close()
    with pytest.raises(RuntimeError, match="closed"):
        film.add(np.zeros((64, 64, 3), np.uint8))


def test_warnings_are_issued():
    scene = {"body": [{"box": {"extent": [0.2, 0.2, 0.2]}, "material": {"model": "neo-hookean", "young": 10, "poisson": 0.4},
                       "handles": [{"name": "top", "select": {"box": [[0, 0.99, 0], [1, 1, 1]]}}]}]}
    with pytest.warns(supple.SuppleWarning):
        world = supple.World(scene)
    assert world.warnings


@pytest.mark.parametrize("call", [
    lambda world: supple.render(world, size="ab"), lambda world: supple.World("bunny", threads="two"),
    lambda world: supple.Model(*block(), "rubber", density="x"), lambda world: supple.Model(*block(), "rubber", pinned=[1.5]),
    lambda world: world.set("\ud800", 1), lambda world: world.grab("cube", ["a"], stiffness=1)])
def test_types_that_cannot_be(cube, call):
    with pytest.raises((TypeError, ValueError)):
        call(supple.World(cube))


def test_numbers_of_threads():
    refused(lambda: supple.World("bunny", threads=2000), "256")
    refused(lambda: supple.World("bunny", threads=-1), "256")
    refused(lambda: supple.Model(*block(), "rubber").state(threads=0), "256")


def test_states_of_the_same_mesh_with_other_handles(cube):
    def held(upper):
        cube["body"][0]["handles"] = [{"name": "h", "select": {"box": [[0, 0, 0], upper]}, "stiffness": 10}]
        return supple.World(cube)

    few, many = held([0.1, 1, 1]), held([0.5, 1, 1])
    refused(lambda: many.restore(few.state()), "other bodies or handles")
    few.step()
    many.step()


def test_a_state_with_edits_of_another_scene_changes_nothing(cube):
    world = supple.World(cube)
    cube["collider"][0]["name"] = "floor"
    other = supple.World(cube)
    other.step(3)
    other.set("collider.floor.friction", 0.1)
    other.step()
    world.step()
    before = world.hash()
    refused(lambda: world.restore(other.state()), "floor")
    assert world.frame == 1 and world.hash() == before
    world.set("gravity", [0, -5, 0])
    world.step()


def test_an_interrupted_frame_can_be_measured(cube):
    cube["substeps"] = 50
    cube["body"][0]["box"]["cells"] = [12, 12, 12]
    world = supple.World(cube, threads=1)
    threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        world.step(1000)
    world.step(errors=True)
    assert world.error()["cube"]["motion_error"] < 1


def test_a_matrix_that_cannot_be_factored_leaves_no_trace(cube):
    plain = supple.World(cube)
    plain.step(3)
    world = supple.World(cube)
    with pytest.raises(supple.RunError):
        world.set("solver.damping", 1e30)  # before the first frame it takes effect at once
    world.step(3)
    assert world.hash() == plain.hash()
    before = world.state()
    world.set("solver.damping", 1e30)
    with pytest.raises(supple.RunError):
        world.step()
    assert world.frame == 3
    with pytest.raises(RuntimeError, match="restore"):
        world.step()
    with pytest.raises(RuntimeError, match="restore"):
        world.state()
    world.restore(before)
    world.step()


def test_a_replay_does_not_write_over_its_scene(tmp_path, cube):
    scene = tmp_path / "own.toml"
    scene.write_text('[[body]]\nname = "b"\nbox = { extent = [1, 1, 1], cells = [2, 2, 2] }\n'
                     'material = { model = "neo-hookean", young = 1e5, poisson = 0.3 }\n')
    text = scene.read_text()
    world = supple.World(scene)
    world.step()
    refused(lambda: world.save_replay(scene), "is the scene itself")
    copy = tmp_path / "x-scene.toml"
    copy.write_text(text)
    world = supple.World(copy, set={"body.b.material.young": 1e4, "body.b.material": {"model": "polynomial", "mu": 1e4}})
    world.step()
    refused(lambda: world.save_replay(tmp_path / "x.toml"), "is the scene itself")
    assert scene.read_text() == text and copy.read_text() == text


def test_a_grab_without_a_name_finds_a_free_one(cube):
    world = supple.World(cube)
    assert world.grab("cube", [0], stiffness=1, name="grab_1").name == "grab_1"
    assert world.grab("cube", [1], stiffness=1).name == "grab_2"


def test_a_long_ramp_is_refused(cube):
    refused(lambda: supple.World(cube).set("gravity", [0, 0, 0], over=1e9), "frames are the most")


def in_a_fork(work):
    """Returns the exit status of a child process that does the work and then ends as a program does."""
    child = os.fork()
    if child == 0:
        try:
            work()
        except BaseException:
            os._exit(1)
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def test_drawing_in_a_fork_of_a_process_that_has_drawn_is_told(cube):
    supple.render(supple.World(cube), size=(32, 32))

    def draw():
        refused(lambda: supple.render(supple.World(cube), size=(32, 32)), "spawn", kind=supple.RunError)

    assert in_a_fork(draw) == 0


def test_a_film_outlives_forks(cube, tmp_path):
    picture = np.zeros((48, 64, 3), np.uint8)
    film = supple.Film(tmp_path / "film.mp4")
    film.add(picture)
    sleeper = os.fork()
    if sleeper == 0:
        time.sleep(60)  # holds on to what it has inherited
        os._exit(0)

    def use():
        with pytest.raises(RuntimeError, match="another process"):
            film.add(picture)
        with pytest.raises(RuntimeError, match="another process"):
            film.close()

    assert in_a_fork(use) == 0
    film.add(picture)
    film.close()
    assert (tmp_path / "film.mp4").stat().st_size > 0
    os.kill(sleeper, signal.SIGKILL)
    os.waitpid(sleeper, 0)


def test_a_film_without_pictures_is_told(tmp_path):
    with pytest.warns(supple.SuppleWarning, match="no picture"):
        supple.Film(tmp_path / "film.mp4").close()


def test_vertices_are_whole_numbers_or_a_mask(cube):
    world = supple.World(cube)
    top = world.bodies["cube"].rest[:, 1] > 0.2 - 1e-9
    hand = world.grab("cube", top, stiffness=100)
    world.step()
    hand.move([0.1, 0, 0])
    world.step(10)
    moved = world.bodies["cube"].positions - world.bodies["cube"].rest
    assert moved[top, 0].mean() > 0.05
    for wrong in ([1.5], "0", ["1"], top[:5], None, [[1]], iter([1])):
        refused(lambda: world.grab("cube", wrong, stiffness=1), "whole numbers")
    refused(lambda: world.grab("cube", [2**40], stiffness=1), "no vertex 1099511627776")
    vertices, tetrahedra = block()
    model = supple.Model(vertices, tetrahedra.astype(np.uint64), "rubber", pinned=vertices[:, 0] == 0)
    assert list(model.pinned) == list(np.flatnonzero(vertices[:, 0] == 0))
    refused(lambda: supple.Model(vertices * 1j, tetrahedra, "rubber"), "array of numbers")


def test_hands_of_other_times_move_nothing(cube):
    world = supple.World(cube)
    world.step()
    before = world.state()
    old = world.grab("cube", [0], stiffness=10)
    world.step()
    world.restore(before)
    refused(lambda: old.move([0, 1, 0]), "holds nothing")
    new = world.grab("cube", [5], stiffness=10)
    assert new.name != old.name
    refused(lambda: old.move([0, 1, 0]), "holds nothing")
    world.step()
    new.release()
    refused(lambda: new.move([0, 1, 0]), "let go")


def test_a_hand_moves_over_the_first_frame_as_over_others(cube):
    cube["substeps"], cube["gravity"], cube["collider"] = 10, [0, 0, 0], []
    world = supple.World(cube)
    everywhere = world.grab("cube", range(64), stiffness=1e5)
    everywhere.move([0.1, 0, 0])
    world.step()
    assert world.bodies["cube"].velocities[:, 0].mean() == pytest.approx(0.1 * 30, rel=0.1)


def test_a_state_of_other_values_goes_on_but_is_no_replay(cube, tmp_path):
    soft, stiff = supple.World(cube), supple.World(cube, set={"body.cube.material.young": 1e6})
    soft.step(3)
    own = stiff.state()
    stiff.restore(soft.state())
    stiff.step()
    with pytest.raises(RuntimeError, match="other values"):
        stiff.save_replay(tmp_path / "saved.toml")
    stiff.restore(own)
    stiff.step()
    stiff.save_replay(tmp_path / "saved.toml")


def test_replays_go_where_files_are(cube, tmp_path):
    world = supple.World(cube)
    world.step()
    os.mkfifo(tmp_path / "fifo.toml")
    refused(lambda: world.save_replay(tmp_path / "fifo.toml"), "no file")
    refused(lambda: world.save_replay(""), "empty")
    refused(lambda: world.save_replay("a\0b"), "zero")
    (tmp_path / "x-scene.toml").write_text("# somebody's own\n")
    refused(lambda: world.save_replay(tmp_path / "x.toml"), "exists")
    assert not (tmp_path / "x.toml").exists()
    (tmp_path / "target.toml").write_text("")
    (tmp_path / "link.toml").symlink_to(tmp_path / "target.toml")
    world.save_replay(tmp_path / "link.toml")
    assert (tmp_path / "link.toml").is_symlink() and (tmp_path / "target.toml").read_text()
    world.step()
    world.save_replay(tmp_path / "link.toml")  # again, of the same scene


@pytest.mark.parametrize("kind", [supple.World, supple.Body, supple.WorldState, supple.Model, supple.State,
                                  supple.Colliders, supple.Film])
def test_objects_that_were_never_made(kind):
    empty = kind.__new__(kind)
    for name in dir(kind):
        if name.startswith("__"):
            continue
        try:
            value = getattr(empty, name)
            if callable(value):
                value()
        except (TypeError, RuntimeError, ValueError):
            pass
