"""Sessions of `supple live` as a page has them: what is done is a replay with the same bits, what is wrong is refused."""
import os
import random
import shutil
import signal
import subprocess
import time

import pytest

from conftest import PROGRAM, Page, assert_same_bits, replay

SCENE = """title = "A bar and a cube"
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [8, 3, 3] }
position = [0, 0.3, 0]
material = { model = "neo-hookean", young = 3e4, poisson = 0.4 }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0.01, 1, 1]] }
[[body]]
name = "cube"
box = { extent = [0.1, 0.1, 0.1], cells = [3, 3, 3] }
position = [0.1, 0.5, 0]
material = { model = "stable-neo-hookean", young = 3e4, poisson = 0.4 }
[[collider]]
name = "floor"
shape = { half_space = { normal = [0, 1, 0] } }
"""


@pytest.fixture
def scene(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)
    return "scene.toml"


def test_everything_that_a_page_does_is_a_replay(live, scene, tmp_path):
    session = live(scene)
    page = session.page
    page.wait_frames(5)
    page.do(do="set", path="body.bar.material.young", value="1e4")
    page.do(do="set", path="gravity", value="[0, -4, 0]", over=0.2)
    page.wait_frames(15)
    assert page.grab_something()["grab"] == "hand-1"
    for i in range(12):
        page.do(do="drag", x=0.5 + 0.01 * i, y=0.5 - 0.02 * i)
        time.sleep(0.02)
    page.do(do="drop")
    page.do(do="set", path="solver.method", value='"newton"')
    page.do(do="pause")
    paused = page.wait_state(lambda state: state["paused"])["frame"]
    page.do(do="step")
    page.do(do="step")
    page.wait_frames(paused + 2)
    time.sleep(0.2)
    assert page.last("frame")["frame"] == paused + 2
    page.do(do="speed", factor=4)
    page.do(do="run")
    page.wait_frames(paused + 20)
    page.do(do="set", path="solver.method", value="quasi-newton")
    page.do(do="go", frame=20)
    assert page.wait_state(lambda state: state["frame"] == 20)
    page.grab_something()
    page.do(do="drag", x=0.6, y=0.4)
    time.sleep(0.4)
    page.do(do="drop", pin=True)
    page.do(do="set", path="collider.floor.position", value="[0, 0.05, 0]", over=0.3)
    page.do(do="orbit", by=[30, 10])
    page.do(do="keep_view")
    page.do(do="show", field="stretch", wireframe=True)
    page.wait_frames(60)
    rows = assert_same_bits(page.save(tmp_path))
    assert len(rows) >= 60
    assert_same_bits(page.save(tmp_path), "--threads", "1", "--force")
    # A film whose values are others is not as the session was, and says so.
    changed, said = replay(page.save(tmp_path), "--force", "--set", "solver.iterations=3")
    assert not all(row["as_in_session"] for row in changed)
    assert "not as the live session played it" in said


@pytest.mark.parametrize("seed", range(int(os.environ.get("SUPPLE_LIVE_SESSIONS", 3))))
def test_random_sessions_are_replays(live, scene, tmp_path, seed):
    choose = random.Random(seed)
    session = live(scene, "--set", "substeps=2")
    page = session.page
    held = False
    for _ in range(40):
        act = choose.choice(["young", "gravity", "iterations", "density", "grab", "drag", "drag", "drop", "step", "run",
                              "speed", "go", "wait", "show", "budget", "restart"])
        if act == "young":
            page.do(do="set", path=f"body.{choose.choice(['bar', 'cube'])}.material.young",
                    value=f"{10 ** choose.uniform(3.5, 5.5):.4g}", over=choose.choice([0, 0, 0.3]))
        elif act == "gravity":
            page.do(do="set", path="gravity", value=f"[{choose.uniform(-3, 3)}, {choose.uniform(-12, 0)}, 0]")
        elif act == "iterations":
            page.do(do="set", path="solver.iterations", value=str(choose.randint(2, 20)))
        elif act == "density":
            page.do(do="set", path="body.cube.density", value=str(choose.randint(300, 3000)))
        elif act == "grab":
            held = page.command(do="grab", x=choose.uniform(0.3, 0.7), y=choose.uniform(0.2, 0.8))[0] == 200
        elif act == "drag" and held:
            page.do(do="drag", x=choose.uniform(0.3, 0.7), y=choose.uniform(0.2, 0.8))
        elif act == "drop":
            page.do(do="drop", pin=choose.random() < 0.3)
            held = False
        elif act == "step":
            page.do(do="step")
        elif act == "run":
            page.do(do="run")
        elif act == "speed":
            page.do(do="speed", factor=choose.choice([0.5, 1, 4]))
        elif act == "go" and choose.random() < 0.5:
            page.do(do="go", frame=choose.randint(0, page.do(do="pause") and page.state()["frame"]))
            held = False
        elif act == "show" and choose.random() < 0.3:
            page.do(do="show", field=choose.choice(["none", "speed", "volume"]))
        elif act == "budget":
            page.do(do="set", path="solver.budget_ms", value=choose.choice(["0", "0.5", "2"]))
        elif act == "restart" and choose.random() < 0.1:
            page.do(do="restart")
            held = False
        else:
            time.sleep(choose.uniform(0, 0.2))
    page.do(do="step")
    time.sleep(0.2)
    assert_same_bits(page.save(tmp_path))


def test_a_session_goes_on_from_a_replay(live, scene, tmp_path):
    page = live(scene).page
    page.wait_frames(5)
    page.do(do="set", path="gravity", value="[1, -4, 0]")
    page.grab_something()
    page.wait_frames(12)
    first = page.save(tmp_path)
    first = first.rename(first.with_name("first.toml"))
    page = live(str(first)).page
    page.wait_frames(20)
    page.do(do="set", path="body.cube.material.young", value="2e5")
    page.wait_frames(30)
    assert_same_bits(page.save(tmp_path))


def test_models_and_scenes_from_standard_input_are_saved_whole(live, tmp_path):
    (tmp_path / "model.obj").write_text("".join(
        f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1)) + "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\n"
        "f 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n")
    page = live("model.obj", "--set", "body.model.vertices=100").page
    page.wait_frames(3)
    page.do(do="set", path="gravity", value="[0, -2, 0]")
    page.wait_frames(8)
    assert_same_bits(page.save(tmp_path))


def test_what_is_refused_changes_nothing(live, scene, tmp_path):
    page = live(scene, "--paused").page
    for path, value, words in [("body.bar.material.young", "-1", ["young = -1", "above 0"]),
                               ("body.bar.material.yung", "1", ["yung", "did you mean 'young'"]),
                               ("body.rod.material.young", "1", ["rod"]),
                               ("body.bar.box.cells", "[1, 1, 1]", ["cannot change while the film runs"]),
                               ("solver.method", "magic", ["method", "quasi-newton"]),
                               ("solver.iterations", "[[[", ["iterations"]),
                               ("gravity", "{}", ["gravity"]),
                               ("", "1", ["cannot change"]),
                               ("camera", "{ position = 1 }", ["position"])]:
        status, answer = page.command(do="set", path=path, value=value)
        assert status == 422, (path, value, answer)
        assert all(word in answer["error"] for word in words), (answer, words)
    assert page.command(do="go", frame=1)[0] == 422
    assert page.command(do="drag", x=0.5, y=0.5)[0] == 422
    assert page.command(do="grab", x=0.01, y=0.01) == (422, {"error": "nothing is there"})
    assert page.command(do="release", body="bar", name="hand-9")[0] == 422
    assert page.command(do="show", field="distance")[0] == 422
    page.do(do="step")
    page.wait_frames(1)
    text = page.save(tmp_path).read_text()
    assert "[[change]]" not in text and "[[grab]]" not in text
    assert_same_bits(page.save(tmp_path))


def test_one_page_steers_and_others_watch(live, scene):
    session = live(scene)
    page = session.page
    assert page.ask("POST", "claim")[0] == 409
    watcher = session.watcher()
    hello = watcher.wait_for("hello")
    assert hello["writer"] is False and hello["title"] == "A bar and a cube"
    assert watcher.command(do="pause")[0] == 403
    assert watcher.ask("GET", "events?writer=ffff")[0] == 403
    page.do(do="set", path="body.bar.material.young", value="12345")
    assert watcher.wait_for("value", lambda value: value["path"] == "body.bar.material.young")["value"] == "12345"
    watcher.wait_frames(3)


def test_controls_have_ranges_words_and_values(live, scene):
    controls = {control["path"]: control for control in live(scene).page.wait_for("hello")["controls"]}
    young = controls["body.bar.material.young"]
    assert (young["group"], young["name"], young["type"], young["unit"]) == ("bar", "material.young", "number", "Pa")
    assert (young["low"], young["high"], young["open_low"], young["value"]) == (0, None, True, "30000")
    assert young["cost"] == "a new factor"
    assert "newton" in controls["solver.method"]["words"]
    assert (controls["solver.armijo"]["low"], controls["solver.armijo"]["high"]) == (0, 0.5)


def test_pictures_come_as_they_are_made(live, scene):
    page = live(scene).page
    number = 0
    for _ in range(5):
        status, jpeg, headers = page.ask("GET", f"picture?after={number}", full=True)
        assert status == 200 and jpeg[:3] == b"\xff\xd8\xff" and jpeg[-2:] == b"\xff\xd9"
        assert int(headers["X-Picture"]) > number
        number = int(headers["X-Picture"])
    page.do(do="pause")
    asked = page.do(do="orbit", by=[10, 0])["input"]
    while int(headers["X-Input"]) < asked:  # a still world is drawn again for another view
        status, jpeg, headers = page.ask("GET", f"picture?after={headers['X-Picture']}", full=True)
        assert status == 200


def test_a_replay_that_is_kept_is_whole_after_a_kill(live, scene, tmp_path):
    session = live(scene, "--record-replay", "kept.toml")
    session.page.do(do="set", path="gravity", value="[0, -4, 0]")
    session.page.wait_frames(75)
    session.end(signal.SIGKILL)
    rows = assert_same_bits(tmp_path / "kept.toml")
    assert len(rows) >= 20


def test_what_is_left_behind_is_kept_beside(live, scene, tmp_path):
    session = live(scene, "--record-replay", "kept.toml")
    session.page.do(do="set", path="gravity", value="[0, -4, 0]")
    session.page.wait_frames(10)
    session.page.do(do="restart")
    session.page.do(do="set", path="gravity", value="[0, -8, 0]")
    session.page.wait_state(lambda state: state["frame"] < 4)
    time.sleep(0.3)
    status, out, err = session.end()
    assert status == 0 and "replay   kept.toml" in err
    assert len(assert_same_bits(tmp_path / "kept-1.toml")) >= 10
    assert "-8" in (tmp_path / "kept.toml").read_text()
    assert_same_bits(tmp_path / "kept.toml")


def test_an_interrupt_ends_it_and_says_what_is_not_saved(live, scene):
    session = live(scene)
    session.page.wait_frames(2)
    status, out, err = session.end()
    assert status == 0 and "warning" not in err
    session = live(scene)
    session.page.do(do="set", path="gravity", value="[0, -4, 0]")
    status, out, err = session.end()
    assert status == 0 and "--record-replay FILE keeps it" in err


def test_a_step_that_fails_leaves_the_last_whole_frame(live, tmp_path):
    (tmp_path / "scene.toml").write_text("""[[body]]
name = "cube"
box = { extent = [0.1, 0.1, 0.1], cells = [2, 2, 2] }
material = { model = "polynomial", mu = 1e9 }
solver = { line_search = "none", levels = 1 }  # no search keeps it from growing without bounds
handles = [{ name = "hook", select = { box = [[0, 0, 0], [0.1, 1, 1]] } }]
""")
    page = live("scene.toml").page
    page.wait_frames(5)
    page.do(do="set", path="gravity", value="[0, -1e6, 0]")
    said = page.wait_for("say", lambda say: "failed" in say["text"])["text"]
    assert "body 'cube' failed" in said and "back at its last whole frame" in said
    assert page.wait_state(lambda state: state["paused"])["frame"] >= 5
    page.do(do="go", frame=5)
    page.do(do="set", path="gravity", value="[0, -5, 0]")
    page.do(do="step")
    page.wait_for("frame", lambda frame: frame["frame"] == 6)
    time.sleep(0.2)
    assert_same_bits(page.save(tmp_path))


def test_a_grab_may_be_let_go_twice(live, scene, tmp_path):
    page = live(scene, "--paused").page
    grabbed = page.grab_something()
    page.do(do="drop", pin=True)
    assert page.wait_state(lambda state: state["pins"])["pins"] == [{"body": grabbed["body"], "name": "hand-1"}]
    for _ in range(2):
        page.do(do="release", body=grabbed["body"], name="hand-1")
    page.wait_state(lambda state: state["pins"] == [])
    for _ in range(3):
        page.do(do="step")
    page.wait_frames(3)
    assert page.command(do="release", body=grabbed["body"], name="hand-1")[0] == 422
    assert_same_bits(page.save(tmp_path))


def test_pins_come_back_where_they_held(live, scene, tmp_path):
    page = live(scene).page
    page.wait_frames(3)
    body = page.grab_something()["body"]
    page.wait_frames(8)
    page.do(do="drop", pin=True)
    pinned = page.state()["frame"]
    page.wait_frames(pinned + 10)
    page.do(do="release", body=body, name="hand-1")
    page.wait_frames(pinned + 20)
    page.do(do="go", frame=pinned + 5)
    page.wait_state(lambda state: state["frame"] == pinned + 5 and state["pins"][0]["name"] == "hand-1")
    page.do(do="go", frame=4)  # the hand held then, but was no pin
    page.wait_state(lambda state: state["frame"] == 4 and not state["pins"])
    page.wait_frames(8)
    assert_same_bits(page.save(tmp_path))


def test_a_look_that_is_refused_changes_nothing(live, scene, tmp_path):
    subprocess.run([PROGRAM, "render", "scene.toml", "--no-images", "--frames", "6", "--out", "ghost"], cwd=tmp_path,
                   check=True, capture_output=True)
    page = live(scene, "--set", "look.ghost=ghost").page
    page.wait_frames(12)  # beyond the end of the run that is shown
    shutil.rmtree(tmp_path / "ghost")
    assert page.command(do="show", wireframe=True)[0] == 422
    frame = page.last("frame")["frame"]
    page.wait_frames(frame + 5)


def test_hands_that_are_no_more_leave_the_picture(live, scene, tmp_path):
    page = live(scene).page
    page.wait_frames(3)
    page.grab_something()
    page.wait_frames(6)
    page.do(do="show", field="stretch")  # the picture now has the hand as a support
    page.wait_frames(10)
    page.do(do="go", frame=2)
    page.grab_something()
    page.wait_frames(8)
    assert_same_bits(page.save(tmp_path))


def test_budgets_of_an_earlier_session_end_with_the_first_edit(live, scene, tmp_path):
    page = live(scene, "--set", "solver.budget_ms=0.05", "--set", "solver.iterations=200").page
    page.wait_frames(12)
    first = page.save(tmp_path)
    first = first.rename(first.with_name("first.toml"))
    assert "cuts" in first.read_text()
    page = live(str(first)).page
    page.wait_frames(4)
    page.do(do="set", path="solver.budget_ms", value="0")
    page.do(do="set", path="solver.iterations", value="11")
    changed = page.state()["frame"]
    page.wait_frames(changed + 8)
    assert page.last("frame")["iterations"] >= 22  # of both bodies
    page.do(do="go", frame=changed + 3)
    page.wait_frames(changed + 6)
    assert not any(event == "say" and "other bits" in say["text"] for event, say in page.events)
    rows = assert_same_bits(page.save(tmp_path))
    second = page.save(tmp_path)
    second = second.rename(second.with_name("second.toml"))
    page = live(str(second)).page  # budgets that are no more stay away
    page.wait_frames(len(rows) + 3)
    page.do(do="set", path="gravity", value="[0, -3, 0]")
    page.wait_frames(len(rows) + 6)
    assert_same_bits(page.save(tmp_path))


def test_keeping_the_rate_is_repeated(live, scene, tmp_path):
    page = live(scene, "--set", "solver.iterations=3000").page
    page.wait_frames(5)
    page.do(do="keep_rate", on=True)
    page.wait_frames(40)
    page.do(do="keep_rate", on=False)
    page.do(do="set", path="solver.iterations", value="10")
    page.wait_frames(45)
    rows = assert_same_bits(page.save(tmp_path))
    assert any(any(cut[0] >= 0 for cut in body.get("budget_cuts", [])) for row in rows for body in row["bodies"])


def test_no_file_of_the_user_is_written_over(live, scene, tmp_path):
    for name in ["kept.toml", "kept-scene.toml"]:
        (tmp_path / name).write_text("mine")
        refused = subprocess.run([PROGRAM, "live", "scene.toml", "--record-replay", "kept.toml"], cwd=tmp_path,
                                 capture_output=True, text=True)
        assert refused.returncode == 2 and f"{name} is there already" in refused.stderr
        assert (tmp_path / name).read_text() == "mine"
        (tmp_path / name).unlink()


def test_a_past_that_is_left_keeps_its_scene(live, tmp_path):
    process = live("-", "--record-replay", "kept.toml", text=SCENE)
    page = process.page
    body = page.grab_something()["body"]
    page.wait_frames(5)
    page.do(do="set", path=f"body.{body}.density", value="500")
    page.wait_frames(10)
    page.do(do="restart")
    page.grab_something()
    page.wait_state(lambda state: state["frame"] < 4)
    page.wait_frames(6)
    assert process.end()[0] == 0
    assert_same_bits(tmp_path / "kept-1.toml")
    assert_same_bits(tmp_path / "kept.toml")


def test_a_replay_that_cannot_be_kept_is_told(live, scene, tmp_path):
    (tmp_path / "folder").mkdir()
    session = live(scene, "--record-replay", "folder/kept.toml")
    session.page.do(do="set", path="gravity", value="[0, -4, 0]")
    session.page.wait_frames(2)
    shutil.rmtree(tmp_path / "folder")
    session.page.wait_for("words", lambda words: any("the replay is not kept" in word for word in words))
    status, out, err = session.end()
    assert status == 1 and "the replay is not kept" in err and "supple replay films it" not in err


def test_a_copy_of_the_page_takes_over(live, scene):
    session = live(scene)
    page = session.page
    page.wait_for("hello")
    copy = Page(session.host, session.port, session.base, writer=page.writer)
    copy.wait_for("hello")
    page.wait_for("moved")
    page.listening.join(timeout=10)
    assert not page.listening.is_alive()
    copy.do(do="pause")


def test_an_address_that_cannot_be_listened_to_is_told(live, scene, tmp_path):
    session = live(scene)
    for options, words in [(["--port", str(session.port)], [f"--port {session.port}", "in use"]),
                           (["--listen", "8.8.8.8"], ["--listen 8.8.8.8", "cannot be listened to"]),
                           (["--listen", "localhost"], ["--listen localhost", "in numbers"]),
                           (["--size", "12"], ["--size 12", "WIDTHxHEIGHT"])]:
        refused = subprocess.run([PROGRAM, "live", "scene.toml", *options], cwd=tmp_path, capture_output=True, text=True)
        assert refused.returncode == 2 and all(word in refused.stderr for word in words), refused.stderr
