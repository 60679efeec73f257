"""Descriptions of readers: which are refused, and in which words."""

import re

import pytest
from rcskin.hardware.reader.line_format import (
    LineFormat,
    ReaderInterface,
    read_line_format,
    write_new_format,
)
from rcskin.simulator.sweeps import InputError
from rcskin.tests.hardware.reader.reader_files import ARRAYS, COUNTED


@pytest.mark.parametrize("text", [COUNTED, ARRAYS])
def test_the_descriptions_of_these_tests_are_sound(tmp_path, text):
    path = tmp_path / "reader.toml"
    path.write_text(text)
    found = read_line_format(path)
    assert [each.name for each in found.interface] == ["left", "bottom"]


def test_a_new_file_is_sound_and_names_every_key(tmp_path):
    path = tmp_path / "reader.toml"
    write_new_format(path)
    assert read_line_format(path).lines == "readings"
    known = {*LineFormat.model_fields, *ReaderInterface.model_fields} - {"separator", "comment"}
    text = path.read_text()
    assert {key for key in known if not re.search(rf"\b{key} = |\b{key}\b", text)} == set()


REFUSED = [
    ('format = "csv"', 'format = "xml"', "`format`: Input should be 'json' or 'csv', got 'xml'"),
    ("rate = 2000", "", "`rate`: Field required"),
    ("rate = 2000", "rate = 0", "`rate`: Input should be greater than 0, got 0"),
    ("rate = 2000", "rate = 2000\nbaud = 100", "`baud`: Input should be greater than or equal to"),
    ("rate = 2000", "rate = 2000\nspeed = 3", "`speed`: Extra inputs are not permitted, got 3"),
    ('real = "r"', "", "needs `real` and `imaginary`, or `magnitude` and `phase`"),
    ('real = "r"\nimaginary = "x"', 'magnitude = "r"', "alone is possible for a gain only"),
    ("rate = 2000", 'rate = 2000\nunit = "V"', "must be 'ohm', got 'V'"),
    ("rate = 2000", 'rate = 2000\nquantity = "gain"', "must be 'V' or 'bit' or 'share', got 'ohm'"),
    (
        "rate = 2000",
        'rate = 2000\nquantity = "gain"\nunit = "bit"',
        "`amplitude` (of the source, V) is needed for the units 'V' and 'bit'",
    ),
    ("rate = 2000", "rate = 2000\namplitude = 1.0", "`unit` is 'ohm' and `amplitude` is 1.0"),
    ("rate = 2000", "rate = 2000\nrange = [5.0, 1.0]", "`range` must ascend, got [5.0, 1.0]"),
    ("rate = 2000", "rate = 2000\nerror = 0.1", "`error` and `phase_error` are given together"),
    ('label = "B"', 'label = "A"', "each with a `label` of its own"),
    ('label = "B"', "", "each with a `label` of its own"),
    ('terminal = "port"', "", "`label` of an interface needs `terminal`"),
    ('name = "bottom"', 'name = "left"', "names must differ, got left, left"),
    ('frequency = "f"', "", "needs `frequency`, the field that holds it, and no list"),
    ('frequency = "f"', 'frequency = "f"\nfrequencies = [1e3]', "and no list"),
    ('"n", "t",', '"n",', "`columns` must name t"),
    ('"n", "t",', '"n", "n", "t",', "`columns` must have different names"),
    ('format = "csv"', 'format = "json"', "`columns` belongs to csv"),
    ("rate = 2000", "rate = [", "is no description of a reader in TOML"),
]


@pytest.mark.parametrize(("old", "new", "message"), REFUSED)
def test_a_wrong_description_is_one_line_with_file_key_and_value(tmp_path, old, new, message):
    path = tmp_path / "reader.toml"
    assert old in COUNTED
    path.write_text(COUNTED.replace(old, new, 1))
    with pytest.raises(InputError) as refused:
        read_line_format(path)
    assert str(refused.value).startswith(f"{path}: ")
    assert message in str(refused.value) and "\n" not in str(refused.value)
