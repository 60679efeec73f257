"""Every formula of the page of formulas is quoted, word for word, by a test of this folder."""

import ast
import re
from pathlib import Path

HERE = Path(__file__).parent
PAGE = HERE.parents[3] / "docs" / "reference" / "formulas.md"


def formulas():
    """The lines of the page's blocks, without what is said of them after three spaces."""
    blocks = re.findall(r"^```\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.M)
    return [re.split(r" {3,}", line)[0] for block in blocks for line in block.splitlines()]


def quoted():
    """The lines of all docstrings of tests."""
    lines = []
    for path in HERE.glob("test_*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
                lines += (ast.get_docstring(node) or "").splitlines()
    return {line.strip() for line in lines}


def test_every_formula_of_the_page_is_tested():
    assert len(formulas()) > 50
    known = quoted()
    assert [line for line in formulas() if line not in known] == []
