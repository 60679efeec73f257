"""A line of uniform segments: the product of their chain matrices, Z = M11/M21."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.models.line import Line
from rcskin.simulator.press.capacitance import capacitance_map
from rcskin.simulator.press.press import Press


def chain(s, R, C):
    """[[cosh q, Zc sinh q], [sinh q / Zc, cosh q]] with q² = s R C, Zc² = R / (s C)."""
    q, Zc = np.sqrt(s * R * C), np.sqrt(R / (s * C))
    return np.array([[np.cosh(q), Zc * np.sinh(q)], [np.sinh(q) / Zc, np.cosh(q)]])


@given(data=st.data(), edge=st.sampled_from(["left", "right", "bottom", "top"]))
def test_line_is_the_product_of_its_segments(make_scene, random, frequency_at, data, edge):
    across = edge in ("left", "right")
    count = data.draw(st.integers(1, 6))
    scene = make_scene(
        {f"top-{edge}": {}, f"bottom-{edge}": {}},
        **{"columns" if across else "rows": count},
        **{name: data.draw(random.logarithmic(1e2, 1e6)) for name in ("top", "bottom")},
    )
    press = data.draw(random.presses(scene))
    skin, frequency = scene.skin, frequency_at(scene, np.geomspace(1e-2, 1e3, 6))
    length, width = (skin.length, skin.width) if across else (skin.width, skin.length)
    R = (skin.top.sheet_resistance + skin.bottom.sheet_resistance) * length / width / count
    from_feed = capacitance_map(scene.parts.skin, press).ravel()[
        :: 1 if edge in ("left", "bottom") else -1
    ]
    expected = []
    for f in frequency:
        M = np.eye(2)
        for c in from_feed:
            M = M @ chain(2j * np.pi * f, R, c * length * width / count)
        expected.append(M[0, 0] / M[1, 0])
    np.testing.assert_allclose(
        Line(scene.parts.skin, scene.parts.setup).solve(press, frequency).Z[0],
        expected,
        rtol=1e-12,
    )


@given(data=st.data())
def test_a_uniform_line_may_be_cut_anywhere(make_scene, frequency_at, data):
    """Segments with the same c act as one."""
    frequency = frequency_at(make_scene(), np.geomspace(1e-6, 1e6, 13))
    scene = make_scene()
    whole = Line(scene.parts.skin, scene.parts.setup).solve(Press(), frequency).Z
    made = make_scene(columns=data.draw(st.integers(2, 50)))
    parts = (
        Line(
            made.parts.skin,
            made.parts.setup,
        )
        .solve(Press(), frequency)
        .Z
    )
    np.testing.assert_allclose(parts.view(float), whole.view(float), rtol=1e-12)
