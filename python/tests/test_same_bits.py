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


def test_a_world_goes_on_from_a_run_with_its_bits_and_its_clock(hashes_of, tmp_path):
    film = hashes_of("replay", "ear-pull", "--frames", "40")
    with pytest.warns(supple.SuppleWarning, match="goes on after frame 29"):
        world = supple.World("ear-pull", set={"from.run": str(tmp_path / "film"), "from.frame": 29})
    assert world.frame == 0 and world.time == 1
    assert hashes(world, 10) == film[30:]
    assert world.time == pytest.approx(4 / 3)


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


def test_a_table_a_part_of_it_and_the_table_again(cube, hashes_of, tmp_path):
    cube["body"][0]["material"] = "jelly"  # a preset, which has no part
    world = supple.World(cube)
    made = hashes(world, 4)
    for young in (2e4, 4e4):
        world.set("body.cube.material", {"model": "neo-hookean", "young": young, "poisson": 0.3})
        made += hashes(world, 2)
        world.set("body.cube.material.young", 2 * young)
        made += hashes(world, 2)
    world.save_replay(tmp_path / "saved.toml")
    assert hashes_of("replay", tmp_path / "saved.toml") == made


def test_a_ramp_from_the_first_frame_on(cube, hashes_of, tmp_path):
    world = supple.World(cube)
    world.set("collider.ground.position", [0, 0.1, 0], over=0.2, start=[0, -0.2, 0])
    world.set("body.cube.material.young", 1e4, over=0.3, by="ratio", start=1e5)
    made = hashes(world, 12)
    world.save_replay(tmp_path / "saved.toml")
    assert hashes_of("replay", tmp_path / "saved.toml") == made


def test_grabs_beside_a_grab_of_the_replay_itself(hashes_of, tmp_path):
    (tmp_path / "first.toml").write_text('scene = "blob"\n[[grab]]\nbody = "blob"\nname = "own"\nselect = { vertices = '
                                         '[1, 2, 3] }\nstiffness = 5\nfrom = 0.3\n')
    world = supple.World(tmp_path / "first.toml")
    made = hashes(world, 2)
    hand = world.grab("blob", [1, 2, 3, 4, 5], stiffness=4)  # two of these belong to the other one, later
    made += hashes(world, 3)
    held = world.state()
    hand.release()
    made += hashes(world, 8)
    world.save_replay(tmp_path / "saved.toml")
    assert hashes_of("replay", tmp_path / "saved.toml") == made
    world.restore(held)
    hand.release()
    assert hashes(world, 8) == made[5:]


def test_settings_that_reach_a_grab_or_depend_on_their_order(hashes_of, tmp_path, cube, monkeypatch):
    monkeypatch.chdir(tmp_path)
    world = supple.World("ear-pull", set={"body.bunny.handles.fingers.stiffness": 20, "frames": 50})
    made = hashes(world, 34)
    world.save_replay("saved.toml")
    assert (tmp_path / "saved-scene.toml").exists()
    assert hashes_of("replay", tmp_path / "saved.toml") == made
    world = supple.World("blob", set={"body.blob.material.mu": 90, "body.blob.material": {
        "model": "neo-hookean", "mu": 30, "lambda": 25}})
    made = hashes(world, 4)
    world.save_replay("blob.toml")
    assert hashes_of("replay", tmp_path / "blob.toml") == made


def test_pieces_of_a_surface_change_together(hashes_of, tmp_path):
    def cube_at(x):
        return [(x + a, b, c) for a in (0, 0.1) for b in (0, 0.1) for c in (0, 0.1)]

    faces = [(1, 2, 4), (1, 4, 3), (5, 7, 8), (5, 8, 6), (1, 5, 6), (1, 6, 2), (3, 4, 8), (3, 8, 7), (1, 3, 7), (1, 7, 5),
             (2, 6, 8), (2, 8, 4)]
    lines = [f"v {x} {y} {z}" for x, y, z in cube_at(0) + cube_at(0.3)]
    lines += ["f " + " ".join(str(v + shift) for v in face) for shift in (0, 8) for face in faces]
    (tmp_path / "two.obj").write_text("\n".join(lines) + "\n")
    scene = {"body": [{"name": "p", "surface": str(tmp_path / "two.obj"), "pieces": "bodies", "vertices": 300,
                       "material": {"model": "neo-hookean", "young": 2e4, "poisson": 0.3}}]}
    world = supple.World(scene)
    assert list(world.bodies) == ["p_1", "p_2"]
    made = hashes(world, 2)
    mass = world.bodies["p_2"].masses.sum()
    world.set("body.p.density", 300)
    made += hashes(world, 3)
    assert world.bodies["p_2"].masses.sum() == pytest.approx(0.3 * mass)
    world.save_replay(tmp_path / "saved.toml")
    assert hashes_of("replay", tmp_path / "saved.toml") == made
    with pytest.raises(supple.InputError, match="piece"):
        world.grab("p_1", [0], stiffness=1)
