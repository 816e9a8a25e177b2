"""The blocks of Python of the tutorial, and the notebooks, where matplotlib and nbclient are installed."""

import os
import pathlib
import re
import shutil
import subprocess

import pytest

from conftest import ROOT

DOCS = ROOT / "docs"


def blocks(page):
    """The blocks of code of a page: language and text."""
    return re.findall(r"^```(python|sh)\n(.*?)^```$", page.read_text(), re.M | re.S)


def test_the_tutorial(tmp_path, monkeypatch):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robots").symlink_to(ROOT / "robots")
    names = {}
    for language, code in blocks(DOCS / "gravity-compensation.md"):
        if language == "sh":
            for line in filter(None, code.splitlines()):
                subprocess.run(line.split(), check=True, capture_output=True)
        else:
            exec(compile(code, "gravity-compensation.md", "exec"), names)
    assert (tmp_path / "gravity-compensation.png").stat().st_size > 10_000
    # The arm without a controller is the control of the others.
    assert abs(names["falling"][-1] - names["q0"]).max() > 0.5
    assert abs(names["sagging"][-1] - names["q0"]).max() > 0.1


def test_five_minutes(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robots").symlink_to(ROOT / "robots")
    names, count = {}, 0
    for language, code in blocks(DOCS / "start" / "python.md"):
        exec(compile(code, "start/python.md", "exec"), names)
        count += 1
    assert count >= 5 and (tmp_path / "ur5.html").stat().st_size > 100_000


def opens(cells, page):
    """The HTML of nbconvert shows the robot in Chromium. MathJax and the like of nbconvert would be requests, so they are left out."""
    nbconvert = pytest.importorskip("nbconvert")
    for program in ("node", os.environ.get("CHROMIUM", "chromium")):
        if not shutil.which(program):
            pytest.skip(f"no `{program}` here")
    others = {f"{name}_url": "" for name in ("jquery", "mathjax", "mermaid_js", "require_js")}
    page.write_text(nbconvert.HTMLExporter(**others).from_notebook_node(cells)[0])
    subprocess.run(["node", ROOT / "python/tests/notebook.mjs", page], check=True)


@pytest.mark.parametrize("notebook", sorted((DOCS / "notebooks").glob("*.ipynb")), ids=lambda path: path.stem)
def test_the_notebook(notebook, tmp_path):
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    cells = nbformat.read(notebook, as_version=4)
    nbformat.validate(cells)
    code = [cell for cell in cells.cells if cell.cell_type == "code"]
    assert not any(cell.outputs or cell.execution_count for cell in code), "a notebook has no stored outputs"
    nbclient.NotebookClient(cells, timeout=120, kernel_name="python3", resources={"metadata": {"path": notebook.parent}}).execute()
    if notebook.stem == "first-look":
        shown = [output.data["text/html"] for cell in code for output in cell.outputs if "text/html" in output.get("data", {})]
        assert len(shown) == 1 and "<iframe" in shown[0]
        opens(cells, tmp_path / "notebook.html")
