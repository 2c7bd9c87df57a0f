"""Requests that no page makes: they are answered or dropped, and the film goes on as if they had not come."""
import random
import socket
import time

import pytest

PLANE = '[[body]]\nbox = { extent = [0.1, 0.1, 0.1], cells = [2, 2, 2] }\nmaterial = "rubber"\nname = "cube"\n'


@pytest.fixture
def session(live, tmp_path):
    (tmp_path / "scene.toml").write_text(PLANE)
    started = live("scene.toml")
    started.page.wait_frames(1)
    return started


def talk(session, data, wait=5.0):
    """Sends bytes, and returns what comes back until the other side closes."""
    answer = b""
    with socket.create_connection((session.host, session.port), timeout=wait) as connection:
        try:
            connection.sendall(data)
            connection.shutdown(socket.SHUT_WR)
            while piece := connection.recv(65536):
                answer += piece
        except OSError:  # closed by the other side, or silent
            pass
        return answer


def request(session, method="GET", path="", host=None, more="", body=b""):
    head = f"{method} {session.base}{path} HTTP/1.1\r\nHost: {host or session.host}\r\nConnection: close\r\n{more}\r\n"
    return talk(session, head.encode("latin-1") + body)


def status_of(answer):
    return int(answer.split(b" ")[1])


def memory_of(session):
    with open(f"/proc/{session.process.pid}/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS:"))


def settled_memory_of(session):
    """Returns the memory once the film's first frames no longer ask for more."""
    before = memory_of(session)
    for _ in range(40):
        time.sleep(0.5)
        now = memory_of(session)
        if now == before:
            break
        before = now
    return before


def assert_alive(session):
    frame = session.page.last("frame")["frame"]
    session.page.wait_frames(frame + 3)
    assert session.page.command(do="speed", factor=1)[0] == 200


def test_wrong_tokens_hosts_and_origins_are_refused(session):
    assert status_of(request(session)) == 200
    assert status_of(request(session, host="evil.example")) == 403
    assert status_of(request(session, host=f"evil.example:{session.port}")) == 403
    assert status_of(request(session, "POST", "claim", more="Origin: http://evil.example\r\nContent-Length: 0\r\n")) == 403
    wrong = session.base.replace(session.base[1:33], "0" * 32)
    for path in ["events", "picture", "replay", "", "live.js"]:
        answer = talk(session, f"GET {wrong}{path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n".encode())
        assert status_of(answer) == 404 and b"bunny" not in answer
    assert_alive(session)


def test_bodies_are_bounded(session):
    key = f"X-Writer: {session.page.writer}\r\n"
    huge = request(session, "POST", "do", more=key + "Content-Length: 1073741824\r\n", body=b"x" * 1000)
    assert status_of(huge) == 413
    before = settled_memory_of(session)
    chunk = b"8000\r\n" + b"x" * 0x8000 + b"\r\n"
    request(session, "POST", "do", more=key + "Transfer-Encoding: chunked\r\n", body=2000 * chunk)  # 65 MB
    assert memory_of(session) < before + 20000
    assert status_of(request(session, "POST", "do", more=key + "Content-Length: 2\r\n", body=b"{}")) == 422
    long_header = request(session, more="X-Long: " + "y" * 100000 + "\r\n")
    assert long_header == b"" or status_of(long_header) >= 400
    assert_alive(session)


def test_mutated_requests_do_no_harm(session):
    choose = random.Random(1)
    good = [f"GET {session.base}picture?after=0 HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n".encode(),
            f"GET {session.base}replay HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n".encode()]
    for body in [b'{"do":"set","path":"gravity","value":"[0, -9.81, 0]"}', b'{"do":"grab","x":0.5,"y":0.5}', b'{"do":"step"}',
                 b'{"do":"go","frame":2}', b'{"do":"show","field":"stretch"}', b'{"do":"zoom","by":1.1}']:
        good.append(f"POST {session.base}do HTTP/1.1\r\nHost: localhost\r\nX-Writer: {session.page.writer}\r\n"
                    f"Connection: close\r\nContent-Length: {len(body)}\r\n\r\n".encode() + body)
    # The first picture makes the renderer, which needs time and memory of its own.
    assert session.page.ask("GET", "picture?after=0")[0] == 200
    before = None
    for number in range(600):
        data = bytearray(choose.choice(good))
        for _ in range(choose.randint(1, 6)):
            at = choose.randrange(len(data))
            how = choose.randrange(4)
            if how == 0:
                data[at] = choose.randrange(256)
            elif how == 1:
                del data[at:at + choose.randint(1, 20)]
            elif how == 2:
                data[at:at] = bytes(choose.randrange(256) for _ in range(choose.randint(1, 10)))
            else:
                data[at:at] = data[choose.randrange(len(data)):][:50]
            if not data:
                data = bytearray(b"\r\n")
        talk(session, bytes(data), wait=0.05)
        if number == 200:
            before = memory_of(session)
    assert memory_of(session) < before + 50000
    session.page.do(do="run")
    assert_alive(session)


def test_connections_that_are_held_open_do_not_keep_others_out(session):
    held = [socket.create_connection((session.host, session.port)) for _ in range(200)]
    for number, connection in enumerate(held):
        if number % 2 == 0:
            connection.sendall(f"GET {session.base} HTTP/1.1\r\nHost: localh".encode())
    assert_alive(session)
    assert status_of(request(session)) == 200
    for connection in held:
        connection.close()
    assert_alive(session)


def test_readers_that_do_not_read_are_dropped(session):
    slow = socket.create_connection((session.host, session.port))
    slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    slow.sendall(f"GET {session.base}events HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
    gone = socket.create_connection((session.host, session.port))
    gone.sendall(f"GET {session.base}picture?after=0 HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
    gone.close()
    for _ in range(20):
        session.page.do(do="step")
    session.page.do(do="run")
    assert_alive(session)
    slow.close()


def test_a_hand_that_has_gone_holds_nothing(session):
    page = session.page
    page.grab_something()
    page.wait_for("state", lambda state: state["grabbed"] is not None)
    watcher = session.watcher()
    watcher.wait_for("hello")
    page.stream.sock.shutdown(socket.SHUT_RDWR)
    end = time.monotonic() + 20
    while (watcher.last("state") or watcher.last("hello")["state"])["grabbed"] is not None:
        assert time.monotonic() < end
        time.sleep(0.1)


def test_connections_that_ask_for_nothing_are_closed(session):
    trickle = socket.create_connection((session.host, session.port))
    trickle.settimeout(1)
    begin = time.monotonic()
    try:
        while time.monotonic() < begin + 20:  # a byte now and then would keep it open for ever
            trickle.sendall(b"G")
            try:
                if trickle.recv(1) == b"":
                    break
            except TimeoutError:
                continue
    except OSError:
        pass
    assert time.monotonic() < begin + 15
    assert_alive(session)


def test_the_replay_can_be_asked_for_once_a_second(session):
    statuses = [session.page.ask("GET", "replay")[0] for _ in range(30)]
    assert statuses.count(200) >= 5 and statuses.count(429) >= 5 and set(statuses) == {200, 429}
    session.page.do(do="pause")  # commands have a limit of their own
