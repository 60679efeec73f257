"""Pages of the site at four widths, light and dark: nothing is cut off, missing or too faint."""

import pytest

WIDTHS = (360, 800, 1280, 1500)
SHOWN = (
    "index.html",
    "docs/index.html",
    "docs/tutorials/first-steps.html",
    "docs/how-to/describe-the-foam.html",
    "docs/explanation/accuracy-and-speed.html",
    "install.html",
    "docs/reference/api.html",
    "docs/reference/api/class-sensor.html",
    "docs/reference/commands.html",
    "docs/reference/keys.html",
    "docs/reference/benchmarks.html",
    "docs/gallery.html",
    "docs/tutorials/python.html",
    "docs/notebooks/trust-a-localizer.html",
    "benchmarks/results/verification.html",
    "CHANGELOG.html",
)
"""Pages of each kind."""
OVERFLOW = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
CUT_OFF = """() => [...document.querySelectorAll("table, pre")].filter((each) => {
    const right = (element) => element.getBoundingClientRect().right;
    let around = each;
    while (around && !["auto", "scroll"].includes(getComputedStyle(around).overflowX))
        around = around.parentElement;
    return right(each) > innerWidth && !around;
}).length"""
BROKEN = r"""() => {
    const words = document.createTreeWalker(
        document.querySelector(".md-content"), NodeFilter.SHOW_TEXT);
    const broken = new Set(), range = document.createRange();
    for (let node = words.nextNode(); node; node = words.nextNode()) {
        if (!node.parentElement.closest("table")) continue;
        for (const word of node.data.matchAll(/[\w.]+/g)) {
            range.setStart(node, word.index);
            range.setEnd(node, word.index + word[0].length);
            if (new Set([...range.getClientRects()].map((each) => each.top)).size > 1)
                broken.add(word[0]);
        }
    }
    return [...broken];
}"""
UNLOADED = """() => [...document.images].filter((each) => !each.complete || !each.naturalWidth)
    .map((each) => each.src)"""
FAINT = """(least) => {
    const context = document.createElement("canvas").getContext("2d", {willReadFrequently: true});
    const rgba = (colour) => {
        context.clearRect(0, 0, 1, 1);
        context.fillStyle = colour;
        context.fillRect(0, 0, 1, 1);
        const [r, g, b, a] = context.getImageData(0, 0, 1, 1).data;
        return [r, g, b, a / 255];
    };
    const over = (top, below) => below.map((value, k) =>
        k < 3 ? top[k] * top[3] + value * (1 - top[3]) : 1);
    const behind = (element) => {
        const layers = [];
        for (let each = element; each; each = each.parentElement)
            layers.push(rgba(getComputedStyle(each).backgroundColor));
        return layers.reverse().reduce((below, top) => over(top, below), [255, 255, 255, 1]);
    };
    const luminance = (colour) => [0.2126, 0.7152, 0.0722].reduce((sum, weight, k) => {
        const value = colour[k] / 255;
        return sum + weight * (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
    }, 0);
    const content = document.querySelector(".md-content");
    const words = document.createTreeWalker(content, NodeFilter.SHOW_TEXT);
    const faint = new Set();
    for (let node = words.nextNode(); node; node = words.nextNode()) {
        const element = node.parentElement;
        const text = node.data.trim();
        if (!text || !element.checkVisibility() || element.closest("iframe, .headerlink, svg"))
            continue;
        const below = behind(element);
        const shown = over(rgba(getComputedStyle(element).color), below);
        const [dark, light] = [luminance(shown), luminance(below)].sort((a, b) => a - b);
        const ratio = (light + 0.05) / (dark + 0.05);
        if (ratio < least)
            faint.add(`${element.tagName}.${element.className} ${ratio.toFixed(2)} ${text}`);
    }
    return [...faint];
}"""
CONTRAST = 4.5
"""Least ratio of luminances by WCAG 2, level AA."""


@pytest.mark.parametrize("path", SHOWN)
def test_nothing_is_wider_than_the_page_and_every_picture_is_there(served, open_page, path):
    page = open_page(served, path)
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 900})
        assert page.evaluate(OVERFLOW) <= 0, width
        assert page.evaluate(CUT_OFF) == 0, width
        assert page.evaluate(BROKEN) == [], width
    assert page.evaluate(UNLOADED) == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("path", ["index.html", "docs/reference/api/sweep.html"])
def test_text_differs_from_what_is_behind_it(served, open_page, path, scheme):
    page = open_page(served, path, color_scheme=scheme)
    shown = {"light": "default", "dark": "slate"}[scheme]
    assert page.locator("body").get_attribute("data-md-color-scheme") == shown
    assert page.evaluate(FAINT, CONTRAST) == []
