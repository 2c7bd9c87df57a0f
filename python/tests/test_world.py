"""Views, reports, errors, pictures of a world."""

import gc

import numpy as np
import pytest

import supple


def test_views_show_the_present_and_outlive_the_world(cube):
    world = supple.World(cube)
    body = world.bodies["cube"]
    x, v = body.positions, body.velocities
    assert x.shape == v.shape == (64, 3) and x.dtype == np.float64
    assert np.array_equal(x, body.rest)
    before = x.copy()
    world.step()
    assert body.positions is x and not x.flags.writeable
    assert np.all(x[:, 1] < before[:, 1])
    assert np.allclose(v, (x - before) * world.fps)  # backward Euler
    with pytest.raises(ValueError):
        x[0, 0] = 1
    last = x.copy()
    del world, body
    gc.collect()
    assert np.array_equal(x, last)


def test_a_body_keeps_its_world(cube):
    body = supple.World(cube).bodies["cube"]
    gc.collect()
    body.world.step()
    assert body.positions.shape == (64, 3)


def test_momentum_by_masses(cube):
    world = supple.World(cube)
    body = world.bodies["cube"]
    assert body.masses.sum() == pytest.approx(1000 * 0.2**3)
    world.step(2)  # free fall, before it lands
    fallen = body.masses @ body.velocities
    assert fallen[1] == pytest.approx(-body.masses.sum() * 9.81 * 2 / 30, rel=1e-9)


def test_contact_holds_the_weight(cube):
    cube["body"][0]["position"] = [0, 0, 0]
    world = supple.World(cube)
    assert np.all(world.bodies["cube"].forces == 0)
    world.step(60)
    forces = world.bodies["cube"].forces
    assert forces[:, 1].sum() == pytest.approx(1000 * 0.2**3 * 9.81, rel=0.01)
    assert world.report["bodies"]["cube"]["contacts"] > 0
    assert world.bodies["cube"].field("force").max() > 0
    world.restore(world.state())
    assert np.all(world.bodies["cube"].forces == 0)  # of no step


def test_surface_and_elements_are_consistent(cube):
    body = supple.World(cube).bodies["cube"]
    a, b, c = (body.rest[body.surface[:, k]] for k in range(3))
    enclosed = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    p = body.rest[body.tetrahedra]
    volume = np.linalg.det(p[:, 1:] - p[:, :1]).sum() / 6
    assert enclosed == pytest.approx(0.2**3) and volume == pytest.approx(0.2**3)


def test_fields_are_those_of_the_pose(cube):
    world = supple.World(cube)
    body = world.bodies["cube"]
    assert body.field("stretch") == pytest.approx(np.ones(64))
    world.step(4)
    assert body.field("speed") == pytest.approx(np.linalg.norm(body.velocities, axis=1))
    for name in ("stretch", "compression", "volume", "energy", "stress", "depth"):
        assert body.field(name).shape == (64,) and np.isfinite(body.field(name)).all()
    assert body.deformation["inverted"] == 0


def test_the_report_adds_up(cube):
    world = supple.World(cube)
    assert world.report["bodies"] == {}
    world.step(6)
    report = world.report
    row = report["bodies"]["cube"]
    parts = sum(row[name] for name in row if name.endswith("_ms") and name != "step_ms")
    assert report["frame"] == 5 and parts <= row["step_ms"] * 1.001
    assert 10 < row["iterations"] <= 30  # the cube lands, and such a step goes on
    assert row["stop_reason"] == "iterations" and not row["unsolved"]


def test_pairs_name_bodies_that_touch():
    world = supple.World("stack")
    world.step(30)
    pairs = world.report["pairs"]
    assert len(pairs) >= 4
    top = max(pairs, key=lambda pair: pair["force"][1])
    assert set(top["bodies"]) <= set(world.bodies) and top["contacts"] > 0


def test_errors_are_against_the_solved_step(cube):
    few, many = (supple.World(cube, set={"solver.iterations": count, "body.cube.material.young": 1e5,
                                         "body.cube.velocity": [1, -1, 0]}) for count in (2, 60))
    with pytest.raises(RuntimeError, match="errors=True"):
        few.error()
    for world in (few, many):
        world.step(6)
        world.step(errors=True)
    assert few.error()["cube"]["motion_error"] > 100 * many.error()["cube"]["motion_error"]
    assert many.error()["cube"]["error"] < 1e-6
    few.step()
    with pytest.raises(RuntimeError):
        few.error()


def test_pictures(cube):
    world = supple.World(cube)
    world.step(2)
    picture = supple.render(world, size=(160, 90))
    assert picture.shape == (90, 160, 3) and picture.dtype == np.uint8
    assert picture.std() > 5  # there is something to see
    same = supple.render(world, size=(160, 90))
    assert np.array_equal(picture, same)
    turned = supple.render(world, size=(160, 90), camera={"azimuth": 75})
    near = supple.render(world, size=(160, 90), camera={"distance": 0.4})
    assert not np.array_equal(picture, turned) and not np.array_equal(picture, near)
    cut_out = supple.render(world, size=(160, 90), set={"look.backdrop": "transparent"})
    assert cut_out.shape == (90, 160, 4) and 0 < (cut_out[:, :, 3] > 0).mean() < 0.9
    png = world.show(size=(160, 90))
    assert png[:8] == b"\x89PNG\r\n\x1a\n" and png._repr_png_() == bytes(png)
    world.step(3)
    assert not np.array_equal(picture, supple.render(world, size=(160, 90)))


def test_a_picture_is_that_of_the_film(program, cube, tmp_path):
    import subprocess

    subprocess.run([program, "render", "blob", "--frames", "8", "--quiet", "--out", tmp_path / "film", "--set",
                    "output.width=320", "--set", "output.height=180"], check=True, capture_output=True)
    subprocess.run(["ffmpeg", "-v", "error", "-i", tmp_path / "film/frames/000007.png", "-f", "rawvideo", "-pix_fmt",
                    "rgb24", tmp_path / "raw"], check=True)
    film = np.fromfile(tmp_path / "raw", dtype=np.uint8).reshape(180, 320, 3).astype(int)
    world = supple.World("blob")
    world.step(8)
    picture = supple.render(world, size=(320, 180)).astype(int)
    assert np.abs(picture - film).mean() < 0.05


def test_a_film(cube, tmp_path):
    import subprocess

    world = supple.World(cube)
    with supple.Film(tmp_path / "film.mp4", fps=world.fps) as film:
        for _ in range(6):
            world.step()
            film.add(supple.render(world, size=(160, 90)))
    told = subprocess.run(["ffprobe", "-v", "error", "-count_packets", "-show_entries",
                           "stream=nb_read_packets,width,height", "-of", "csv=p=0", tmp_path / "film.mp4"],
                          check=True, capture_output=True, text=True).stdout
    assert told.strip() == "160,90,6"


def test_paths_that_can_change(cube):
    world = supple.World(cube)
    assert "body.cube.material.young" in world.live and "body.cube.position" not in world.live
    world.set("body.cube.color", "#3366aa")
    world.step()
    world.set("collider.ground.position", [0, 0.05, 0], over=0.2)
    world.step(10)
    assert world.bodies["cube"].positions[:, 1].min() > 0.04


def test_pictures_follow_a_state_back(cube):
    world = supple.World(cube)
    world.step(2)
    middle = world.state()
    before = supple.render(world, size=(160, 90))
    world.set("collider.ground.shape", {"sphere": {"radius": 0.3}})
    world.step(2)
    assert not np.array_equal(before, supple.render(world, size=(160, 90)))
    world.restore(middle)
    assert np.array_equal(before, supple.render(world, size=(160, 90)))


def test_settings_of_a_picture_hold_whatever_changes(cube):
    world = supple.World(cube)
    first = supple.render(world, size=(160, 90), camera={"azimuth": 80})
    world.set("camera.azimuth", 10)
    world.set("look.exposure", 0.5)
    assert np.array_equal(first, supple.render(world, size=(160, 90), camera={"azimuth": 80}, set={"look.exposure": 1}))


def test_warnings_point_to_the_caller():
    scene = {"body": [{"box": {"extent": [0.2, 0.2, 0.2]}, "material": {"model": "neo-hookean", "young": 10, "poisson": 0.4},
                       "handles": [{"name": "top", "select": {"box": [[0, 0.99, 0], [1, 1, 1]]}}]}]}
    with pytest.warns(supple.SuppleWarning) as told:
        supple.World(scene)
    assert told[0].filename == __file__
