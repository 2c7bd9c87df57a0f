"""What Python steps is what the program films, to the last bit."""

import tomllib

import numpy as np
import pytest

import supple

SCENES = [("squirrel", 6), ("bunny-torus", 25), ("cloth-sphere", 12), ("stack", 12), ("rolling", 15)]


def hashes(world, frames):
    result = []
    for _ in range(frames):
        world.step()
        result.append(world.hash())
    return result


@pytest.mark.parametrize("scene, frames", SCENES)
def test_scenes_have_the_hashes_of_their_films(hashes_of, scene, frames):
    assert hashes(supple.World(scene), frames) == hashes_of("render", scene, "--frames", str(frames))


def test_a_replay_has_the_hashes_of_its_film(hashes_of):
    frames = 40  # fingers close on an ear in frame 30
    assert hashes(supple.World("ear-pull"), frames) == hashes_of("replay", "ear-pull", "--frames", str(frames))


def test_settings_have_the_meaning_of_the_command_line(hashes_of):
    world = supple.World("blob", set={"body.blob.material": {"model": "neo-hookean", "mu": 30, "lambda": 25},
                                      "solver.iterations": 7}, threads=1)
    film = hashes_of("render", "blob", "--frames", "5", "--set",
                     'body.blob.material={model = "neo-hookean", mu = 30, lambda = 25}', "--set",
                     "solver.iterations=7")
    assert hashes(world, 5) == film


def test_a_fork_and_its_origin_go_on_alike():
    world = supple.World("bunny-torus")
    world.step(12)
    middle = world.state()
    assert middle.frame == 12
    ahead = hashes(world, 10)
    world.restore(middle)
    assert world.frame == 12
    assert hashes(world, 10) == ahead
    fork = supple.World("bunny-torus", threads=1)
    fork.restore(middle)
    assert hashes(fork, 10) == ahead


def test_what_is_set_and_grabbed_is_a_replay(hashes_of, tmp_path):
    world = supple.World("bunny")
    ear = np.argsort(world.bodies["bunny"].positions[:, 1])[-20:]
    world.set("body.bunny.material.young", 3e4)  # before the first frame
    made = hashes(world, 3)
    hand = world.grab("bunny", ear, stiffness=40)
    made += hashes(world, 2)
    hand.move([0.1, 0.05, 0])
    world.set("body.bunny.material.young", 1e5, over=0.2, by="ratio")
    made += hashes(world, 4)
    hand.move([0.1, 0.1, 0.05], turn_deg=[0, 30, 0])
    world.set("gravity", [0, -3, 0])
    made += hashes(world, 3)
    hand.release()
    made += hashes(world, 3)
    again = world.grab("bunny", ear[:10], stiffness=60, name="again")  # vertices that were held before
    made += hashes(world, 2)
    again.move((0, 0.1, 0))
    made += hashes(world, 3)
    world.save_replay(tmp_path / "saved.toml")
    assert tomllib.loads((tmp_path / "saved.toml").read_text())["frames"] == 20
    assert hashes_of("replay", tmp_path / "saved.toml") == made
    assert hashes(supple.World(tmp_path / "saved.toml"), 20) == made


def test_a_state_brings_its_changes_and_grabs(hashes_of, tmp_path):
    world = supple.World("bunny", threads=1)
    world.step(2)
    plain = world.state()
    hand = world.grab("bunny", range(30), stiffness=50)
    world.set("body.bunny.density", 400)
    world.step(2)
    held = world.state()
    hand.move([0, 0.2, 0])
    ahead = hashes(world, 3)
    world.restore(plain)  # as if nothing had been grabbed
    assert hashes(world, 3) == hashes(supple.World("bunny", threads=1), 5)[2:]
    world.restore(held)
    hand.move([0, 0.2, 0])
    assert hashes(world, 3) == ahead
    world.save_replay(tmp_path / "saved.toml")
    assert hashes_of("replay", tmp_path / "saved.toml")[4:] == ahead


def test_a_replay_that_is_edited_keeps_its_own_changes(hashes_of, tmp_path):
    world = supple.World("ear-pull", set={"solver.iterations": 8})
    made = hashes(world, 33)
    world.set("gravity", [0, 0, 0], over=0.1)
    made += hashes(world, 14)  # the replay itself softens the bunny from frame 45 on
    world.save_replay(tmp_path / "saved.toml")
    assert hashes_of("replay", tmp_path / "saved.toml") == made


def test_a_scene_from_a_dict_is_saved_beside_its_replay(cube, hashes_of, tmp_path):
    world = supple.World(cube)
    made = hashes(world, 4)
    world.set("body.cube.material.young", 1e4)
    made += hashes(world, 4)
    world.save_replay(tmp_path / "saved.toml")
    assert (tmp_path / "saved-scene.toml").exists()
    assert hashes_of("replay", tmp_path / "saved.toml") == made


def test_threads_and_substeps_change_no_bit(cube):
    cube["substeps"] = 4
    worlds = [supple.World(cube, threads=count) for count in (1, 2, 4)]
    first, *others = [hashes(world, 8) for world in worlds]
    assert all(other == first for other in others)
