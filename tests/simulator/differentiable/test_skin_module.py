"""The reduced skin in PyTorch: its readings and gradients are those of the model in numpy."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import rcskin
from rcskin.simulator.measure.skins import drawn_skin
from rcskin.simulator.models.parameters import TABLE, all_values
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.press.press import press_on
from rcskin.simulator.sweeps import InputError

torch = pytest.importorskip("torch", reason="PyTorch is not installed: pip install '.[torch]'")

FILMS = {"top-left": {"resistance": 200.0}, "bottom-left": {"resistance": 100.0}}
FLOATING = FILMS | {"top-right": {}, "bottom-bottom": {"resistance": 300.0}}
EARTH = {
    "skin.foam.capacitance_per_area": None,
    "skin.foam.thickness": 4e-3,
    "skin.foam.relative_permittivity": 2.2,
    "surroundings": {
        "low": "virtual earth",
        "body": {"distance": 5e-3},
        "cover": {"thickness": 1e-3, "relative_permittivity": 1.0},
        "rim": {"mutual": 5e-12, "top": 11e-12, "bottom": 6e-12},
    },
}
LEADS = {"resistance": 300.0, "inductance": 1e-3, "stray_capacitance": 3e-12}
GAIN = {
    "interface.1.reader": "gain",
    "interface.1.series_resistance": 1e5,
    "interface.1.load": {"resistance": 2e6, "capacitance": 8e-12},
    "leads": LEADS,
}
FREQUENCIES = (1e3, 1e4, 1e5)
MOVED = {
    "sheet_resistance": 0.2,
    "sheet_mismatch": -0.3,
    "capacitance": 0.1,
    "contact_resistance": 0.4,
    "loss_tangent": 0.03,
    "phase_exponent": 0.97,
    "leak": 20.0,
    "exponent_slope": 0.01,
    "lead_resistance": 50.0,
    "lead_inductance": 1e-4,
    "stray_capacitance": 4e-12,
    "body": 0.2,
    "rim": -0.3,
    "top_x": 0.1,
    "bottom_xy": -0.2,
    "series_resistance": 1.2e5,
    "load_capacitance": 1e-11,
    "load_conductance": 1e-6,
}


@cache
def forward_of(name, make_scene):
    """Model in numpy of a kind of scene."""
    grid = {"rows": 2, "columns": 2, "frequencies": FREQUENCIES}
    modes = 1
    if name == "one field":
        scene = make_scene(FILMS, **grid)
    elif name == "floating contacts, cosine modes":
        pairs = {
            "crossed": ("top-left", "bottom-bottom"),
            "along": ("top-left", "top-right"),
            "pair": (["top-left", "top-right"], "bottom-left"),
        }
        scene, modes = make_scene(FLOATING, pairs, **grid), 4
    elif name == "virtual earth, fingers":
        sheet = rcskin.load("sheet-5x5").with_({"pixels": 2, **EARTH})
        scene = sheet.with_({"sweep.frequencies": list(FREQUENCIES), "leads": LEADS})
    else:
        scene = make_scene(FILMS, **grid).with_(GAIN)
    return Forward(scene.parts, rtol=1e-2, modes=modes)


@pytest.fixture(
    scope="module",
    params=["one field", "floating contacts, cosine modes", "virtual earth, fingers", "gain"],
)
def forward(request, make_scene):
    return forward_of(request.param, make_scene)


@pytest.fixture(scope="module")
def module(forward):
    return rcskin.SkinModule(forward.reduced)


@pytest.fixture(scope="module")
def moved(forward):
    """Values that differ from the scene's, of all its parameters."""
    known = rcskin.SkinModule(forward.reduced)._tensors({}, 1, torch.zeros(1, dtype=torch.float64))
    return {name: MOVED[name] for name in known if name in MOVED}


def texts(forward):
    if forward._parts.fingers:
        return ["none", "2,1:1.6:3pF+1,2:1.3:rod", "1,1:touch"]
    return ["none", "1,2:1.5+2,2:2.2", "2,1:1.2"]


def cells(forward, text):
    return forward.cells(press_on(forward.parts.skin, forward.parts.plan.press, text))


def test_readings_equal_those_of_numpy(forward, module, moved):
    for given in ({}, moved):
        Z = module(module.rises(texts(forward)), given).detach().numpy()
        for own, text in zip(Z, texts(forward), strict=True):
            truth = forward.slopes(cells(forward, text), given).Z
            for part in (np.real, np.imag):
                np.testing.assert_allclose(part(own), part(truth), rtol=1e-10)


def test_impedances_are_those_of_the_public_model():
    """The kernel of numpy ends at a share of its tolerance, which is made small here."""
    reduced = rcskin.reduce("strip-1x3", 1e-3)
    module, exact = rcskin.SkinModule(reduced), replace(reduced, rtol=1e-10)
    f, presses = np.array([707.0, 2e3, 6367.0]), ["none", "1,2:2", "1,1:1.5+1,3:2.5"]
    Z = module(module.rises(presses), frequency=torch.tensor(f))
    shown = module.quantities(Z, torch.tensor(f))
    for k, press in enumerate(presses):
        truth = exact.solve(press, f, certify=False).Z
        np.testing.assert_allclose(shown["Rs"][k].numpy(), truth.real, rtol=1e-10)
        Cp = (1 / truth).imag / (2 * np.pi * f)
        np.testing.assert_allclose(shown["Cp"][k].numpy(), Cp, rtol=1e-10)


def test_gradients_are_the_slopes_of_numpy(forward, module, moved):
    text = texts(forward)[1]
    truth = forward.slopes(
        cells(forward, text), all_values(forward.parts.skin, forward.parts.setup, moved)
    )
    given = {n: torch.tensor(v, dtype=torch.float64, requires_grad=True) for n, v in moved.items()}
    rises = module.rises([text]).requires_grad_()
    Z, foam = module(rises, given)[0], forward._parts.foam
    for k in np.ndindex(*Z.shape):
        for part in (np.real, np.imag):
            own = Z[k].real if part is np.real else Z[k].imag
            found = torch.autograd.grad(own, [rises, *given.values()], retain_graph=True)
            np.testing.assert_allclose(
                found[0][0].numpy()[:foam],
                part(truth.by_rise[k])[:foam],
                rtol=1e-8,
                atol=1e-11 * np.abs(truth.by_cell[k]).max(),
            )
            for name, slope in zip(given, found[1:], strict=True):
                size = abs(truth.by_parameter[name][k])
                expected = part(truth.by_parameter[name][k])
                assert float(slope) == pytest.approx(expected, rel=1e-8, abs=1e-9 * size), name


def test_gradients_are_finite_differences(forward, module, moved):
    """By presses, parameters and frequencies together, one skin for each press."""
    names = [name for name in moved if name not in ("leak", "lead_inductance")]
    sizes = torch.tensor([max(abs(moved[name]), 1e-12) for name in names], dtype=torch.float64)

    def shown(rises, scaled, octaves):
        given = dict(zip(names, scaled * sizes[:, None], strict=True))
        f = torch.tensor(FREQUENCIES[:2], dtype=torch.float64) * 2**octaves
        return module(rises, given, f) / size

    scaled = torch.tensor([[moved[name]] * 2 for name in names], dtype=torch.float64)
    scaled = (scaled / sizes[:, None]).requires_grad_()
    rises = module.rises(texts(forward)[:2])[:, : forward._parts.foam].requires_grad_()
    size = float(module(rises, moved).detach().abs().mean())
    octaves = torch.zeros(2, dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(
        shown, (rises, scaled, octaves), eps=1e-5, atol=1e-6, rtol=1e-5, fast_mode=True
    )


def test_one_skin_of_its_own_for_each_press(make_scene):
    """A batch is the same presses one at a time, also with maps of foam and films."""
    forward = forward_of("floating contacts, cosine modes", make_scene)
    module, random = rcskin.SkinModule(forward.reduced), np.random.default_rng(0)
    presses, near = module.rises(["none", "1,1:2", "2,2:1.5"]), 0.2

    def drawn(*shape):
        return torch.tensor(random.uniform(-near, near, shape), requires_grad=True)

    given = {
        "sheet_resistance": drawn(3),
        "top_y": drawn(3),
        "capacitance": drawn(3, 4),
        "contact_resistance": drawn(3, len(FLOATING)),
    }
    together = module(presses, given)
    together.abs().sum().backward()
    for k in range(3):
        own = {name: value[k : k + 1].detach().requires_grad_() for name, value in given.items()}
        alone = module(presses[k : k + 1], own)
        alone.abs().sum().backward()
        torch.testing.assert_close(alone[0], together[k], rtol=1e-10, atol=0.0)
        for name, value in own.items():
            torch.testing.assert_close(value.grad[0], given[name].grad[k], rtol=1e-8, atol=1e-12)


def test_a_drawn_skin_is_the_one_of_the_data_set(make_scene):
    """Foam, films and sheets of a session, against the reduced model of the same skin."""
    scene = make_scene(FILMS, rows=2, columns=2, frequencies=FREQUENCIES)
    drawn = scene.with_({"dataset.session": {"contact_resistance": 1.5, "foam_spread": 0.05}})
    module = rcskin.SkinModule(forward_of("one field", make_scene).reduced)
    skin = drawn_skin(drawn.parts, 1, 0, (2, 2), 1).variation
    given = {
        "sheet_resistance": -np.log(skin.top[0] * skin.bottom[0]) / 2,
        "sheet_mismatch": np.log(skin.bottom[0] / skin.top[0]),
        "contact_resistance": torch.tensor(-np.log(skin.films))[None],
        "capacitance": torch.tensor(np.log(skin.capacitance.ravel()))[None],
        "loss_tangent": skin.loss.tangent,
    }
    rises = module.rises(["1,2:1.7"])
    own = module.reduced.at(skin)
    truth = own.solved(np.array([1]), np.array([0.7]), own.s)[0][1]
    inside = slice(2, -2)
    Z = module(rises, given, torch.tensor(own.reduced.frequency[inside]))
    torch.testing.assert_close(1 / Z[0, 0], torch.tensor(truth[inside]), rtol=1e-10, atol=0.0)
    assert module.error(rises, given)[0] < 0.05


def test_single_precision_follows_double(forward):
    double, single = (rcskin.SkinModule(forward.reduced) for _ in range(2))
    single = single.to(torch.float32)
    rises = double.rises(texts(forward))
    exact, rough = (each.quantities(each(rises)) for each in (double, single))
    for name, values in exact.items():
        assert rough[name].dtype == torch.float32
        torch.testing.assert_close(rough[name].double(), values, rtol=2e-4, atol=0.0)


def test_free_parameters_are_learned():
    """The sheet resistance of a skin follows from its readings by gradient steps."""
    module = rcskin.SkinModule("strip-1x3", ["sheet_resistance"], rtol=1e-2)
    rises = module.rises(["none", "1,2"])
    with torch.no_grad():
        seen = module(rises, {"sheet_resistance": 0.3})
    optimizer = torch.optim.LBFGS(module.parameters(), max_iter=10, line_search_fn="strong_wolfe")

    def loss():
        optimizer.zero_grad()
        off = (module(rises) / seen - 1).abs().square().mean()
        off.backward()
        return off

    optimizer.step(loss)
    assert module.values["sheet_resistance"].item() == pytest.approx(0.3, rel=1e-3)


def test_the_bound_of_the_error_is_the_certificate(make_scene):
    forward = forward_of("one field", make_scene)
    module = rcskin.SkinModule(forward.reduced)
    given = {"sheet_resistance": 0.2, "loss_tangent": 0.02}
    bound = module.error(module.rises(["1,2:1.5", "none"]), given)
    truth = [
        forward.slopes(cells(forward, text), given, certify=True).error
        for text in ("1,2:1.5", "none")
    ]
    np.testing.assert_allclose(bound, truth, rtol=1e-6)


def test_no_gradient_of_a_gradient():
    module = rcskin.SkinModule(rcskin.reduce("strip-1x3", 1e-2))
    rises = module.rises(["1,2"]).requires_grad_()
    (slope,) = torch.autograd.grad(module(rises).abs().sum(), rises, create_graph=True)
    with pytest.raises(RuntimeError, match="once_differentiable"):
        slope.sum().backward()


STRIP = "strip-1x3"
RELAXATION = [{"share": 0.2, "time_constant": 1.0}]
AROUND = EARTH["surroundings"] | {"thickness": True}
SCENES = {
    "driven together": ("knit-36", {}, "cannot take `interface.driven_with`"),
    "gauged": ("foam", {"skin.top.piezoresistance": 2.0}, "`skin.top.piezoresistance`"),
    "creeping": (
        "foam",
        {"skin.foam.relaxation": RELAXATION},
        "`skin.foam.relaxation`",
    ),
    "spread": ("foam", {}, "`press.depth`: give `press.capacitance_factor`"),
    "thickness": ("sheet-5x5", EARTH | {"surroundings": AROUND}, "`surroundings.thickness`"),
}
CALLS = {
    "name": (
        {"resistance": 1.0},
        "`parameter` must be one of leak, exponent_slope, sheet_resistance",
    ),
    "foam mode": ({"foam_x": 0.1}, "foam_x: has no gradient here; give `capacitance` with"),
    "sheet mode": ({"top_x": 0.1}, r"top_x: needs SkinModule\(..., modes=4\)"),
    "finger": ({"finger": 1e-12}, "finger: give fingers in F beside the rises"),
    "shape": ({"capacitance": [0.0, 0.1]}, r"must have shape \(\) or \(press,\) = \(1,\), or"),
    "reach": ({"sheet_resistance": 2.0}, "`frequency` times the factors .* must be in "),
    "mismatch": ({"sheet_mismatch": 2.0}, "`sheet_mismatch` must change by a factor of at most 3"),
    "not a number": ({"loss_tangent": float("nan")}, "`loss_tangent` must be finite, got nan"),
    "infinite": ({"lead_resistance": float("inf")}, "`lead_resistance` must be finite, got inf"),
    "no capacitance": (
        {"capacitance": [[0.0, 0.0, -float("inf")]]},
        "`capacitance` must be finite",
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_refused_scenes(name):
    scene, changes, message = SCENES[name]
    with pytest.raises(InputError, match=message) as refused:
        rcskin.SkinModule(rcskin.load(scene).with_(changes))
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("name", CALLS)
def test_refused_parameters(name):
    given, message = CALLS[name]
    module = rcskin.SkinModule(rcskin.reduce(STRIP, 1e-2))
    for function in (module, module.error):
        with pytest.raises(InputError, match=message):
            function(module.rises(["1,2"]), given)


def test_refused_types():
    with pytest.raises(InputError, match="`free` must be a list of texts, got 'capacitance'"):
        rcskin.SkinModule(STRIP, "capacitance")
    with pytest.raises(InputError, match="`scene` must be a Scene, a name or a path, got 3"):
        rcskin.SkinModule(3)  # pyright: ignore[reportArgumentType]


def test_refused_rises():
    module = rcskin.SkinModule(rcskin.reduce(STRIP, 1e-2))
    with pytest.raises(InputError, match=r"`rises` must have shape \(press, 3\), got \(1, 2\)"):
        module(torch.zeros(1, 2))
    for value in (-1.5, -1.0, -0.51, 2.01, 1e3, float("nan"), float("inf"), -float("inf")):
        rises = torch.tensor([[0.0, 0.0, 0.0], [0.5, value, 0.0]])
        for function in (module, module.error):
            with pytest.raises(
                InputError, match=r"`rises` of c must be in -0\.5\.\.2, as"
            ) as refused:
                function(rises)
            assert "\n" not in str(refused.value)
    at_ends = module(torch.tensor([[-0.5, 2.0, 0.0]]))
    assert torch.isfinite(torch.view_as_real(at_ends)).all()


def test_refused_fingers():
    scene = rcskin.load(STRIP).with_({"surroundings": {}})
    module = rcskin.SkinModule(rcskin.reduce(scene, 1e-2))
    rises = module.rises(["1,2"])
    for finger in (-1e-12, 1e-9, float("nan")):
        rises[0, -1] = finger
        with pytest.raises(InputError, match=r"fingers in `rises`, F, must be in 0\.\.1e-10"):
            module(rises)


def test_every_name_is_known_or_refused():
    module = rcskin.SkinModule(rcskin.reduce(STRIP, 1e-2))
    for name in TABLE:
        try:
            module(module.rises(["none"]), {name: 0.01})
        except InputError as error:
            assert "\n" not in str(error)
