"""The page of public names explains each function, and each of its arguments."""

import inspect

import pytest
import rcskin
from rcskin.docs import api


def test_every_public_function_has_an_example():
    names = {name for name in rcskin.__all__ if inspect.isfunction(getattr(rcskin, name))}
    assert {*api.EXAMPLES} == names


@pytest.mark.parametrize("name", api.EXAMPLES)
def test_every_argument_and_error_is_explained(name):
    function = getattr(rcskin, name)
    names = list(inspect.signature(function).parameters)
    _, arguments, errors = api.parts(function, names)
    assert {*arguments} == {*names} and errors
