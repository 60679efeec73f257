"""The conda recipe has the version, the licence and the requirements of the project."""

import tomllib

import pytest

from .reading import ROOT, text

yaml = pytest.importorskip("yaml", reason="the recipe is YAML")
PROJECT = tomllib.loads(text("pyproject.toml"))
RECIPE = yaml.safe_load((ROOT / "conda" / "recipe.yaml").read_text(encoding="utf-8"))
NAMES = {"matplotlib": "matplotlib-base"}
"""Packages of another name on conda-forge."""


def in_conda(requirement):
    """A requirement of Python's packaging, as conda writes it."""
    name, bound = requirement.lower().split(">=")
    return f"{NAMES.get(name, name)} >={bound}"


def test_the_requirements_are_those_of_the_project():
    run = [line for line in RECIPE["requirements"]["run"] if not line.startswith("python ")]
    assert run == list(map(in_conda, PROJECT["project"]["dependencies"]))
    host = RECIPE["requirements"]["host"]
    assert set(map(in_conda, PROJECT["build-system"]["requires"])) <= set(host)


def test_the_metadata_are_those_of_the_project():
    project, about = PROJECT["project"], RECIPE["about"]
    assert RECIPE["context"]["version"] == project["version"]
    assert f">={RECIPE['context']['python_min']}" == project["requires-python"]
    assert (about["license"], about["summary"]) == (project["license"], project["description"])
    (script,) = project["scripts"].items()
    assert RECIPE["build"]["python"]["entry_points"] == [" = ".join(script)]
