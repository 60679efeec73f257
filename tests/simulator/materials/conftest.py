"""Scenes whose skins are changed in a few keys."""

import pytest

from simulator.scene import Scene


def with_keys(scene, keys):
    """The scene with further keys, by dotted path, validated anew."""
    tables = scene.model_dump(by_alias=True, exclude_none=True)
    for path, value in keys.items():
        *parents, last = path.split(".")
        table = tables
        for part in parents:
            table = table.setdefault(part, {})
        table[last] = value
    return Scene.model_validate(tables)


@pytest.fixture(scope="session")
def changed():
    """A function of a scene and of keys by dotted path."""
    return with_keys
