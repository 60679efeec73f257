"""Tables of other tools: what is read from them, and what is told of those that cannot be read."""

import numpy as np
import pytest
from rcskin.simulator.sweeps import InputError, impedance, parallel_capacitance, write
from rcskin.simulator.sweeps.importing.columns import recognised
from rcskin.simulator.sweeps.imports import import_file


def test_the_files_of_this_project_are_read_too(make_sweeps, tmp_path):
    write(make_sweeps(), tmp_path / "own.csv")
    imported = import_file(tmp_path / "own.csv")
    np.testing.assert_allclose(impedance(imported), impedance(make_sweeps()), rtol=1e-14)
    for name in ("press", "row", "column", "interface"):
        assert list(imported[name].values) == list(make_sweeps()[name].values)


def test_a_table_may_name_the_skin_at_rest_by_row_and_column_0(table):
    sweeps = table("press,f/Hz,Rs,X", '"0, 0",1,2,-3', '"1,1",1,2,-3')
    assert list(sweeps["press"].values) == ["none", "1,1"]
    assert list(sweeps["row"].values) == [0, 1]
    with pytest.raises(InputError, match="--press must be 'none' where nothing is pressed"):
        table("f/Hz,Rs,X", "1,2,-3", press="0,0")


def test_what_the_meter_displayed_as_Cp_is_kept_beside_Rs_and_X(table):
    sweeps = table("f/Hz,Rs,X,Cp (uF)", "1e3,3,-4,25.5")
    assert impedance(sweeps).item() == 3 - 4j
    assert sweeps["Cp"].item() == pytest.approx(25.5e-6)
    assert sweeps.attrs["quantities"] == "Rs and X"


def test_a_Cp_that_is_not_that_of_Rs_and_X_is_refused_and_zeros_are_no_readings(table):
    with pytest.raises(
        InputError, match="line 3: `Cp` does not follow from `Rs` and `X`: it is 25.5 where"
    ):
        table("f/Hz,Rs,X,Cp", "1e3,3,-4,25.5e-6", "2e3,3,-4,25.5")
    found = parallel_capacitance([3 - 4j, 3 - 5j], [1e3, 2e3])
    sweeps = table("f/Hz,Rs,X,Cp/uF", "1e3,3,-4,0", "2e3,3,-5,0")
    np.testing.assert_array_equal(sweeps["Cp"].values.ravel(), found)


def test_Rs_and_Cp_are_read_on_the_stated_branch(table):
    Cp = parallel_capacitance(100 - 25j, 1e3).item()
    sweeps = table("f/Hz,Rs,Cp", f"1e3,100,{Cp!r}")
    assert impedance(sweeps).item() == pytest.approx(100 - 400j)
    assert "|X| >= Rs at the lowest frequency" in sweeps.attrs["branch_rule"]
    assert "1 of 1 readings may be on the wrong branch" in sweeps.attrs["branch_doubt"]


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1"])
def test_encodings_of_instruments(table, encoding):
    sweeps = table("f (kHz);|Z| (kohm);Phase (\u00b0)", "1;1;-90", encoding=encoding)
    assert impedance(sweeps).item() == pytest.approx(-1000j)


def test_units_may_stand_in_a_line_of_their_own(table):
    sweeps = table("Pt\tFreq\tZmod\tZphz", "#\tkHz\tkohm\t\u00b0", "0\t1\t2\t-90")
    assert sweeps["frequency"].item() == 1000
    assert impedance(sweeps).item() == pytest.approx(-2000j)


@pytest.mark.parametrize(
    "lines",
    [
        ["kHz,kohm,deg,", "Frequency,|Z|,Phase,remark"],
        ["(kHz),[kohm],(deg),", "made by a tool", "", "Frequency,|Z|,Phase,remark"],
        ["# kHz,kohm,deg,x", "# Frequency,|Z|,Phase,remark"],
        ["kHz,kohm,,", "Frequency,|Z|,Phase (deg),remark"],
    ],
)
def test_units_may_stand_above_the_names(table, lines):
    sweeps = table(*lines, "1,2,-90,x", "3,2,-90,y", *lines, "1,2,-90,x", "3,2,-90,y")
    assert sweeps["frequency"].values.tolist() == [1000, 3000]
    np.testing.assert_allclose(impedance(sweeps).ravel(), [-2000j] * 4, atol=1e-9)


@pytest.mark.parametrize(
    ("above", "names", "remark"),
    [
        ("kHz,left,right", "f,Rs,X", "a line above the names may hold units (kHz): not used"),
        ("kHz,kohm,kohm", "f (Hz),Rs (ohm),X", "may hold units (kHz, kohm, kohm): not used"),
        ("Hz,ohm,ohm", "f (Hz),Rs (ohm),X", None),
        ("F,S,H", "f,Rs,X", None),
    ],
)
def test_a_line_that_only_looks_like_units_is_not_used(table, above, names, remark):
    sweeps = table(above, names, "1,2,-3")
    assert sweeps["frequency"].item() == 1 and impedance(sweeps).item() == 2 - 3j
    assert (remark or "") in sweeps.attrs.get("warnings", "")
    assert remark or "warnings" not in sweeps.attrs


def test_a_unit_above_the_names_that_is_missing_is_not_guessed(table):
    with pytest.raises(InputError, match=r"`X \[no unit\]` must be in ohm"):
        table("kHz,kohm,", "f,Rs,X", "1,2,-3")


def test_names_may_have_line_breaks_in_quotes(table):
    sweeps = table("made by a tool", '"f', '(Hz)","Rs', '(ohm)","-X', '(ohm)"', "1,2,3", "2,2,3")
    assert impedance(sweeps).ravel().tolist() == [2 - 3j] * 2
    with pytest.raises(InputError, match="line 2: cannot be split into cells"):
        table("f,Rs,X", '1,"2,3', '2,2,3"')


def test_a_line_break_in_the_last_name_does_not_lose_its_unit(table):
    assert impedance(table('f,Rs (kohm),"-X', '(kohm)"', "1,2,3")).item() == 2e3 - 3e3j


@pytest.mark.parametrize(
    "header",
    [
        "Frequency (Hz) Rs (ohm) X (ohm)",
        '"Frequency (Hz)" "Rs (ohm)" "X (ohm)"',
        "Frequency (Hz), Rs (ohm), X (ohm)",
        "Frequency (Hz)\tRs (ohm)\tX (ohm)",
    ],
)
@pytest.mark.parametrize("row", ["1.5 2.5 -3.5", "1,5;2,5;-3,5", "1,5\t2,5\t-3,5", "1.5,2.5,-3.5"])
def test_header_and_readings_may_be_split_in_two_ways(table, header, row):
    assert impedance(table(header, row)).item() == 2.5 - 3.5j


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-16-le", "cp1252"])
def test_a_byte_order_mark_may_stand_inside(tmp_path, encoding):
    mark = "\ufeff" if "utf" in encoding else "\u00ef\u00bb\u00bf"
    part = f"{mark}Frequency (Hz),Phase (\u00b0),|Z|\n1,-90,2\n2,-90,2\n"
    (tmp_path / "joined.csv").write_bytes((part + part).encode(encoding))
    assert import_file(tmp_path / "joined.csv").sizes["sweep"] == 2


@pytest.mark.parametrize("end", ["", ",", ";;"])
def test_lines_may_be_quoted_as_a_whole(table, end):
    quoted = [f'"{line}"{end}' for line in ('""f"",""Rs"",X,', "1,2,-3,", "2,2,-3,")]
    sweeps = table("made by a tool", quoted[0], "1,2,-3,", quoted[2])
    assert impedance(sweeps).ravel().tolist() == [2 - 3j] * 2


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["f / Hz,Rs / ohm,X / ohm", "1,2,-3,4"], "line 2: has 4 cells where the header in line 1"),
        (["f / Hz;Rs / ohm;X / ohm", "1,5;2,5;-3,5;4"], "has 4 cells where .* line 1 has 3"),
        (["f\tRs\tX", "1\t2"], "line 2: has 2 cells where the header in line 1 has 3"),
        (["f\tRs\tX", "1\t2\t-3\ta, b"], "line 2: has 4 cells where the header in line 1 has 3"),
        (["title", '"f,Rs,X,D,"', '"1,2,-3"'], "line 3: has 3 cells where .* line 2 has 4"),
    ],
)
def test_cells_are_counted_as_the_header_is_split(tmp_path, lines, message):
    with pytest.raises(InputError, match=message):
        (tmp_path / "bad.csv").write_text("\n".join(lines))
        import_file(tmp_path / "bad.csv")


def test_angular_frequency(table):
    assert table("omega (rad/s),R,X", "6283.185307179586,1,-1")["frequency"].item() == 1000


def test_what_stood_above_the_header_is_kept(table):
    sweeps = table("HIOKI,IM3523,4711", "# averaged", "f/Hz,R,X", "1,1,-1")
    assert sweeps.attrs["preamble"] == "HIOKI,IM3523,4711\n# averaged"
    assert sweeps.attrs["source"] == "some.csv"


def test_columns_of_unknown_names_do_not_matter(table):
    sweeps = table("time/s,f/Hz,Rs,Rs_error,X,phase,X std", "0,1,1,9,-1,?,9")
    assert impedance(sweeps).item() == 1 - 1j


def test_defaults_hold_where_the_file_has_no_such_column(table):
    sweeps = table("f/Hz,R,X", "1,1,-1", interface="left", session=3)
    assert sweeps["interface"].item() == "left"
    assert sweeps["session"].item() == 3
    with pytest.raises(InputError, match=r"has its own column `Press`, so no press may be given"):
        table("Press,f/Hz,R,X", "none,1,1,-1", press="1,1")


@pytest.mark.parametrize(
    ("lines", "told"),
    [
        ([""], "no line names a frequency column"),
        (["Frequency (kHz),Rs"], "no line of readings below the header in line 1"),
        (["f/Hz,Rs", "1,2"], "needs columns of Rs and X, of |Z| and phase"),
        (["# x", "f/Hz,Rs,Z',X", "1,2,3,4"], "line 3: `Z'` does not follow from `Rs` and `X`"),
        (["f/Hz,|Z|,theta", "1,2,3"], "column `theta` must be in deg or rad"),
        (["f/Hz,Rs (stone),X", "1,2,3"], "`Rs (stone)` must be in ohm, got 'stone'"),
        (["f/Hz,Rs,X", "1,2,-3", "2,2"], "line 3: has 2 cells where the header in line 1 has 3"),
        (["f/Hz,Rs,X", "1,2,-3,4"], "line 2: has 4 cells where the header in line 1 has 3"),
        (["f/Hz,Rs,X", '1,"2,-3'], "line 2: cannot be split into cells"),
        (["f;Rs;X", "1,5;2;-3", "2.5;2;-3"], "line 3: `f` must be a number with a decimal comma"),
        (["f/Hz,Rs,X", "0,2,-3"], "line 2: the frequency is 0, and no line has a reading"),
        (["f/Hz,Rs,X", "1,2,-3", "2,0,0"], "line 3: Z is 0 ohm, which no reading is"),
        (["f/Hz,Rs,X", "1,2,999999E+28"], "line 2: `X` is no reading, and no line has"),
        (["f/Hz,|Z|,Phase/deg", "1,-2,3"], "line 2: |Z| must be >= 0 (`|Z|`)"),
        (["f/Hz,Rs,Cs", "1,2,0"], "line 2: Cs must not be 0 (`Cs`)"),
        (["f/Hz,Rs,Cp", "1,2,1e-9", "2,1,1"], "line 3: no capacitive reactance has"),
        (["sweep,f,R,X", "1,1,1,-1", "1,1,1,-1"], "line 3: the same sweep has 1 Hz in line 2"),
        (["row,f,R,X", "a,1,1,-1"], "line 2: `row` must be a whole number, got 'a'"),
        (["press,f,R,X", "x,1,1,-1", ",2,1,-1"], "line 3: names no press"),
        (
            ["sweep,press,f,R,X", "1,a,1,1,-1", "1,b,2,1,-1"],
            "line 3: has another press or session than line 2",
        ),
        (
            ["f,R,X", "1,1,-1", "2,1,-1", "1,1,-1", "3,1,-1"],
            "line 4: the sweep from here on has 2 readings, not the same 2",
        ),
        (["f,R,X", "1,1,-1", "2,1,-1", "1,1,-1"], "line 4: the sweep from here on has 1 readings"),
        (
            ["sweep,interface,f,R,X", "1,a,1,1,-1", "1,b,2,1,-1", "2,a,1,1,-1", "2,b,1,1,-1"],
            "line 4: the sweep from here on has 2 readings, not the same 2 interfaces",
        ),
    ],
)
def test_what_cannot_be_read_is_reported_with_its_place(refusal, lines, told):
    assert told in refusal(*lines)


def test_what_is_no_text_is_reported(tmp_path):
    (tmp_path / "picture.csv").write_bytes(b"\x89PNG\n\x00\x01")
    with pytest.raises(InputError, match=r"picture\.csv: line 2: not text"):
        import_file(tmp_path / "picture.csv")
    with pytest.raises(InputError, match=r"absent\.csv: no such file"):
        import_file(tmp_path / "absent.csv")


def pair_of(f, Z):
    """All quantities of a reading by the names of a meter, without a unit."""
    w, Y = 2 * np.pi * f, 1 / Z
    return {
        "Rs": Z.real,
        "X": Z.imag,
        "|Z|": abs(Z),
        "theta (deg)": np.degrees(np.angle(Z)),
        "G": Y.real,
        "B": Y.imag,
        "|Y|": abs(Y),
        "theta-y (deg)": -np.degrees(np.angle(Z)),
        "Cp": Y.imag / w,
        "Cs": -1 / (w * Z.imag),
        "Ls": Z.imag / w,
        "Lp": -1 / (w * Y.imag),
        "Rp": 1 / Y.real,
        "D": Z.real / abs(Z.imag),
        "Q": abs(Z.imag) / Z.real,
        "omega (rad/s)": w,
    }


PAIRS = [
    *("Rs X", "|Z| theta-(deg)", "G B", "|Y| theta-y-(deg)", "Rs Cs", "Rs Ls", "Cp G", "Cp Rp"),
    *("Lp Rp", "Cs D", "Cs Q", "Ls D", "Ls Q", "Cp D", "Cp Q", "Lp D", "Lp Q", "G Lp", "X D"),
]


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("Z", [3e3 - 4e3j, 3e3 + 4e3j, 0.2 - 900j])
def test_every_usual_pair_gives_Z(table, pair, Z):
    names = [name.replace("-(", " (") for name in pair.split()]
    cells = [",".join(map(repr, map(float, map(pair_of(f, Z).get, names)))) for f in (1e3, 2e3)]
    sweeps = table("f/Hz," + ",".join(names), f"1e3,{cells[0]}", f"2e3,{cells[1]}")
    np.testing.assert_allclose(impedance(sweeps).ravel(), [Z, Z], rtol=1e-9)


@pytest.mark.parametrize("name", [*pair_of(1e3, 3 - 4j)][2:])
def test_every_other_column_must_agree_with_the_pair(table, name):
    Z = 3e3 - 4e3j
    rows = [pair_of(f, Z) for f in (1e3, 2e3, 3e3)]
    header = f"f/Hz,Rs,X,{name}"

    def lines(factor):
        cells = [[f"{1000 * (n + 1)}", "3e3", "-4e3", f"{r[name]:.5g}"] for n, r in enumerate(rows)]
        cells[1][3] = f"{factor * rows[1][name]:.5g}"
        return [header, *map(",".join, cells)]

    assert f"`{name}` agrees" in table(*lines(1)).attrs["columns"]
    with pytest.raises(InputError, match="line 3: `.*` (does not follow from|is not the freq)"):
        table(*lines(1.2))
    with pytest.raises(InputError, match="line 3: `.*` (does not follow from|is not the freq)"):
        table(*lines(-1))


def test_rounding_of_a_display_is_no_contradiction(table):
    sweeps = table("f/Hz,Rs,X,Cp (uF),D", "1e3,9000,-4,0.00,2250", "2e3,9000,-4,0.00,2250")
    assert "`D` agrees" in sweeps.attrs["columns"]


def test_what_was_taken_is_reported(table):
    sweeps = table("made by hand", "f/kHz,y,Z',-Z'',Status", "1,9,3,4,0", "2,9,3,4,0")
    assert sweeps.attrs["columns"] == (
        "header in line 2: frequency from `f/kHz`, Rs from `Z'`, X from `-Z''` (negated); not used:"
        " `y`, `Status`"
    )


def test_columns_may_be_named_by_hand(tmp_path):
    path = tmp_path / "bare.txt"
    path.write_text("some text\n1 7 3 4\n2 7 3 5\nend\n")
    sweeps = import_file(path, columns="f (kHz),-,Rs,-X")
    assert impedance(sweeps).ravel().tolist() == [3 - 4j, 3 - 5j]
    assert sweeps["frequency"].values.tolist() == [1000, 2000]
    assert sweeps.attrs["left_out"] == "line 4 (text from `end` on)"
    with pytest.raises(InputError, match="line 2: has 4 cells where --columns names 3"):
        import_file(path, columns="f,Rs,X")


@pytest.mark.parametrize(
    ("cells", "expected"),
    [
        (["1.5", "-2"], (1.5, -2)),
        (["1,5", "-2"], (1.5, -2)),
        (["1,234.5", "-2"], (1234.5, -2)),
        (["1.234,5", "-2,5"], (1234.5, -2.5)),
        (["1'234'567", "-2.5"], (1234567, -2.5)),
        (["1 234", "-2.5E-03"], (1234, -2.5e-3)),
        (["0,123", "-1,234"], (0.123, -1.234)),
        (["1,234E+02", "-1,234E+02"], (123.4, -123.4)),
        (["1.234", "-5.678"], (1.234, -5.678)),
    ],
)
def test_numbers_in_the_ways_of_many_countries(table, cells, expected):
    sweeps = table("f/Hz\tRs\tX", f"1\t{cells[0]}\t{cells[1]}")
    assert (sweeps["Rs"].item(), sweeps["X"].item()) == expected


def test_numbers_that_can_be_read_in_two_ways_are_refused(table):
    with pytest.raises(InputError, match="line 2: `Rs` can be read in two ways: 1,234 is 1.234 or"):
        table("f/Hz\tRs\tX", "1\t1,234\t-1,000")


def test_a_failed_reading_is_in_no_sweep(table):
    rows = ["1,1,-1", "2,9.9E+37,-1", "3,1,-1", "1,2,-1", "2,2,-1", "3,2,-1"]
    sweeps = table("f/Hz,R,X", *rows)
    assert sweeps["Rs"].values.tolist() == [[[1, 1]], [[2, 2]]]
    assert sweeps.attrs["left_out"] == (
        "line 3 (`R` is no reading); therefore 2 Hz is left out of all 2 sweeps"
    )


@pytest.mark.parametrize(
    "junk", ["nan", "inf", "OL", "--", "9.9E+37", "1e999", "#N/A", "-999999E+28"]
)
def test_codes_of_failed_readings(table, junk):
    sweeps = table("f/Hz,R,X", "1,1,-1", f"2,1,{junk}", "3,1,-1")
    assert sweeps["frequency"].values.tolist() == [1, 3]
    assert sweeps.attrs["left_out"] == "line 3 (`X` is no reading)"


def test_a_status_that_is_never_0_has_another_meaning(table):
    sweeps = table("f/Hz,R,X,Status", "1,1,-1,53", "2,1,-1,53", "3,1,-1,21")
    assert sweeps.sizes["frequency"] == 3 and "left_out" not in sweeps.attrs


def test_a_reading_in_a_comment_is_left_out_and_named(table):
    sweeps = table("f/Hz,R,X", "1,1,-1", "# 2,1,-1", "# a note, of 3, cells", "#N/A,1,-1", "3,1,-1")
    assert sweeps["frequency"].values.tolist() == [1, 3]
    assert sweeps.attrs["left_out"] == "line 3 (`# 2,1,-1`); line 5 (`f/Hz` is no reading)"


NAMES = {
    "D(U)-data": "D",
    "|Y|(S)-data": "admittance",
    "theta-y(deg)-data": "admittance phase",
    "Trace 1: Impedance: Rs (\u03a9)": "Rs",
    "Trace 2: Impedance: Imag (k\u03a9)": "X",
    "Trace Cp (F)": "Cp",
    "Impedance Phase Degrees (')": "phase",
    "-Phase (\u00b0)": "phase",
    "neg. Phase / \u00b0": "phase",
    "Z(Phz) [deg]": "phase",
    "tan(\u03b4)": "D",
    "Frequency in kHz": "frequency",
    "\u5468\u6ce2\u6570[Hz]": "frequency",
    "\uff3a\uff3b\u03a9\uff3d": "magnitude",
    "Zs'' [Ohms]": "X",
    "Z''(b)": "X",
    "Re(Y)/Ohm-1": "G",
    "Meas. Status": "status",
    "Trace 1: Gain: Magnitude (dB)": "gain level",
    "Trace 2: Gain: Phase (\u00b0)": "gain phase",
}


@pytest.mark.parametrize("name", NAMES)
def test_names_of_many_instruments(name):
    column = recognised(name)
    assert column is not None and column.holds == NAMES[name] and not column.problem


@pytest.mark.parametrize("name", ["y", "q", "b", "Rs_error", "Log f", "Q/mAh"])
def test_names_of_other_columns(name):
    column = recognised(name)
    assert column is None or column.problem


def test_text_ends_a_table_or_stands_within_it(table):
    sweeps = table("f/Hz,R,X", "1,1,-1", "END OF SWEEP", "f/Hz,R,X", "1,2,-1", "END", "a,b", "7,8")
    assert sweeps["Rs"].values.ravel().tolist() == [1, 2]
    assert sweeps.attrs["left_out"].startswith("line 3 (`END OF SWEEP`); lines 6-8 (text from")


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["f,R,X", "1,1,-1", "f,R,-X", "2,1,-1"], "line 1 and line 3 both begin tables"),
        (["f,R,X", "1,1,-1", "t,V,I", "2,1,-1"], "line 3: names no columns that are understood"),
        (["f;R;X", "1,2;3,4;5,6;7,8"], "line 2: has 4 cells where the header in line 1 has 3"),
        (["f R X", "1.00998.6-100.5", "2 3 -4"], "line 2: has 1 cells where the header in line 1"),
        (["f R X", "2 3 -4", "1.00998.6-100.5"], "line 3: has 1 cells where the header in line 1"),
        (["freq,R1,X1", "1,2,3"], "line 1 has `freq`, `R1`, `X1`; --columns f,Rs,X names columns"),
        (["1,2,3"], "line 1 has 3 numbers and no names above it; --columns"),
        (["f,|Z|,phase (deg)", "1,1,-45", "2,1,-270"], "line 3: the phase `phase (deg)` is beyond"),
        (["f,omega (rad/s),R,X", "1,1,1,-1"], "line 2: `omega (rad/s)` is not the frequency `f`"),
        (
            ["f,R,X", *(f"{f},1,-1" for f in (1, 2, 4, 8, 7, 6, 5, 3))],
            "line 6: the frequency turns back here, to others than those of the sweep from line 2",
        ),
        (["row,column,f,R,X", "1,1,1,1,-1", "1,0,1,1,-1"], "line 3: has row 1 with column 0"),
    ],
)
def test_tables_that_can_be_misread_are_refused(refusal, lines, message):
    assert message in refusal(*lines)


def test_unusual_numbers_are_reported(table):
    sweeps = table("f/Hz,R,X", "1,1,2", "2,-1,3", "3,1,-4")
    assert sweeps.attrs["warnings"] == (
        "Re Z < 0 in 1 of 3 readings, the first in line 3: no passive part has a phase beyond 90 "
        "degrees; Im Z > 0 in 67% of the readings, as of an inductor; if `X` holds the negative, "
        "name it with a minus in --columns"
    )


def test_points_between_thousands(table):
    rows = ["100;989;-100", "631;696;-426", "1.000;495;-447", "10.000;107;-79"]
    sweeps = table("f (Hz);Rs;X", *rows)
    assert sweeps["frequency"].values.tolist() == [100, 631, 1000, 10000]
    plain = table("f (kHz);Rs;X", "1.000;989;-100", "2.000;696;-426", "10.000;107;-79")
    assert plain["frequency"].values.tolist() == [1000, 2000, 10000]


def test_what_stands_between_header_and_readings_is_named(table):
    sweeps = table("f/Hz,R,X", "End Comments", "1,1,-1")
    assert sweeps.attrs["left_out"] == "line 2 (`End Comments`)"


def test_encodings_of_chinese_instruments(table):
    sweeps = table("频率(Hz),阻抗(Ω),相位(°)", "1,1,-90", encoding="gb18030")
    assert impedance(sweeps).item() == pytest.approx(-1j)


@pytest.mark.parametrize("encoding", ["cp932", "utf-16-le", "utf-16-be", "utf-8", "utf-16"])
def test_encodings_of_japanese_instruments(table, encoding):
    sweeps = table("周波数[Hz],Z[Ω],θ[°]", "1,1,-90", encoding=encoding)
    assert impedance(sweeps).item() == pytest.approx(-1j)
