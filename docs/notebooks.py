"""Notebooks: pages in `docs/notebooks`, of which each block of Python is a cell.

The site runs every cell and shows its outputs below it. A cell that raises an error, warns, or
writes to the standard error stream ends the build. Each page offers its notebook as a file
without outputs. Outside the site, the pages are plain Markdown, so that a change is easy to review.
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from html import escape
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

PAGES = sorted((Path(__file__).parent / "notebooks").glob("*.md"))
CELL = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)
LINK = re.compile(r"\[([^\]]+)\]\((?!http)[^)]+\)")
OF_WHOLE_PAGE = re.compile(r"<(style|metadata).*?</\1>", re.DOTALL)
"""Parts of a drawing that would change the page around it, or that nobody reads."""
INK = "#808182"
"""Colour of text and axes in figures, which the page replaces by that of its own text."""
BEFORE = f"""
import warnings
import matplotlib
%matplotlib inline
%config InlineBackend.figure_formats = ["svg"]
%config InlineBackend.print_figure_kwargs = {{"metadata": {{"Date": None, "Creator": None}}}}
matplotlib.rcParams.update({{
    **dict.fromkeys(("text.color", "axes.labelcolor", "axes.edgecolor"), "{INK}"),
    **dict.fromkeys(("xtick.color", "ytick.color", "grid.color"), "{INK}"),
    "figure.facecolor": "none", "axes.facecolor": "none", "grid.alpha": 0.4,
    "legend.framealpha": 0, "savefig.bbox": "tight", "svg.hashsalt": "rcskin",
}})
warnings.simplefilter("error")
"""
AFTER = "import time; warnings.simplefilter('ignore'); print(time.process_time())"


def notebook(text: str) -> NotebookNode:
    """The notebook of a page: blocks of Python are cells of code, and the text between is text."""
    parts = CELL.split(text)
    cells = [
        (new_code_cell if place % 2 else new_markdown_cell)(part.strip(), id=f"cell-{place}")
        for place, part in enumerate(parts)
        if part.strip()
    ]
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return new_notebook(cells=cells, metadata={"kernelspec": kernel})


def write(folder: Path) -> None:
    """Run all notebooks at once. Write each as a page with its outputs, and as a file."""
    with ProcessPoolExecutor(len(PAGES)) as processes:
        for _ in processes.map(partial(_write, folder), PAGES):
            pass


def _write(folder: Path, page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    done, seconds = run(notebook(text), page.name)
    (folder / page.name).write_text(shown(done, page.stem, seconds), encoding="utf-8")
    nbformat.write(_without_links(notebook(text)), folder / f"{page.stem}.ipynb")


def run(given: NotebookNode, name: str) -> tuple[NotebookNode, float]:
    """The notebook with its outputs, and the processor time that it took in seconds.

    Exits with the error and the cell if a cell raises an error, warns or writes to stderr.
    """
    given.cells = [new_code_cell(BEFORE), *given.cells, new_code_cell(AFTER)]
    with tempfile.TemporaryDirectory() as scratch:
        place = {"metadata": {"path": scratch}}
        client = NotebookClient(given, timeout=600, startup_timeout=300, resources=place)
        if os.name == "posix":  # sockets that only this user can open
            manager = client.create_kernel_manager()
            manager.transport, manager.ip = "ipc", f"{scratch}/kernel"
        try:
            client.execute()
        except CellExecutionError as error:
            sys.exit(f"{name}: {error}")
    _, *given.cells, last = given.cells
    for cell in given.cells:
        for output in cell.get("outputs", ()):
            if output.output_type == "error" or output.get("name") == "stderr":
                sys.exit(f"{name}: this cell fails:\n{cell.source}\n{_plain(output)}")
    return given, float(last.outputs[0].text)


def shown(done: NotebookNode, name: str, seconds: float) -> str:
    """The page of a notebook that was run, in Markdown with outputs as HTML."""
    title, _, rest = done.cells[0].source.partition("\n")
    offer = (
        f"[Download this notebook]({name}.ipynb). The outputs are those of the cells, run when "
        f"this page was made. All cells together took {seconds:.0f} s of processor time."
    )
    done.cells[0].source = f"{title}\n\n{offer}\n{rest}"
    return "\n\n".join(part for cell in done.cells for part in _parts(cell)) + "\n"


def _parts(cell: NotebookNode) -> Iterator[str]:
    """Text or code of a cell, and its outputs. Beside figures, the value of a cell is left out:
    it is a part of the figure.
    """
    if cell.cell_type == "markdown":
        yield cell.source
        return
    yield f"```python\n{cell.source}\n```"
    outputs = cell.outputs
    if any("image/svg+xml" in output.get("data", ()) for output in outputs):
        outputs = [each for each in outputs if each.output_type != "execute_result"]
    if outputs:
        yield '<div class="output">\n{}\n</div>'.format("\n".join(map(_html, outputs)))


def _html(output: NotebookNode) -> str:
    """An output as HTML: what the object shows itself as, a figure, or text."""
    data = {"text/plain": output.text} if output.output_type == "stream" else output.data
    if "image/svg+xml" in data:
        drawing = data["image/svg+xml"]
        drawing = OF_WHOLE_PAGE.sub("", drawing[drawing.index("<svg") :])
        return drawing.replace(INK, "currentColor")
    return data.get("text/html") or f"<pre>{escape(data['text/plain'].rstrip())}</pre>"


def _plain(output: NotebookNode) -> str:
    """The text of a failure."""
    return output.get("text") or re.sub(r"\x1b\[[\d;]*m", "", "\n".join(output.traceback))


def _without_links(given: NotebookNode) -> NotebookNode:
    """The notebook without links to pages, which do not lie beside the file."""
    for cell in given.cells:
        if cell.cell_type == "markdown":
            cell.source = LINK.sub(r"\1", cell.source)
    return given


if __name__ == "__main__":
    write(Path(sys.argv[1]))
