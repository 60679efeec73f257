import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from rcskin.simulator.sweeps import (
    InputError,
    checked_folder,
    checked_output,
    impedance,
    made_folder,
    parallel_capacitance,
    read,
    write,
)
from rcskin.simulator.sweeps.imports import import_file

finite = st.floats(-1e300, 1e300, allow_subnormal=False)
HEADER = "sweep,press,row,column,session,interface,frequency_Hz,Rs_ohm,X_ohm,Cp_F"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("sweeps")


def same_bits(first, second):
    for name in ("Rs", "X", "Cp", "frequency", "press", "row", "column", "interface"):
        np.testing.assert_array_equal(first[name].values, second[name].values)
        assert first[name].dims == second[name].dims


@pytest.mark.usefixtures("replacing")
@settings(max_examples=5)
@given(
    parts=st.lists(st.tuples(finite, finite, finite), min_size=12, max_size=12),
    frequency=st.lists(st.floats(1e-6, 1e12), min_size=3, max_size=3, unique=True).map(sorted),
)
@pytest.mark.parametrize("ending", [".csv", ".nc", ".zarr"])
def test_numbers_are_read_back_to_the_same_bits(make_sweeps, folder, ending, parts, frequency):
    Rs, X, Cp = np.array(parts).T.reshape(3, 2, 2, 3)
    sweeps = make_sweeps(frequency=frequency, Z=np.ones((2, 2, 3)), shown={"Cp": Cp})
    sweeps["Rs"][:], sweeps["X"][:] = Rs, X
    write(sweeps, folder / f"all{ending}")
    same_bits(read(folder / f"all{ending}"), sweeps)


@pytest.mark.usefixtures("replacing")
@pytest.mark.parametrize("name", ["all.nc", "all.zarr"])
def test_netcdf_and_zarr_keep_everything(make_sweeps, tmp_path, name):
    errors = {"Rs_error": np.full((2, 2, 3), 1e-9), "Cp_error": np.full((2, 2, 3), 1e-20)}
    sweeps = make_sweeps(errors=errors, session=[3, 4], attributes={"scene": "a = 1\n", "rtol": 1})
    for _ in range(2):
        write(sweeps, tmp_path / name)
    assert read(tmp_path / name).identical(sweeps)
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_csv_is_long_form_with_the_agreed_header(make_sweeps, tmp_path):
    write(make_sweeps(), tmp_path / "all.csv")
    lines = (tmp_path / "all.csv").read_text().splitlines()
    assert [line.split(" = ")[0] for line in lines[:2]] == ["# rcskin_sha256", "# rcskin_lines"]
    lines = lines[2:]
    assert lines[0] == HEADER
    assert len(lines) == 1 + 2 * 2 * 3
    assert lines[7].startswith('1,"1,1:2.0",1,1,0,left,1000.0,')


def lines_of(*rows, header="frequency_Hz,Rs_ohm,X_ohm"):
    return "\n".join([header, *rows, ""])


@pytest.fixture
def csv(tmp_path):
    """A function that reads a CSV of some text."""

    def csv(text, encoding="utf-8"):
        path = tmp_path / "some.csv"
        path.write_text(text, encoding=encoding)
        return read(path)

    return csv


def test_columns_may_come_in_any_order_with_others_among_them(csv):
    sweeps = csv(lines_of("-4,note,1e3,3", header="X_ohm,remark,frequency_Hz,Rs_ohm"))
    assert impedance(sweeps).item() == 3 - 4j
    assert sweeps["press"].item() == "unknown"
    assert (sweeps["row"].item(), sweeps["column"].item()) == (-1, -1)


def test_frequencies_may_come_in_any_order(csv):
    sweeps = csv(lines_of("3e3,3,-1", "1e3,1,-3", "2e3,2,-2"))
    assert sweeps["frequency"].values.tolist() == [1e3, 2e3, 3e3]
    assert sweeps["Rs"].values.ravel().tolist() == [1, 2, 3]


def test_interfaces_keep_the_order_they_appear_in(csv):
    text = lines_of("b,1,1,-1", "a,1,2,-2", header="interface,frequency_Hz,Rs_ohm,X_ohm")
    sweeps = csv(text)
    assert sweeps["interface"].values.tolist() == ["b", "a"]
    assert sweeps["Rs"].values.ravel().tolist() == [1, 2]


def test_reactance_follows_where_only_Cp_is_given(csv):
    Cp = parallel_capacitance(1 - 3j, 1e3).item()
    sweeps = csv(lines_of(f"1e3,1,{Cp!r}", header="frequency_Hz,Rs_ohm,Cp_F"))
    assert sweeps["X"].item() == pytest.approx(-3, rel=1e-12)
    assert sweeps["Cp"].item() == Cp


def test_a_byte_order_mark_is_no_part_of_the_header(csv):
    assert csv(lines_of("1e3,1,-1"), encoding="utf-8-sig")["Rs"].item() == 1


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "not a CSV of sweeps"),
        (lines_of(), "holds no sweep"),
        (lines_of("1,2,3", header="f,Rs_ohm,X_ohm"), "column `frequency_Hz` is missing; found f"),
        (lines_of("1,2", header="frequency_Hz,X_ohm"), "column `Rs_ohm` is missing"),
        (lines_of("1,2", header="frequency_Hz,Rs_ohm"), "column `X_ohm` or `Cp_F` is missing"),
        (lines_of("1e3,1,-1", "2e3,one,-1"), "line 3: `Rs_ohm` must be a finite number, got 'one'"),
        (lines_of("1e3,1,-1", "2e3,,-1"), "line 3: `Rs_ohm` must be a finite number, got ''"),
        (lines_of("1e3,1,nan"), "line 2: `X_ohm` must be a finite number, got 'nan'"),
        (lines_of("1e3,1,-1", "2e3,inf,-1"), "line 3: `Rs_ohm` must be a finite number"),
        (lines_of("1e3,1,-1", "", "2e3,one,-1"), "line 4: `Rs_ohm` must be a finite number"),
        *(
            (
                lines_of(f"{text},1,-1"),
                f"line 2: `frequency_Hz` must be a finite number, got '{text}'",
            )
            for text in ("1_0", "٣", "１", "0x10", "1e9999", "1 0", "infinity")
        ),
        *(
            (
                lines_of(f"{text},1,1,-1", header=f"{name},frequency_Hz,Rs_ohm,X_ohm"),
                f"line 2: `{name}` must be a whole number, got '{text}'",
            )
            for name in ("sweep", "row", "column")
            for text in ("1.7", "1e300", "٣", "1_0")
        ),
        (
            lines_of("1e3,3,-4,7e-12", header="frequency_Hz,Rs_ohm,X_ohm,Cp_F"),
            "line 2: `Cp_F` does not follow from Rs and X: it is 7e-12 F where they give 2.5",
        ),
        (lines_of("1e3,1,-1", "2e3,1"), "line 3: `X_ohm` must be a finite number"),
        (lines_of("1e3,1,-1", "2e3,1,-1,7"), "line 3"),
        (lines_of("1e3,1,-1,7"), "not a CSV of sweeps"),
        (lines_of("0,1,-1"), "`frequency` must be finite and > 0 Hz"),
        (lines_of("1e3,1,-1", "1e3,2,-1"), "every sweep must hold the same readings exactly once"),
        (lines_of("1e3,1,1", header="frequency_Hz,Rs_ohm,Cp_F"), "no capacitive reactance"),
        (
            lines_of("0,1,1,-1", "1,2,1,-1", header="sweep,frequency_Hz,Rs_ohm,X_ohm"),
            "every sweep must hold the same readings exactly once: each interface at the",
        ),
        (
            lines_of(
                "0,a,1,1,-1",
                "0,b,2,1,-1",
                "1,a,1,1,-1",
                "1,b,1,1,-1",
                header="sweep,interface,frequency_Hz,Rs_ohm,X_ohm",
            ),
            "every sweep must hold the same readings exactly once: each interface at the",
        ),
    ],
)
def test_bad_tables_are_reported_with_file_and_line(csv, tmp_path, text, told):
    with pytest.raises(InputError) as error:
        csv(text)
    message = str(error.value)
    assert message.startswith(f"{tmp_path / 'some.csv'}: ")
    assert told in message
    assert "\n" not in message


@pytest.mark.parametrize("reader", [read, import_file])
def test_a_scene_given_for_sweeps_is_reported_with_what_makes_sweeps(reader, folder):
    with pytest.raises(InputError, match=r"is a scene.*rcskin sweep .*my\.toml -o my\.nc"):
        reader(folder / "my.toml")


@pytest.mark.parametrize("reader", [read, import_file])
def test_a_model_given_for_sweeps_is_reported(reader, folder):
    (folder / "m.npz").write_bytes(b"PK\0")
    with pytest.raises(InputError, match=r"m\.npz: this is a model, sweeps are expected here"):
        reader(folder / "m.npz")


def test_files_of_another_kind_are_reported(tmp_path):
    with pytest.raises(InputError, match=r"absent\.nc: no such file"):
        read(tmp_path / "absent.nc")
    with pytest.raises(InputError, match=r"sweeps are read from \.nc, \.csv, \.zarr, got '\.xlsx'"):
        read(tmp_path / "all.xlsx")
    (tmp_path / "text.nc").write_text("no NetCDF")
    with pytest.raises(InputError, match=r"text\.nc: cannot be read as \.nc"):
        read(tmp_path / "text.nc")
    (tmp_path / "bytes.csv").write_bytes(b"\xff\xfe\x00frequency_Hz\n")
    with pytest.raises(InputError, match=r"bytes\.csv: not a CSV of sweeps"):
        read(tmp_path / "bytes.csv")


def test_a_file_that_breaks_the_schema_is_named(make_sweeps, tmp_path):
    make_sweeps().drop_vars("session").to_netcdf(tmp_path / "part.nc")
    with pytest.raises(InputError, match=r"part\.nc: `session` is missing from the sweeps"):
        read(tmp_path / "part.nc")


def test_where_nothing_can_be_written_is_reported_first(make_sweeps, tmp_path):
    with pytest.raises(InputError, match=r"must end in \.nc or \.csv or \.zarr, got '\.txt'"):
        write(make_sweeps(), tmp_path / "all.txt")
    with pytest.raises(InputError, match=r"the folder .* does not exist"):
        checked_output(tmp_path / "absent" / "all.csv")


def test_bad_sweeps_leave_no_file_behind(make_sweeps, tmp_path):
    sweeps = make_sweeps()
    sweeps["Rs"][0, 0, 0] = np.nan
    for name in ("all.csv", "all.nc"):
        with pytest.raises(InputError):
            write(sweeps, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_one_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="a part of the path is a file, not a folder"):
        made_folder(tmp_path / "file" / "folder")
    with pytest.raises(InputError, match="is a file, not a folder"):
        checked_folder(tmp_path / "file")
    for use in (checked_folder, made_folder):
        with pytest.raises(InputError, match=r"give a name without \.toml"):
            use(tmp_path / "found.toml")
    with pytest.raises(InputError, match=r"the folder .*absent does not exist"):
        checked_folder(tmp_path / "absent" / "folder")
    assert made_folder(tmp_path / "above" / "folder").is_dir()
    assert checked_folder(tmp_path / "new") == tmp_path / "new"


def saved_again(sweeps, path, change):
    """A file of sweeps that another program changed and wrote."""
    write(sweeps, path)
    changed = change(xr.load_dataset(path))
    changed.to_netcdf(path)
    return read(path)


@pytest.mark.parametrize(
    ("name", "factor", "unit"),
    [
        ("Rs", 1e3, "kohm"),
        ("Rs", 1e6, "MOhms"),
        ("Rs", 1e3, "kΩ"),
        ("X", 1e-3, "mohm"),
        ("Cp", 1e-12, "pF"),
        ("frequency", 1e3, "kHz"),
        ("frequency", 1 / (2 * np.pi), "rad/s"),
    ],
)
def test_units_of_other_programs_are_converted(make_sweeps, tmp_path, name, factor, unit):
    def change(sweeps):
        return sweeps.assign({name: (sweeps[name] / factor).assign_attrs(units=unit)})

    found = saved_again(make_sweeps(), tmp_path / "all.nc", change)
    np.testing.assert_allclose(found[name], make_sweeps()[name], rtol=1e-14)
    assert found[name].attrs["units"] == make_sweeps()[name].attrs["units"]


@pytest.mark.parametrize(
    "unit",
    ["m", "kilos", "ohm ohm", "1/0", "10**10**10*ohm", "2 kohm", "kohm*pF/pF", "MOHM", "a" * 10**6],
)
def test_units_of_other_quantities_are_refused(make_sweeps, tmp_path, unit):
    with pytest.raises(InputError, match=r"all\.nc: `Rs` must be in ohm, got '"):
        saved_again(
            make_sweeps(),
            tmp_path / "all.nc",
            lambda sweeps: sweeps.assign(Rs=sweeps["Rs"].assign_attrs(units=unit)),
        )


def test_a_unit_without_case_may_be_milli_or_mega(make_sweeps, tmp_path):
    with pytest.raises(InputError, match="`frequency` must be in Hz, got 'mhz'"):
        saved_again(
            make_sweeps(),
            tmp_path / "all.nc",
            lambda sweeps: sweeps.assign_coords(
                frequency=sweeps["frequency"].assign_attrs(units="mhz")
            ),
        )


def test_dimensions_may_have_another_order(make_sweeps, tmp_path):
    found = saved_again(
        make_sweeps(),
        tmp_path / "all.nc",
        lambda sweeps: sweeps.transpose("frequency", "sweep", "interface"),
    )
    xr.testing.assert_equal(found, make_sweeps())
    assert found["Rs"].dims == ("sweep", "interface", "frequency")


def test_rows_do_not_count_from_0(make_sweeps, tmp_path):
    with pytest.raises(InputError, match="rows and columns count from 1"):
        saved_again(
            make_sweeps(),
            tmp_path / "all.nc",
            lambda sweeps: sweeps.assign_coords(row=0 * sweeps["row"], column=1 + sweeps["column"]),
        )
