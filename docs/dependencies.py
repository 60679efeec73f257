"""Write the page of dependencies: reasons, licences, last releases, and wheels for each system.

Run: python docs/dependencies.py INDEX
     python docs/dependencies.py --installed [TESTS...]
INDEX is the address of a package index that answers in JSON. Reasons come from `dependencies.toml`,
licences from the packages that are installed, tested versions from `lowest.toml`, and everything
else from the index. `.ci/lowest` writes `lowest.toml` by the second form.
"""

from __future__ import annotations

import json
import platform
import re
import subprocess
import sys
import tomllib
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any, NamedTuple
from urllib.request import Request, urlopen

from packaging.requirements import Requirement
from packaging.tags import Tag
from packaging.utils import (
    InvalidSdistFilename,
    InvalidWheelFilename,
    canonicalize_name,
    parse_sdist_filename,
    parse_wheel_filename,
)
from packaging.version import Version

HERE = Path(__file__).parent
PAGE = HERE / "reference" / "dependencies.md"
LOWEST = HERE / "lowest.toml"
"""What was installed when the tests passed with the lowest versions."""
PYTHONS = (11, 12, 13, 14)
"""Minor versions of Python 3 that are supported."""
SYSTEMS = {
    "Linux x86-64": r"(many)?linux.*x86_64",
    "Linux ARM": r"(many)?linux.*aarch64",
    "Windows x86-64": "win_amd64",
    "macOS ARM": "macosx.*(arm64|universal2)",
    "macOS x86-64": "macosx.*(x86_64|universal2|intel)",
}
"""Systems, and the platform tags of wheels that run there."""
JSON = "application/vnd.pypi.simple.v1+json"


class Release(NamedTuple):
    """One release of a package: its version, day and the tags of its wheels."""

    version: Version
    day: str
    tags: frozenset[Tag]

    def runs_on(self, python: int, platform: str) -> bool:
        """True if a wheel is there for Python 3.`python` on a platform."""
        return any(_fits(tag, python, platform) for tag in self.tags)


def _fits(tag: Tag, python: int, platform: str) -> bool:
    if tag.platform != "any" and not re.fullmatch(platform, tag.platform):
        return False
    if tag.abi == "abi3":
        return int(tag.interpreter.removeprefix("cp3") or 0) <= python
    return tag.interpreter in (f"cp3{python}", "py3", f"py3{python}")


def releases_of(index: str, name: str) -> list[Release]:
    """Releases of a package on an index, the newest first, without pre-releases."""
    address = f"{index.rstrip('/')}/{canonicalize_name(name)}/"
    with urlopen(Request(address, headers={"Accept": JSON}), timeout=60) as answer:
        listed = json.loads(answer.read())
    files = defaultdict[Version, dict[str, str]](dict)
    for file in listed["files"]:
        version = _version(file["filename"])
        if version and not version.is_prerelease and not file.get("yanked"):
            files[version][file["filename"]] = file["upload-time"][:10]
    return [_release(version, files[version]) for version in sorted(files, reverse=True)]


def _release(version: Version, days: dict[str, str]) -> Release:
    """Release from the days of its files by their names."""
    wheels = [file for file in days if file.endswith(".whl")]
    tags = frozenset(tag for file in wheels for tag in parse_wheel_filename(file)[3])
    return Release(version, min(days.values()), tags)


def licence_of(name: str) -> str:
    """Licence of an installed package, by the shortest field that states one."""
    metadata = distribution(name).metadata
    classified = [
        text.rsplit(" :: ", 1)[-1]
        for text in metadata.get_all("Classifier") or []
        if text.startswith("License ::") and text.count("::") > 1
    ]
    stated = metadata.get("License-Expression"), *classified, metadata.get("License")
    return next(line.splitlines()[0] for line in (*stated, _licence_file(name)) if line)


def _licence_file(name: str) -> str:
    files = (file for file in distribution(name).files or [] if file.name.startswith("LICEN"))
    return next((file.read_text() for file in files), "not stated")


def _version(file: str) -> Version | None:
    try:
        if file.endswith(".whl"):
            return parse_wheel_filename(file)[1]
        return parse_sdist_filename(file)[1]
    except (InvalidWheelFilename, InvalidSdistFilename):
        return None


def requirements() -> dict[str, list[Requirement]]:
    """Direct dependencies by the name of their extra, an empty one for those of every user."""
    project: dict[str, Any] = tomllib.loads((HERE.parent / "pyproject.toml").read_text())["project"]
    groups = {"": project["dependencies"], **project["optional-dependencies"]}
    found = {extra: list(map(Requirement, texts)) for extra, texts in groups.items()}
    return {extra: [r for r in own if r.name != "rcskin"] for extra, own in found.items()}


def reasons() -> dict[str, list[str]]:
    """Reason of each direct dependency, and who would miss it."""
    return tomllib.loads((HERE / "dependencies.toml").read_text(encoding="utf-8"))


def tested() -> dict[str, Any]:
    """Python, commit, tests and versions of the last run of `.ci/lowest`."""
    return tomllib.loads(LOWEST.read_text(encoding="utf-8"))


def installed(tests: Sequence[str]) -> str:
    """What is installed here, in TOML, after these tests passed."""
    commit = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"],
        cwd=HERE,
        capture_output=True,
        text=True,
        check=True,
    )
    run = {"python": platform.python_version(), "commit": commit.stdout.strip()}
    lines = [f'{key} = "{value}"' for key, value in run.items()]
    lines += [f"tests = {json.dumps(list(tests))}", "", "[versions]"]
    names = sorted({r.name for own in requirements().values() for r in own})
    return "\n".join([*lines, *filter(None, map(_version_line, names)), ""])


def _version_line(name: str) -> str:
    try:
        return f'{name} = "{distribution(name).version}"'
    except PackageNotFoundError:
        return ""


def page(releases: dict[str, list[Release]]) -> str:
    """The whole page, in Markdown."""
    last = tested()
    tests = ", ".join(f"`{each}`" for each in last["tests"]) or "All quick tests"
    run = RUN.format(**{**last, "tests": tests})
    table = _table(releases, last["versions"])
    return "\n".join([HEAD, run, *table, "", WHEELS, *_missing_wheels(releases), ""])


def _table(releases: dict[str, list[Release]], versions: dict[str, str]) -> Iterator[str]:
    head = "package", "from", "tested", "extra", "reason", "who would miss it", "licence"
    yield f"| {' | '.join([*head, 'last release'])} |"
    yield f"|{' --- |' * (len(head) + 1)}"
    shown = set()
    for extra, own in requirements().items():
        for requirement in own:
            if requirement.name in shown:
                continue
            shown.add(requirement.name)
            last = releases[requirement.name][0]
            yield _row(requirement, versions.get(requirement.name, ""), extra, last)


def _row(requirement: Requirement, version: str, extra: str, release: Release) -> str:
    name, lowest = requirement.name, str(requirement.specifier).removeprefix(">=")
    last = f"{release.version}, {release.day}"
    cells = f"`{name}`", lowest, version, extra, *reasons()[name], licence_of(name), last
    return f"| {' | '.join(cells)} |"


def _missing_wheels(releases: dict[str, list[Release]]) -> Iterator[str]:
    yield "| package | system | Python | newest release with a wheel |"
    yield "| --- | --- | --- | --- |"
    allowed = {each.name: each.specifier for own in requirements().values() for each in own}
    for name, own in sorted(releases.items()):
        known = [each for each in own if each.version in allowed[name]]
        for python in PYTHONS:
            older = [_newest_with_wheel(known, python, platform) for platform in SYSTEMS.values()]
            for version in dict.fromkeys(older):
                where = [s for s, v in zip(SYSTEMS, older, strict=True) if v == version]
                if version != str(own[0].version):
                    systems = "all" if len(where) == len(SYSTEMS) else ", ".join(where)
                    yield f"| `{name}` | {systems} | 3.{python} | {version} |"


def _newest_with_wheel(releases: list[Release], python: int, platform: str) -> str:
    fitting = (str(each.version) for each in releases if each.runs_on(python, platform))
    return next(fitting, "none")


HEAD = """# Dependencies

`python docs/dependencies.py INDEX` writes this page from a package index, the installed packages
and the reasons in `docs/dependencies.toml`. The column "from" is the lowest version allowed, the
column "tested" the version that the tests below ran with, empty if it was not installed.
"""
RUN = """`.ci/lowest` installs the lowest version of each package that can be had, and runs tests.
With Python {python}, at commit {commit}, these passed: {tests}.
"""
WHEELS = """## Where the newest release has no wheel

On all other systems and versions of Python from 3.11 to 3.14, the newest release of each package
has a wheel. pip takes an older release by itself if the newest excludes the version of Python.
Otherwise it compiles; `pip install --prefer-binary` takes the release of the table. Where the
table says "none", no release that rcskin allows has a wheel: take Python 3.13 for numba and
onnxruntime, and do without the extra torch.
"""


def main(index: str) -> None:
    """Write the page by an index."""
    names: Iterable[str] = {r.name for own in requirements().values() for r in own}
    releases = {name: releases_of(index, name) for name in sorted(names)}
    PAGE.write_text(page(releases), encoding="utf-8")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--installed"]:
        print(installed(sys.argv[2:]), end="")
    elif len(sys.argv) == 2:
        main(sys.argv[1])
    else:
        sys.exit(__doc__)
