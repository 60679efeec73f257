"""Skins from mesh files: elements, groups, cuts along pixels and touches, and what is refused."""

import re

import numpy as np
import pytest
import tomli_w
from rcskin.simulator.mesh.refinement import refined
from rcskin.simulator.mesh.skin_mesh import domain
from rcskin.simulator.press.pixels import pixels_with_skin
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.mesh_file import read_surface
from rcskin.simulator.scene.planar import sides
from rcskin.simulator.sweeps import InputError

REST = Press()
PRESS = parse_press(
    "rect(0.045,0.03,0.02,0.03)+disc(0.02,0.08,0.01)+poly(0.01,0,0.1,0,0.05,0.03)", 2
)
GROUPS = {"rows": 1, "columns": 2, "groups": [["foot", "arm"]]}


@pytest.fixture(scope="module", params=[2.2, 4.1])
def file(request, tmp_path_factory, tools):
    return tools.write_l(tmp_path_factory.mktemp("mesh") / "l.msh", version=request.param)


def pixel_areas(mesh, count):
    return np.bincount(mesh.pixel[mesh.pixel >= 0], mesh.areas[mesh.pixel >= 0], minlength=count)


def test_foils_and_pixels_are_named_groups(file, tools):
    mesh = domain(tools.on_mesh(file, pixels=GROUPS).parts.skin, REST, 1.0)
    assert pixel_areas(mesh, 2) == pytest.approx([0.12 * 0.05, 0.07 * 0.05], rel=1e-12)
    feed, far = (mesh.foils[name] for name in ("top-feed", "bottom-far"))
    assert tools.lengths(mesh, feed).sum() == pytest.approx(0.05, rel=1e-12)
    assert (mesh.p[1, feed] == pytest.approx(0.12)) and (mesh.p[0, far] == pytest.approx(0.12))
    assert tools.euler(mesh) == 1


def test_without_groups_pixels_are_the_grid(file, tools):
    scene = tools.on_mesh(file)
    mesh = domain(scene.parts.skin, REST, 1.0)
    assert mesh.areas.sum() == pytest.approx(tools.L_AREA, rel=1e-12)
    expected = [16e-4, 16e-4, 16e-4, 16e-4, 7e-4, 4e-4, 16e-4, 4e-4, 0]
    assert pixel_areas(mesh, 9) == pytest.approx(expected, rel=1e-7, abs=1e-15)
    assert len(pixels_with_skin(scene.parts.skin)) == 8 and (3, 3) not in pixels_with_skin(
        scene.parts.skin
    )
    assert tools.euler(mesh) == 1


def test_a_grid_smaller_than_the_mesh_leaves_the_rest_without_pixel(file, tools):
    scene = tools.on_mesh(file)
    small = scene.model_copy(update={"skin": scene.skin.model_copy(update={"length": 0.06})})
    mesh = domain(small.parts.skin, REST, 1.0)
    beyond = mesh.areas[mesh.pixel < 0].sum()
    assert beyond == pytest.approx(0.06 * 0.05, rel=1e-7)


def test_touches_are_cut_out(file, tools):
    mesh = domain(tools.on_mesh(file, pixels=GROUPS).parts.skin, PRESS, 1.0)
    found = [mesh.areas[covered].sum() for covered in mesh.covered]
    expected = [0.02 * 0.03, np.pi * 0.01**2, 0.09 * 0.03 / 2]
    assert found == pytest.approx(expected, rel=1e-7)
    assert pixel_areas(mesh, 2) == pytest.approx([0.12 * 0.05, 0.07 * 0.05], rel=1e-12)
    corners = np.array([(0.035, 0.015), (0.055, 0.015), (0.055, 0.045), (0.035, 0.045)])
    for side in sides(corners):
        whole = np.linalg.norm(side[1] - side[0])
        assert tools.length_along(mesh, side, 1e-8) == pytest.approx(whole, rel=1e-6)
    assert tools.euler(mesh) == 1
    assert tools.euler(refined(mesh, np.arange(0, mesh.t.shape[1], 3))) == 1


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("quadrilaterals", [False, True])
def test_elements_become_straight_triangles(tmp_path, tools, order, quadrilaterals):
    path = tools.write_l(tmp_path / "l.msh", order=order, quadrilaterals=quadrilaterals)
    mesh = domain(tools.on_mesh(path, pixels=GROUPS).parts.skin, REST, 1.0)
    assert mesh.areas.sum() == pytest.approx(tools.L_AREA, rel=1e-12)
    assert tools.lengths(mesh, mesh.foils["top-feed"]).sum() == pytest.approx(0.05, rel=1e-12)
    assert tools.euler(mesh) == 1


def test_groups_of_a_vtu_file_are_named_by_their_data(tmp_path, tools):
    import meshio

    read = meshio.read(tools.write_l(tmp_path / "l.msh", version=2.2))
    tag = {name: int(number) for name, (number, _) in read.field_data.items()}
    data = {"part": read.cell_data["gmsh:physical"]}
    meshio.Mesh(read.points, read.cells, cell_data=data).write(tmp_path / "l.vtu")
    groups = [[f"part={tag['foot']}", f"part={tag['arm']}"]]
    foils = [f"part={tag[name]}" for name in ("feed", "far")]
    scene = tools.on_mesh(tmp_path / "l.vtu", foils, pixels={**GROUPS, "groups": groups})
    mesh = domain(scene.parts.skin, REST, 1.0)
    assert pixel_areas(mesh, 2) == pytest.approx([0.12 * 0.05, 0.07 * 0.05], rel=1e-12)
    for lines in mesh.foils.values():
        assert tools.lengths(mesh, lines).sum() == pytest.approx(0.05, rel=1e-12)


def test_named_sets_of_elements_are_groups(tmp_path, tools):
    import meshio

    points = [(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)]
    cells = [("triangle", [[0, 1, 2], [0, 2, 3]]), ("line", [[3, 0], [1, 2]])]
    sets = {"lower": [[0], []], "upper": [[1], []], "feed": [[], [0]], "far": [[], [1]]}
    sets = {name: [np.array(part, int) for part in parts] for name, parts in sets.items()}
    meshio.Mesh(np.array(points, float), cells, cell_sets=sets).write(tmp_path / "square.inp")
    grouped = {"rows": 1, "columns": 2, "groups": [["lower", "upper"]]}
    mesh = domain(tools.on_mesh(tmp_path / "square.inp", pixels=grouped).parts.skin, REST, 1.0)
    assert pixel_areas(mesh, 2) == pytest.approx([0.005, 0.005])


def curved(tools, path, lift):
    """The L's file with heights over (x, y)."""
    import meshio

    read = meshio.read(tools.write_l(path.with_suffix(".msh"), version=2.2))
    read.points[:, 2] = lift(*read.points[:, :2].T)
    meshio.Mesh(read.points, read.cells, cell_data={"part": read.cell_data["gmsh:physical"]}).write(
        path
    )
    return [f"part={int(read.field_data[name][0])}" for name in ("feed", "far")]


def test_surfaces_in_space_are_cut_along_z(tmp_path, tools):
    foils = curved(tools, tmp_path / "l.vtu", lambda x, y: 0.5 * x)
    mesh = domain(tools.on_mesh(tmp_path / "l.vtu", foils).parts.skin, PRESS, 1.0)
    assert mesh.p.shape[0] == 3
    slope = np.hypot(1, 0.5)
    assert mesh.areas.sum() == pytest.approx(tools.L_AREA * slope, rel=1e-12)
    found = [mesh.areas[covered].sum() for covered in mesh.covered]
    expected = [0.02 * 0.03, np.pi * 0.01**2, 0.09 * 0.03 / 2]
    assert found == pytest.approx(np.multiply(expected, slope), rel=1e-7)
    assert tools.euler(mesh) == 1


def test_a_raised_plane_is_flat(tmp_path, tools):
    foils = curved(tools, tmp_path / "l.vtu", lambda x, y: 0.3 + 0 * x)
    assert domain(tools.on_mesh(tmp_path / "l.vtu", foils).parts.skin, REST, 1.0).p.shape[0] == 2


@pytest.mark.parametrize(("press", "least"), [("none", 1.0), ("disc(0.021,0.0227,0.0113)", 1.0)])
def test_cuts_of_flat_meshes_leave_no_slivers(file, tools, press, least):
    mesh = domain(tools.on_mesh(file).parts.skin, parse_press(press, 2.0), 1.0)
    assert tools.least_angle(mesh) > least


def test_cuts_are_the_same_each_time(file, tools):
    first, second = (domain(tools.on_mesh(file).parts.skin, PRESS, 1.0) for _ in range(2))
    assert np.array_equal(first.p, second.p) and np.array_equal(first.t, second.t)


def write(path, points, triangles, lines=((1, 2),)):
    import meshio

    data = {"part": [np.zeros(len(triangles), int), np.ones(len(lines), int)]}
    cells = [("triangle", np.array(triangles)), ("line", np.array(lines))]
    meshio.Mesh(np.array(points, float) / 10, cells, cell_data=data).write(path)
    return path


SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


@pytest.mark.parametrize(
    ("points", "triangles", "message"),
    [
        ([*SQUARE, (2, 0)], [(0, 1, 2), (0, 2, 3), (0, 1, 4)], "must have an area, got 1 without"),
        (
            [*SQUARE, (0.5, 0), (0.5, -1)],
            [(0, 1, 2), (0, 2, 3), (0, 4, 5), (4, 1, 5)],
            "must meet edge to edge, which they do not near (0.05, 0) m",
        ),
        (
            [*SQUARE, (0, 0), (1, 1)],
            [(0, 1, 2), (4, 5, 3)],
            "must meet edge to edge",
        ),
        (
            [*SQUARE, (0.5, -1), (0.6, -1)],
            [(0, 1, 2), (0, 2, 3), (0, 1, 4), (0, 1, 5)],
            "must meet in pairs, got 3 at one edge",
        ),
        ([*SQUARE, (0.5, 2)], [(0, 1, 2), (0, 1, 4)], "must not overlap, got two that do near"),
        (
            [*SQUARE, (3, 0), (4, 0), (3, 1)],
            [(0, 1, 2), (0, 2, 3), (4, 5, 6)],
            "must be connected by edges, got 2 separate parts",
        ),
        ([(0, 0), (1, 0), (np.nan, 1)], [(0, 1, 2)], "must have finite coordinates"),
    ],
)
def test_meshes_that_cannot_be_computed_on_are_refused(tmp_path, tools, points, triangles, message):
    path = write(tmp_path / "bad.vtu", points, triangles)
    with pytest.raises(InputError) as refused:
        domain(tools.on_mesh(path, ["part=1", "part=1"]).parts.skin, REST, 1.0)
    assert str(refused.value).startswith(f"{path.name}: the triangles of `skin.mesh` must ")
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


def test_missing_groups_are_reported_with_the_known_ones(file, tools):
    with pytest.raises(
        ValueError, match=r"'nowhere' must be a group of boundary lines of .*'feed'"
    ):
        tools.on_mesh(file, ["nowhere", "far"])
    with pytest.raises(ValueError, match=r"'seam' must be .* some of its lines are not edges of"):
        tools.on_mesh(file, ["seam", "far"])
    scene = tools.on_mesh(file, pixels={**GROUPS, "groups": [["foot", "leg"]]})
    with pytest.raises(InputError, match=r"`pixels.groups` names 'leg', .*'foot', 'arm'"):
        domain(scene.parts.skin, REST, 1.0)
    scene = tools.on_mesh(file, pixels={**GROUPS, "groups": [["foot", "foot"]]})
    with pytest.raises(InputError, match="group 'foot' shares triangles with another"):
        domain(scene.parts.skin, REST, 1.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({'edge = "feed"': 'edge = "left"'}, "contact edge 'left' must be a group of boundary"),
        (
            {"span = [\n    0.0,": "span = [\n    0.1,"},
            "`contact[1].span` must be [0, 1] on a mesh",
        ),
        ({"l.msh": "none.msh"}, "none.msh: no such file, needed as `skin.mesh`"),
        ({"l.msh": "l.toml"}, "l.toml: must end in .msh, .vtk, .vtu, .inp, got '.toml'"),
    ],
)
def test_the_command_line_reports_in_one_line(tmp_path, tools, refused, change, message):
    path = tools.write_l(tmp_path / "l.msh")
    tables = tools.on_mesh(path).model_dump(by_alias=True, exclude_none=True)
    tables["skin"]["mesh"] = path.name
    text = tomli_w.dumps(tables)
    for old, new in change.items():
        assert old in text
        text = text.replace(old, new, 1)
    (tmp_path / "l.toml").write_text(text, encoding="utf-8")
    assert message in refused("sweep", tmp_path / "l.toml", "-o", tmp_path / "out.csv")


GMSH = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n{} 0 0 0\n$EndNodes\n"
VTK = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET {}\n"
NODES = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n"


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("it.inp", f"{NODES}*ELSET, ELSET=a, GENERATE\n1, 2000000000, 1\n", "2000000000; nodes"),
        ("it.msh", GMSH.format(3000000000), "has the number 3000000000; nodes and elements"),
        ("it.msh", GMSH.format("9" * 5000), "has the number 99999999999999999999; nodes"),
        ("it.vtk", VTK.format("UNSTRUCTURED_GRID\nPOINTS 4000000000 double"), "4000000000; nodes"),
        *(
            ("it.vtk", VTK.format(f"{kind}\n{start}DIMENSIONS 30000 30000 1"), "GiB of numbers")
            for kind in ("STRUCTURED_POINTS", "STRUCTURED_GRID", "RECTILINEAR_GRID")
            for start in ("", " ")
        ),
    ],
)
def test_no_mesh_reserves_memory_by_its_numbers(tmp_path, monkeypatch, name, content, message):
    """Each is refused before meshio sees it."""
    monkeypatch.setattr("meshio.read", None)
    path = tmp_path / name
    path.write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match=re.escape(message)):
        read_surface(str(path))
