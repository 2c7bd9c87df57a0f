"""Every snippet of the manual's page runs as it stands."""

import pathlib
import re
import subprocess
import sys

import pytest

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs/python.md"
SNIPPETS = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.S)


@pytest.mark.parametrize("number", range(len(SNIPPETS)))
def test_snippet(number, tmp_path):
    snippet = SNIPPETS[number]
    for package in re.findall(r"^(?:from|import) (\w+)", snippet, re.M):
        pytest.importorskip(package)
    (tmp_path / "snippet.py").write_text(snippet)
    told = subprocess.run([sys.executable, "snippet.py"], cwd=tmp_path, capture_output=True, text=True)
    assert told.returncode == 0, told.stderr
    for expected in EXPECTED.get(number, []):
        assert re.search(expected, told.stdout), told.stdout


# What the snippets print, by their places on the page.
EXPECTED = {
    1: [r"m; .* Pa; \d+"],
    2: [r"e\+06 Pa, with a sag of 31\.0 mm"],
    3: [r"10 Pa: .*\n20 Pa: .*\n40 Pa: .*\n80 Pa: .* m wide"],
    4: [r"episode 2 ends 0\.0[12]\d* m"],
    5: [r"\(270, 480, 4\)"],
    6: [r"\d vertices touch the ground"],
}


def test_the_page_has_the_snippets_that_are_expected():
    assert len(SNIPPETS) == 7
