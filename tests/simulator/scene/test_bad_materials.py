"""Keys of materials at the command line: what is wrong."""

import pytest
from rcskin.simulator.scene.scene_files import BUILTIN


@pytest.fixture
def scene_file(tmp_path):
    """The 3x3 sheet with further tables at its end."""

    def scene_file(*lines):
        path = tmp_path / "mine.toml"
        path.write_text("\n".join([(BUILTIN / "sheet-3x3.toml").read_text(), *lines, ""]))
        return path

    return scene_file


@pytest.mark.parametrize(
    ("lines", "told"),
    [
        (
            ["[skin.top.map]", 'kind = "wavy"'],
            "`skin.top.map` must be a table whose kind is one of constant, gradient, random, grid, "
            "tear, file, got 'wavy'",
        ),
        (
            ["[skin.foam.map]", 'kind = "constant"', "value = -1.0"],
            "`skin.foam.map` `value` must be from 1e-6 to 1e6 times the nominal value, got -1",
        ),
        (
            [
                "[skin.bottom.map]",
                'kind = "random"',
                "deviation = 0.2",
                "correlation_length = 1e-4",
            ],
            "`skin` `bottom.map` correlation_length must be >= 0.0024 m",
        ),
        (
            ["[skin.foam.map]", 'kind = "gradient"', "x = 1.0", "y = -1.5"],
            "`skin.foam.map` x and y must leave the factor > 0 at every corner: |x| + |y| < 2",
        ),
        (["[skin.stretch]", "x = 0.0"], "`skin.stretch.x` must be >= 0.1, got 0.0"),
        (
            ["[skin.shape]", 'kind = "torus"', "radius = 1.0"],
            "`skin.shape` must be a table whose kind is one of cylinder, sphere, got 'torus'",
        ),
        (
            ["[skin.shape]", 'kind = "sphere"', "radius = 0.02"],
            "`skin` `shape.radius` must be >= 0.03001 m",
        ),
        (
            ["[skin.shape]", 'kind = "cylinder"', "radius = 0.01"],
            "`skin` `shape.radius` must be >= 0.0191 m",
        ),
        (
            ["[skin.top.anisotropy]", "ratio = 0.0"],
            "`skin.top.anisotropy.ratio` must be >= 0.001, got 0.0",
        ),
        (["[leads]", "guard = 1.5"], "`leads.guard` must be <= 1.0, got 1.5"),
    ],
)
def test_bad_materials_are_named_with_key_value_and_range(
    refused, scene_file, tmp_path, lines, told
):
    path = scene_file(*lines)
    err = refused("sweep", path, "-o", tmp_path / "out.csv")
    assert err.startswith(f"rcskin: {path}: {told}")
