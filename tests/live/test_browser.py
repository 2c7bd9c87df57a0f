"""The page itself, in a real browser where one is installed: what a hand does on it is a replay with the same bits."""
import shutil
import time

import pytest

from browser import Browser
from conftest import assert_same_bits

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")


@pytest.fixture
def browser(tmp_path):
    started = Browser(CHROMIUM, tmp_path / "profile")
    yield started
    started.end()


@pytest.fixture
def bunny(live):
    """Returns the address of a session of the bunny that no page steers yet."""
    session = live("bunny", "--set", "body.bunny.vertices=800", claims=False)
    return f"http://{session.host}:{session.port}{session.base}"


def open_page(browser, address, width=1280, height=900):
    browser.open(address, width, height)
    browser.wait_for("document.querySelector('#bar') && !document.querySelector('#bar').disabled")
    browser.wait_for("document.querySelector('#frame')?.textContent.match(/[0-9]+/)?.[0] > 3")


def frame_of(browser):
    return browser.value("Number(document.querySelector('#frame').textContent.match(/[0-9]+/)[0])")


def wait_frames(browser, frames):
    browser.wait_for(f"Number(document.querySelector('#frame').textContent.match(/[0-9]+/)[0]) >= {frames}")


def saved(browser, folder, save):
    browser.send("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(folder))
    save()
    file = folder / "bunny-live.toml"
    end = time.monotonic() + 20
    while not file.exists() or file.stat().st_size == 0:
        assert time.monotonic() < end, "no replay was downloaded"
        time.sleep(0.1)
    return file


def no_complaints(browser):
    browser.value("0")  # what it has to say has come by then
    others = [one for one in browser.complaints if "status of 422" not in one.get("entry", {}).get("text", "")]
    assert not others, others  # a grab at a place where nothing is may be refused


def test_a_hand_on_the_page(browser, bunny, tmp_path):
    open_page(browser, bunny)
    # A slider is turned.
    young = "document.querySelector('#control-body_2e_bunny_2e_material_2e_young')"
    before = browser.value(f"{young}.value")
    browser.value(f"{young}.parentNode.querySelector('input[type=range]').focus()")
    for _ in range(5):
        browser.key("ArrowRight")
    browser.wait_for(f"{young}.value != {before}")
    # An ear is dragged.
    left, top, width, height = browser.box("#picture")
    ear = (left + 0.55 * width, top + 0.3 * height)
    browser.drag(ear, [(ear[0] + 6 * i, ear[1] - 3 * i) for i in range(12)])
    # It stands still, goes on by one frame, is solved in another way, and goes on.
    browser.value("document.querySelector('#picture').focus()")
    browser.key(" ", "Space", " ")
    browser.wait_for("document.querySelector('#pause-text').textContent != 'Pause'")
    paused = frame_of(browser)
    browser.key(".", "Period", ".")
    wait_frames(browser, paused + 1)
    browser.value("(one => { one.value = 'newton'; one.dispatchEvent(new Event('change', {bubbles: true})); })("
                  "document.querySelector('#control-solver_2e_method'))")
    time.sleep(0.5)
    browser.key(" ", "Space", " ")
    wait_frames(browser, paused + 15)
    # It goes back, without what was done since.
    browser.value("(one => { one.value = 20; for (const kind of ['input', 'change'])"
                  "one.dispatchEvent(new Event(kind, {bubbles: true})); })(document.querySelector('#timeline'))")
    browser.value("document.querySelector('#go-back').click()")
    browser.wait_for("document.querySelector('#ask').open")
    browser.value("document.querySelector('#ask button[value=go]').click()")
    browser.wait_for("Number(document.querySelector('#frame').textContent.match(/[0-9]+/)[0]) < 35")
    wait_frames(browser, 50)
    browser.drag((left + 0.05 * width, top + 0.1 * height),
                 [(left + 0.05 * width + 5 * i, top + 0.1 * height) for i in range(6)])  # turns the view
    rows = assert_same_bits(saved(browser, tmp_path, lambda: browser.value("document.querySelector('#save').click()")))
    assert len(rows) >= 50
    no_complaints(browser)


def test_by_keys_alone(browser, bunny, tmp_path):
    open_page(browser, bunny)
    browser.value("document.querySelector('#picture').focus()")
    browser.key("g", "KeyG", "g")
    browser.wait_for("!document.querySelector('#crosshair').hidden")
    browser.key("Enter", text="\r")
    browser.wait_for("crosshair.grab !== null")
    for _ in range(10):
        browser.key("ArrowUp")
    browser.key("p", "KeyP", "p")
    browser.wait_for("document.querySelector('#pins').textContent.includes('bunny')")
    browser.key("Escape")
    browser.key("/", "Slash", "/")
    browser.wait_for("document.activeElement.id == 'search'")
    for letter in "gravity":
        browser.key(letter, text=letter)
    browser.key("Escape")
    browser.value("document.querySelector('#picture').focus()")
    wait_frames(browser, frame_of(browser) + 10)
    rows = assert_same_bits(saved(browser, tmp_path, lambda: browser.key("s", "KeyS", "s")))
    assert any("[[grab]]" in line for line in (tmp_path / "bunny-live.toml").read_text().splitlines())
    assert len(rows) > 10
    no_complaints(browser)


def test_who_watches_sees_and_cannot_steer(browser, bunny):
    browser.open(bunny + "?watch", 390, 844)
    browser.wait_for("document.querySelector('#frame')?.textContent.match(/[0-9]+/)?.[0] > 3")
    assert browser.value("document.querySelector('#bar').disabled")
    assert browser.value("document.documentElement.scrollWidth") <= 390
    no_complaints(browser)
