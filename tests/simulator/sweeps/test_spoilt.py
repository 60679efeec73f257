"""Files of sweeps with a flipped bit or cut short are refused, or read to the same bits."""

import threading

import netCDF4
import numpy as np
import pytest
import xarray as xr
import zarr
from rcskin.simulator.sweeps import InputError, parallel_capacitance, read, write
from rcskin.simulator.sweeps.digests import sealed_json, unsealed_json
from rcskin.simulator.sweeps.examination import examine
from rcskin.simulator.sweeps.imports import import_file
from rcskin.tests.spoiling import share_refused

FLIPS, CUTS = 150, 30


@pytest.fixture(scope="module")
def stored(make_sweeps, tmp_path_factory):
    """A function of an ending: sweeps with texts and attributes, and a file of them."""
    told = {"scene": 'name = "skin µ"\n[skin]\nlength = 0.1\n', "seed": 7, "settings": "speed FAST"}
    sweeps = make_sweeps(attributes=told, session=[0, 0])

    def stored(ending):
        path = tmp_path_factory.mktemp("stored") / f"all{ending}"
        write(sweeps, path)
        return sweeps, path

    return stored


@pytest.mark.parametrize(
    ("ending", "number", "least"),
    [(".nc", (FLIPS, CUTS), 0.95), (".zarr", (30, 10), 0.3), (".csv", (FLIPS, CUTS), 1.0)],
)
def test_a_spoilt_file_is_refused_or_gives_the_same_bits(stored, ending, number, least):
    sweeps, path = stored(ending)
    expected = read(path)
    xr.testing.assert_equal(expected, sweeps)
    assert share_refused(path, read, expected.identical, *number) >= least
    assert read(path).identical(expected)


def test_a_spoilt_csv_is_no_table_of_another_tool(stored):
    _, path = stored(".csv")
    expected = import_file(path)
    assert share_refused(path, import_file, expected.identical, 40, 10) == 1


def test_a_csv_cut_by_a_digit_is_reported_by_its_lines(stored):
    _, path = stored(".csv")
    path.write_bytes(path.read_bytes()[:-2])
    with pytest.raises(
        InputError, match=r"^\S+all\.csv: cut off or changed .*: only 19 of 20 lines are"
    ):
        read(path)


def test_a_csv_changed_on_purpose_is_read_without_the_lines_of_its_checksum(stored):
    _, path = stored(".csv")
    text = path.read_text("utf-8")
    path.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    assert read(path)["Rs"].size == 12
    path.write_text(text.replace("none", "away"), "utf-8")
    with pytest.raises(InputError, match="delete its lines `# rcskin_sha256` and `# rcskin_lines`"):
        read(path)
    path.write_text(text.replace("none", "away").split("\n", 2)[2], "utf-8")
    assert read(path)["press"][0] == "away"


def test_what_a_library_changes_on_purpose_is_read(stored):
    _, path = stored(".nc")
    with netCDF4.Dataset(path, "a") as file:
        assert all(
            each.dtype is str or each.filters()["fletcher32"] for each in file.variables.values()
        )
        file["Rs"][0, 0, 0] = 5.0
    assert read(path)["Rs"][0, 0, 0] == 5
    _, path = stored(".zarr")
    with pytest.warns(UserWarning, match="Consolidated metadata"):
        xr.open_zarr(path).load().assign_attrs(seed=8).to_zarr(path, mode="w")
    assert read(path).attrs["seed"] == 8


def test_a_zarr_lacks_no_part_of_any_array_and_checks_each(stored):
    _, path = stored(".zarr")
    for name, array in zarr.open_group(path, mode="r").arrays():
        assert any("Crc32c" in type(codec).__name__ for codec in array.compressors), name
    (path / "session" / "c" / "0").unlink()
    with pytest.raises(InputError, match=r"all\.zarr: cut off, holds 0 of 1 parts of `session`"):
        read(path)


@pytest.mark.parametrize("ending", [".nc", ".csv", ".zarr"])
def test_check_compares_Cp_with_Rs_and_X(make_sweeps, tmp_path, ending):
    frequency = np.geomspace(1e3, 1e5, 8)
    Z = np.tile(3 - 4e3j / frequency, (2, 1, 1))
    Cp = parallel_capacitance(Z, frequency)
    Cp[1, 0, 2] *= 1.005
    sweeps = make_sweeps(interfaces=["left"], frequency=frequency, Z=Z, shown={"Cp": Cp})
    write(sweeps, tmp_path / f"all{ending}")
    first, second = examine(read(tmp_path / f"all{ending}"))
    assert first.broken == ()
    (broken,) = second.broken
    assert (broken.law, broken.frequency) == ("Cp = Im(1/Z)/omega", (frequency[2],))


def test_threads_read_and_write_netcdf_in_turn(make_sweeps, tmp_path):
    sweeps = make_sweeps(sweeps=20)

    def work(number):
        for k in range(3):
            write(sweeps, tmp_path / f"{number}-{k}.nc")
            found.append(read(tmp_path / f"{number}-{k}.nc").equals(sweeps))

    found = []
    threads = [threading.Thread(target=work, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [True] * 24


@pytest.mark.parametrize("text", ["", "[1]", "{", "5", '{"a": 1, "sha256": "0"}'])
def test_what_is_kept_as_json_is_read_only_as_it_was_written(text):
    content = {"sweep": [1.5, None], "press": "1,1:2.0", "µ": {"a": 1e-12}}
    assert unsealed_json(sealed_json(content)) == content
    with pytest.raises(ValueError, match=r"\w"):
        unsealed_json(text)
    with pytest.raises(ValueError, match="does not match its checksum"):
        unsealed_json(sealed_json(content).replace("1.5", "1.7"))
