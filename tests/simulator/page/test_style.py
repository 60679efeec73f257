"""Contrast of the page's colours, as WCAG 2.2 asks it of text and of lines, light and dark."""

import re
import shutil
import subprocess

import pytest
from rcskin.simulator.page.document import SITE

TEXT, LINE = 4.5, 3.0


def schemes():
    style = (SITE / "style.css").read_text()
    blocks = [block for block in re.findall(r":root \{(.*?)\}", style, re.S)]
    light, dark = (dict(re.findall(r"--([a-z]+): (#[0-9a-f]{3,6})", block)) for block in blocks)
    return {"light": light, "dark": light | dark}


def luminance(colour):
    digits = colour[1:] if len(colour) == 7 else "".join(2 * each for each in colour[1:])
    parts = [int(digits[k : k + 2], 16) / 255 for k in (0, 2, 4)]
    r, g, b = (p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


def contrast(one, other):
    dark, light = sorted(map(luminance, (one, other)))
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_and_lines_stand_out(scheme):
    colours = schemes()[scheme]
    for text in ("ink", "soft", "now"):
        for ground in ("paper", "card"):
            assert contrast(colours[text], colours[ground]) >= TEXT, (text, ground)
    assert contrast(colours["ink"], colours["button"]) >= TEXT
    for line in ("now", "rest", "last", "mark", "top", "bottom"):
        assert contrast(colours[line], colours["card"]) >= LINE, line


@pytest.mark.parametrize("tool", [("tsc", "-p", "jsconfig.json"), ("biome", "check")])
def test_modules_are_typed_and_tidy(tool):
    if shutil.which(tool[0]) is None:
        pytest.skip(f"{tool[0]} is not installed")
    done = subprocess.run(tool, cwd=SITE, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
