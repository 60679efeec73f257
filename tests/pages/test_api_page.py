"""Each public name has a page, with all arguments explained and an example that runs."""

import inspect

import pytest
import rcskin
from rcskin.docs import api


def test_every_public_function_has_an_example():
    names = {name for name in rcskin.__all__ if inspect.isfunction(getattr(rcskin, name))}
    assert {*api.EXAMPLES} == names


def test_each_name_is_in_one_group_and_has_one_page():
    names = [name for group in api.GROUPS.values() for name in group]
    public = {*rcskin.__all__} - {"__version__"}
    assert len(names) == len({*names}) and public <= {*names} == {*api.EXAMPLES, *api.CLASSES}
    paths = [path for group in api.paths().values() for path in group]
    assert {*api.pages()} == {*paths, "api.md"} and len({path.lower() for path in paths}) == len(
        names
    )


@pytest.mark.parametrize("name", api.EXAMPLES)
def test_each_example_is_a_program(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(api.example(name), name, "exec"), {})


@pytest.mark.parametrize("name", api.EXAMPLES)
def test_every_argument_and_error_is_explained(name):
    function = getattr(rcskin, name)
    names = list(inspect.signature(function).parameters)
    _, arguments, errors = api.parts(function, names)
    assert {*arguments} == {*names} and errors
