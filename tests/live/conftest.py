"""Talks to `supple live` as its page does, over HTTP, with Python's own library alone."""
import http.client
import json
import os
import re
import signal
import subprocess
import threading
import time

import pytest

PROGRAM = os.environ["SUPPLE_PROGRAM"]


class Page:
    """One page of a session: it steers unless `watches`."""

    def __init__(self, host, port, base, watches=False, writer=None):
        self.host, self.port, self.base = host, port, base
        self.threads = threading.local()
        self.writer = None if watches else writer or self.ask("POST", "claim")[1]["writer"]
        self.events, self.changed = [], threading.Condition()
        self.stream = http.client.HTTPConnection(host, port, timeout=60)
        self.stream.request("GET", base + "events" + (f"?writer={self.writer}" if self.writer else ""))
        self.listening = threading.Thread(target=self.listen, args=(self.stream.getresponse(),), daemon=True)
        self.listening.start()

    def ask(self, method, path, body=None, headers=None, full=False):
        """Returns the status and the body, which is parsed where it is JSON; with `full`, also the headers."""
        if not hasattr(self.threads, "connection"):
            self.threads.connection = http.client.HTTPConnection(self.host, self.port, timeout=60)
        self.threads.connection.request(method, self.base + path, body=body, headers=headers or {})
        response = self.threads.connection.getresponse()
        data = response.read()
        if response.getheader("Content-Type") == "application/json" and data:
            data = json.loads(data)
        return (response.status, data, response.headers) if full else (response.status, data)

    def command(self, **keys):
        return self.ask("POST", "do", json.dumps(keys), {"X-Writer": self.writer or "nobody"})

    def do(self, **keys):
        status, answer = self.command(**keys)
        assert status == 200, (keys, answer)
        return answer

    def listen(self, response):
        name = None
        for line in response:
            if line.startswith(b"event: "):
                name = line[7:].strip().decode()
            elif line.startswith(b"data: "):
                with self.changed:
                    self.events.append((name, json.loads(line[6:])))
                    self.changed.notify_all()

    def last(self, name):
        found = [data for event, data in self.events if event == name]
        return found[-1] if found else None

    def state(self):
        """Returns the newest state that the page was told."""
        return self.last("state") or self.wait_for("hello")["state"]

    def wait_for(self, name, holds=lambda data: True, timeout=30):
        """Returns the newest event of this name once one holds that comes from now on, or is there."""
        end = time.monotonic() + timeout
        with self.changed:
            while not any(event == name and holds(data) for event, data in self.events):
                assert self.changed.wait(end - time.monotonic()), f"no such event '{name}' came"
        return self.last(name)

    def wait_state(self, holds, timeout=30):
        """Waits until the newest state is such a one. Returns it."""
        end = time.monotonic() + timeout
        with self.changed:
            while not (self.last("state") and holds(self.last("state"))):
                assert self.changed.wait(end - time.monotonic()), self.last("state")
        return self.last("state")

    def wait_frames(self, frames, timeout=30):
        """Waits until the film has come to so many frames."""
        end = time.monotonic() + timeout
        with self.changed:
            while (self.last("frame") or {"frame": 0})["frame"] < frames:
                assert self.changed.wait(end - time.monotonic()), f"frame {frames} did not come"

    def grab_something(self, timeout=10):
        """Grabs at the first place of the picture, from the middle outwards, where a body is. What was dragged may have
        swung out of the picture, and comes back."""
        places = [(0.1 * x, 0.1 * y) for x in range(1, 10) for y in range(1, 10)]
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            refused = set()
            for x, y in sorted(places, key=lambda place: (place[0] - 0.5) ** 2 + (place[1] - 0.5) ** 2):
                status, answer = self.command(do="grab", x=x, y=y)
                if status == 200:
                    return answer
                refused.add(json.dumps(answer))
            time.sleep(0.1)
        raise AssertionError(f"no body is in the picture of {self.state()}: {refused}")

    def save(self, folder):
        """Saves the replay into a folder, as a browser does. Returns its file."""
        status, saved = self.ask("GET", "replay")
        assert status == 200, saved
        (folder / saved["name"]).write_text(saved["replay"])
        if saved["scene"] is not None:
            (folder / saved["scene_name"]).write_text(saved["scene"])
        return folder / saved["name"]


class Session:
    """A running `supple live`, and its first page."""

    def __init__(self, folder, *arguments, claims=True, text=None):
        self.folder = folder
        self.process = subprocess.Popen([PROGRAM, "live", *arguments, "--size", "160x90"], cwd=folder,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.process.stdin.write(text or "")
        self.process.stdin.close()
        self.line = self.process.stdout.readline()
        address = re.search(r"http://([^:]+):(\d+)(/[0-9a-f]{32}/)", self.line)
        assert address, self.line + self.process.stderr.read()
        self.host, self.port, self.base = address[1], int(address[2]), address[3]
        self.page = Page(self.host, self.port, self.base) if claims else None

    def watcher(self):
        return Page(self.host, self.port, self.base, watches=True)

    def end(self, how=signal.SIGINT):
        """Ends the program. Returns its exit status, standard output and standard error."""
        if self.process.poll() is None:
            self.process.send_signal(how)
        out, err = self.process.stdout.read(), self.process.stderr.read()
        return self.process.wait(timeout=60), self.line + out, err


@pytest.fixture
def live(tmp_path):
    """Starts sessions in a folder of their own, and ends them."""
    started = []

    def start(*arguments, **options):
        started.append(Session(tmp_path, *arguments, **options))
        return started[-1]

    yield start
    for session in started:
        session.process.kill()
        session.process.wait()
        session.process.stdout.close()
        session.process.stderr.close()


def replay(file, *options):
    """Films a replay without pictures. Returns the rows of its profile, and what it said."""
    out = file.parent / (file.stem + "-film")
    done = subprocess.run([PROGRAM, "replay", str(file), "--no-images", "--out", str(out), *options],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads((out / "profile.json").read_text())["frames"], done.stdout + done.stderr


def assert_same_bits(file, *options):
    """Films a replay, all of whose frames must be as the session played them."""
    rows, said = replay(file, *options)
    assert all(row["as_in_session"] for row in rows), [row["frame"] for row in rows if not row["as_in_session"]][:3]
    assert f"all {len(rows)} frame" in said and "as the live session played them" in said
    return rows
