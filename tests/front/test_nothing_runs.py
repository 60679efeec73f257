"""A file that a stranger sent runs nothing: every reader of files gets every kind of file."""

import io
import json
import os
import pickle
import re
import subprocess
import sys
import warnings
import zipfile
from pathlib import Path
from types import SimpleNamespace

import netCDF4
import numpy as np
import pytest
import rcskin
from PIL import Image
from rcskin.hardware.reader.line_format import read_line_format
from rcskin.hardware.record.operators import read_order
from rcskin.hardware.switch.boards import read_switch
from rcskin.hardware.virtual.serving import read_script
from rcskin.localization.inputs.baselines import read_first
from rcskin.localization.model import localizer_file
from rcskin.localization.study.axis import scene_table
from rcskin.simulator.meters import accuracy_table
from rcskin.simulator.models.reduced import model_file
from rcskin.simulator.scene.mesh_file import read_surface
from rcskin.simulator.scene.scene_files import BUILTIN, load_scene
from rcskin.simulator.surroundings import array_cache
from rcskin.simulator.sweeps import InputError, inputs, read
from rcskin.simulator.sweeps.digests import unsealed_json
from rcskin.simulator.sweeps.imports import import_file

TABLES = ".csv .txt .dta .mpt .z .s1p .s2p .S2P .xlsx .xlsm .mat .h5 .pkl .pssession .npz".split()
RUNS = {"pickle.find_class", "os.system", "os.exec", "os.posix_spawn", "os.spawn", "os.startfile"}
RUNS |= {"subprocess.Popen", "exec"}
"""Events by which the interpreter runs something; modules that are imported run as well."""


def map_of_scene(path):
    range_of = "" if path.suffix == ".csv" else "low = 0.5\nhigh = 2.0\n"
    table = f"[skin.top.map]\nkind = 'file'\npath = '{path.name}'\n{range_of}"
    scene = path.parent / "scene.toml"
    scene.write_text((BUILTIN / "sheet-3x3.toml").read_text("utf-8") + table, "utf-8")
    load_scene(scene)


def cached_array(path):
    key = "any"
    array_cache._path(key).parent.mkdir(parents=True, exist_ok=True)
    path.rename(array_cache._path(key))
    try:
        array_cache.read(key)
    finally:
        array_cache._path(key).rename(path)


READERS = {
    "import": (import_file, TABLES, "importing/sources importing/text_lines"),
    "sweeps": (read, [".csv", ".nc", ".zarr"], "formats/csv formats/netcdf formats/zarr"),
    "first sweeps": (lambda path: read_first(path, 5, lazy=True), [".zarr"], ""),
    "scene": (load_scene, [".toml"], "scene/scene_files"),
    "scene of a study": (lambda path: scene_table(str(path)), [".toml"], "study/axis"),
    "map": (map_of_scene, [".csv", ".png", ".jpg", ".tif", ".bmp", ".gif"], "scene/map_file"),
    "mesh": (
        lambda path: read_surface(str(path)),
        [".msh", ".vtk", ".vtu", ".inp"],
        "scene/mesh_file",
    ),
    "localizer": (localizer_file.load, [".npz"], "model/localizer_file sweeps/array_files"),
    "reduced model": (model_file.load, [".npz"], "reduced/model_file"),
    "cached array": (cached_array, [".npz"], ""),
    "accuracy": (accuracy_table.read_table, [".toml"], "meters/accuracy_table"),
    "switch": (read_switch, [".toml"], "switch/boards"),
    "reader": (read_line_format, [".toml"], "reader/line_format"),
    "press order": (lambda path: read_order(path, 3, 3), [".txt"], "record/operators"),
    "press script": (
        lambda path: read_script(path, SimpleNamespace(check=str)),
        [".txt"],
        "virtual/serving",
    ),
    "journal": (
        lambda path: unsealed_json(inputs.text(path, inputs.JOURNAL)),
        [".json"],
        "record/recording_journal design/evaluator dataset/generation dataset/work_block",
    ),
}
"""Functions of a path, the endings that each takes, and the modules that it reads by."""


class Run:
    """What a pickle runs when it is loaded."""

    def __init__(self, folder):
        self.folder = folder

    def __reduce__(self):
        return os.mkdir, (str(self.folder),)


def archive(members):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as made:
        for name, content in members.items():
            made.writestr(name, content)
    return file.getvalue()


def array_file(values):
    file = io.BytesIO()
    np.save(file, values, allow_pickle=True)
    return file.getvalue()


def netcdf():
    file = netCDF4.Dataset("any.nc", "w", memory=1000)
    file.createDimension("sweep", 2)
    file.createVariable("Rs", "f8", ("sweep",))[:] = [1, 2]
    return bytes(file.close())


def picture(form):
    file = io.BytesIO()
    Image.fromarray(np.zeros((4, 4, 3), np.uint8)).save(file, form)
    return file.getvalue()


def contents(folder):
    """Contents of files by kind. folder: is made by those that run something."""
    text = str(folder)
    run = pickle.dumps(Run(folder))
    source = f"__import__('os').mkdir({text!r})"
    objects = array_file(np.array([Run(folder)], dtype=object))
    function = {"__class__": "mkdir", "__module__": "os", "__loader__": "FunctionNode"}
    schema = json.dumps({**function, "content": {"module_path": "os", "function": "mkdir"}})
    return {
        "a pickle": b"cos\nmkdir\n(V%s\ntR." % text.encode(),
        "a pickle of today": run,
        "a pickle above a table": run + b"\n# Hz S RI R 50\n100 0.5 0.1\n",
        "objects of NumPy": objects,
        "an archive of objects": archive({"told.npy": objects, "values.npy": objects}),
        "an archive of a function": archive({"schema.json": schema, "0.pkl": run}),
        "an archive of a pickle": archive({"data.pkl": run, "archive/data.pkl": run}),
        "HDF5": netcdf(),
        "PNG": picture("PNG"),
        "GIF": picture("GIF"),
        "TIFF": picture("TIFF"),
        "PostScript": f"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 4 4\n({text}) run".encode(),
        "SVG": f"<svg xmlns='http://www.w3.org/2000/svg'><script>{source}</script></svg>".encode(),
        "XML": b"<!DOCTYPE x [<!ENTITY a SYSTEM 'file:///etc/hostname'>]><VTKFile>&a;</VTKFile>",
        "Python": source.encode(),
        "YAML": f"!!python/object/apply:os.mkdir [{text!r}]".encode(),
        "JSON": json.dumps({"py/reduce": [{"py/function": "os.mkdir"}, [text]]}).encode(),
        "TOML": f'name = "{{{{ {source} }}}}"\nkind = "numato"\n'.encode(),
        "a table": f"f (Hz),Rs (ohm),X (ohm)\n100,1,={source}\n200,2,3\n".encode(),
        "a mesh": f"*NODE\n1, {source}, 0, 0\n*ELEMENT, TYPE=S3\n1, 1, 1, 1\n".encode(),
        "nothing": b"",
        "noise": np.random.default_rng(0).bytes(3000),
    }


HAPPENED, WATCHED = [], []


def _watch(event, arguments):
    """Notes what runs while WATCHED is not empty; imports of modules may run."""
    if not WATCHED or event not in RUNS:
        return
    code = str(getattr(arguments[0], "co_filename", ""))
    if event == "exec" and (code.startswith("<frozen") or Path(code).is_file()):
        return
    HAPPENED.append((event, str(arguments)[:200]))
    raise PermissionError(f"{event} of a file that was only to be read")


sys.addaudithook(_watch)


def forbidden(name):
    def called(*arguments, **options):
        HAPPENED.append((name, str(arguments)[:200]))
        raise PermissionError(name)

    return called


def given_to(reader, path):
    """Reads a file; whatever it holds, it is read or refused."""
    try:
        with warnings.catch_warnings(action="ignore"):
            reader(path)
    except (InputError, ValueError):
        pass


@pytest.mark.parametrize("name", READERS)
def test_no_reader_runs_what_a_file_holds(name, tmp_path, monkeypatch):
    reader, endings, _ = READERS[name]
    monkeypatch.setattr(array_cache, "folder", lambda: tmp_path / "cache")
    paths = []
    for ending in endings:
        (tmp_path / f"folder{ending}").mkdir(exist_ok=True)  # .s2p is .S2P on some systems
        paths.append(tmp_path / f"folder{ending}")
        for number, content in enumerate(contents(tmp_path / "made").values()):
            path = tmp_path / f"file-{number}{ending}"
            if ending == ".zarr":
                path.mkdir()
                (path / "zarr.json").write_bytes(content)
            else:
                path.write_bytes(content)
            paths.append(path)
    for path in paths:  # imports what readers need, which runs modules
        given_to(reader, path)
    for of, called in ((pickle, "load"), (pickle, "loads"), (pickle, "Unpickler"), (os, "system")):
        monkeypatch.setattr(of, called, forbidden(f"{of.__name__}.{called}"))
    for called in ("run", "Popen"):
        monkeypatch.setattr(subprocess, called, forbidden(f"subprocess.{called}"))
    HAPPENED.clear()
    WATCHED.append(name)
    try:
        for path in paths:
            given_to(reader, path)
    finally:
        WATCHED.clear()
    assert not HAPPENED and not (tmp_path / "made").exists()


def test_what_is_watched_is_seen(tmp_path):
    WATCHED.append("this test")
    try:
        for run in (
            lambda: pickle.loads(pickle.dumps(Run(tmp_path / "made"))),
            lambda: eval("1 + 1"),
            lambda: exec("1 + 1"),
            lambda: os.system("true"),
            lambda: subprocess.run(["true"]),
        ):
            HAPPENED.clear()
            with pytest.raises(PermissionError):
                run()
            assert HAPPENED
    finally:
        WATCHED.clear()


def test_every_module_that_reads_a_file_of_a_user_is_among_the_readers():
    package = Path(rcskin.__file__).parent
    reads = re.compile(r"\binputs\.(content|text|table|picture|check_input|check_folder)\(")
    known = [module for _, _, modules in READERS.values() for module in modules.split()]
    for path in (file for room in ROOMS for file in (package / room).rglob("*.py")):
        if reads.search(path.read_text("utf-8")):
            place = path.relative_to(package).with_suffix("").as_posix()
            assert any(place.endswith(module) for module in known), place


ROOMS = ("simulator", "localization", "hardware")
SNIFFERS = {
    r"import (pickle|yaml|shelve|dill)|joblib\.load|torch\.load|read_(pickle|excel)|skrf\.N": "",
    r"np\.load\(": "allow_pickle=False",
    r"Image\.open\(": "formats=",
    r"(open|load)_dataset\(": "engine=",
    r"meshio\.read\(": "file_format=",
}
"""Calls that choose by content what they do with a file, and what makes them safe."""


@pytest.mark.parametrize("pattern", SNIFFERS)
def test_no_library_guesses_the_format_of_a_file(pattern):
    package = Path(rcskin.__file__).parent
    for path in (file for room in ROOMS for file in (package / room).rglob("*.py")):
        code = re.sub(r'"""[\s\S]*?"""|#.*', "", path.read_text("utf-8"))
        for line in code.splitlines():
            if re.search(pattern, line):
                assert SNIFFERS[pattern] and SNIFFERS[pattern] in line, f"{path.name}: {line}"
