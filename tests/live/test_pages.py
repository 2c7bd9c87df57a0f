"""The page of a run in a real browser where one is installed: the film comes first, keys drive it and its tables, dark
screens get a dark page, and paper a white one."""
import base64
import os
import re
import shutil
import subprocess

import pytest

from browser import Browser

PROGRAM = os.environ["SUPPLE_PROGRAM"]
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None or shutil.which("ffmpeg") is None,
                                reason="chromium or ffmpeg is not installed")

FRAMES = 20
SCENE = f"""title = "A bar"
frames = {FRAMES}
fps = "30000/1001"
[[body]]
name = "bar"
box = {{ extent = [0.4, 0.2, 0.2], cells = [4, 2, 2] }}
material = "jelly"
[output]
width = 320
height = 180
samples = 1
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("pages")
    (place / "bar.toml").write_text(SCENE)
    subprocess.run([PROGRAM, "render", "bar.toml", "--out", "bar", "--page", "--quiet"], cwd=place, check=True)
    (place / "scenes").mkdir()
    for name in ["light", "heavy"]:
        (place / "scenes" / f"{name}.toml").write_text(SCENE)
    subprocess.run([PROGRAM, "gallery", "scenes", "--width", "64", "--out", "gallery"], cwd=place, check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return place


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    started = Browser(CHROMIUM, tmp_path_factory.mktemp("profile"))
    yield started
    started.end()


def open_page(browser, folder, name="bar", width=1000, height=800):
    browser.open(f"file://{folder}/{name}/index.html", width, height)
    browser.wait_for("document.readyState === 'complete' && document.querySelector('video')?.readyState >= 2")


def frame_of(browser):
    return int(re.search(r"frame (\d+)", browser.value("document.querySelector('output.frame').value")).group(1))


def focused(browser):
    return browser.value("document.activeElement.tagName")


def tab_to(browser, tag):
    for _ in range(60):
        browser.key("Tab")
        if focused(browser) == tag:
            return
    raise AssertionError(f"Tab does not reach {tag}")


def luminance(browser, selector, what):
    channels = [int(c) / 255 for c in re.findall(r"\d+", browser.value(
        f"getComputedStyle(document.querySelector('{selector}')).{what}"))[:3]]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(browser, selector):
    a, b = luminance(browser, selector, "color"), luminance(browser, "body", "backgroundColor")
    return (max(a, b) + 0.05) / (min(a, b) + 0.05)


def test_the_film_comes_first_and_is_seen_at_once(browser, folder):
    open_page(browser, folder)
    assert browser.value("document.body.firstElementChild.tagName") == "VIDEO"
    left, top, width, height = browser.box("video")
    assert top < 60 and top + height < 800 and width > 600


def test_keys_drive_the_film(browser, folder):
    open_page(browser, folder)
    for key, frame in [("End", FRAMES - 1), ("ArrowRight", FRAMES - 1), ("ArrowLeft", FRAMES - 2), ("Home", 0),
                       ("ArrowLeft", 0), ("ArrowRight", 1), ("ArrowRight", 2)]:
        browser.key(key)
        browser.wait_for(f"document.querySelector('output.frame').value.includes('frame {frame},')")
        shown = f"Math.min({FRAMES - 1}, Math.floor(document.querySelector('video').currentTime * 30000 / 1001 + 1e-6))"
        browser.wait_for(f"{shown} === {frame}")
    browser.key(" ", "Space", " ")
    browser.wait_for("!document.querySelector('video').paused")
    browser.key(" ", "Space", " ")
    browser.wait_for("document.querySelector('video').paused")


def test_keys_mean_the_same_on_the_film_itself(browser, folder):
    open_page(browser, folder)
    browser.value("document.querySelector('video').focus()")
    browser.key("End")
    browser.wait_for(f"document.querySelector('output.frame').value.includes('frame {FRAMES - 1},')")
    browser.key("ArrowLeft")
    assert frame_of(browser) == FRAMES - 2
    browser.key(" ", "Space", " ")
    browser.wait_for("!document.querySelector('video').paused")


def test_tables_are_sorted_by_tab_and_keys(browser, folder):
    open_page(browser, folder)
    column = "[...document.querySelectorAll('tbody tr')].map(row => +row.cells[0].textContent)"
    browser.value("document.querySelector('.box').focus()")
    tab_to(browser, "BUTTON")
    assert browser.value("document.activeElement.matches(':focus-visible')")
    assert browser.value("getComputedStyle(document.activeElement).outlineStyle") == "solid"
    browser.key("Enter", text="\r")
    up = browser.value(column)
    assert up == sorted(up) and len(set(up)) > 3
    assert browser.value("document.activeElement.parentElement.getAttribute('aria-sort')") == "ascending"
    browser.key("Enter", text="\r")
    assert browser.value(column) == up[::-1]
    tab_to(browser, "TR")
    wanted = browser.value("+document.activeElement.dataset.frame")
    browser.key("Enter", text="\r")
    assert frame_of(browser) == wanted


def test_wide_tables_scroll_by_arrows(browser, folder):
    open_page(browser, folder, width=380)
    browser.key("ArrowRight")
    assert frame_of(browser) == 1
    browser.value("document.querySelector('.box').focus()")
    for _ in range(3):
        browser.key("ArrowRight")
    browser.wait_for("document.querySelector('.box').scrollLeft > 0")
    assert frame_of(browser) == 1


@pytest.mark.parametrize("name", ["bar", "gallery"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_pages_suit_light_and_dark_screens(browser, folder, name, scheme):
    browser.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
    open_page(browser, folder, name)
    paper = luminance(browser, "body", "backgroundColor")
    assert paper > 0.9 if scheme == "light" else paper < 0.02
    for selector in ["h1", ".soft", "td", "th"]:
        assert contrast(browser, selector) > 4.5, selector
    browser.ask("Emulation.setEmulatedMedia", features=[])


@pytest.mark.parametrize("name", ["bar", "gallery"])
def test_paper_is_white_and_shows_a_picture_of_the_film(browser, folder, name):
    open_page(browser, folder, name)
    browser.ask("Emulation.setEmulatedMedia", media="print",
                features=[{"name": "prefers-color-scheme", "value": "dark"}])
    assert luminance(browser, "body", "backgroundColor") > 0.9
    assert browser.value("getComputedStyle(document.querySelector('video')).display") == "none"
    assert browser.value("[...document.querySelectorAll('img.paper')].every(i => i.naturalWidth > 0 && i.offsetHeight > 20)")
    # Nothing is wider than a sheet of A4 within its margins.
    browser.ask("Emulation.setDeviceMetricsOverride", width=680, height=1010, deviceScaleFactor=1, mobile=False)
    assert browser.value("document.documentElement.scrollWidth") <= 680
    browser.ask("Emulation.setEmulatedMedia", media="", features=[])
    document = base64.b64decode(browser.ask("Page.printToPDF", printBackground=True, preferCSSPageSize=True)["data"])
    assert document.startswith(b"%PDF")


def test_films_of_a_gallery_are_driven_by_the_same_keys(browser, folder):
    open_page(browser, folder, "gallery")
    browser.value("document.querySelector('video').focus()")
    at = "Math.abs(document.querySelector('video').currentTime - ({} + 0.5) * 1001 / 30000) < 2e-3"
    for key, frame in [("End", FRAMES - 1), ("ArrowLeft", FRAMES - 2), ("Home", 0), ("ArrowRight", 1)]:
        browser.key(key)
        browser.wait_for(at.format(frame))
    browser.key(" ", "Space", " ")
    browser.wait_for("!document.querySelector('video').paused")
