"""C code gives the answers of its model, compiled without warnings."""

import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from rcskin.localization.export.c_file import (
    TOLERANCE,
    c_files,
    comment,
    identifier,
    number,
    string,
)
from rcskin.localization.export.onnx_check import inputs_of
from rcskin.localization.export.portable import portable
from rcskin.localization.model.training import train
from rcskin.simulator.sweeps import InputError

COMPILER = next(filter(shutil.which, ("cc", "gcc", "clang")), None)
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler: cc, gcc or clang")
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-Wpedantic", "-Wconversion", "-O1")
CASES = (
    "the paper's",
    "the paper's, changes",
    "the paper's, two classes",
    "components",
    "touches",
    "network",
    "network of two",
)
PREFIXES = {"recent": "baseline_", "opening": "opening_"}


def main_of(model, parts):
    """A program that localizes sweeps of floats from its input, and prints the answers."""
    own = ["Rs", "X", "Cp"]
    header = c_files(model, parts, "skin").header
    call = header.split("int skin_localize(")[1].split(");")[0]
    inputs = [name for name in own if f"const float *{name}," in call]
    stored = [name for name in ("Rs", "X") if "_baseline_add" in header]
    baselines = [name for name in PREFIXES if f"*{name}," in call]
    count = "SKIN_INTERFACES * SKIN_FREQUENCIES"
    arrays = [*inputs, *(f"{each}_{name}" for each in baselines for name in stored)]
    lines = ['#include "skin.h"', "#include <stdio.h>", "int main(void) {"]
    lines += [f"static float {each}[{count}];" for each in arrays]
    lines += [f"skin_baseline {each};" for each in baselines]
    lines += ["float p[SKIN_CLASSES], novelty;", "for (;;) {"]
    for each in arrays:
        lines += [f"if (fread({each}, sizeof(float), {count}, stdin) != {count}) return 0;"]
    for each in baselines:
        given = ", ".join(f"{each}_{name}" for name in stored)
        lines += [f"skin_baseline_clear(&{each});"]
        lines += [f"if ({each}_Rs[1] == {each}_Rs[1]) skin_baseline_add(&{each}, {given});"]
    given = [*inputs, *(f"&{each}" for each in baselines), "p", "&novelty"]
    lines += [f'printf("%d", skin_localize({", ".join(given)}));']
    lines += ['printf(" %.9g", (double)novelty);']
    lines += ['for (int k = 0; k < SKIN_CLASSES; k++) printf(" %.9g", (double)p[k]);']
    lines += ['printf("\\n");', "}", "}"]
    names = [*inputs, *(f"{PREFIXES[each]}{name}" for each in baselines for name in stored)]
    return "\n".join(lines), names


def answers_of(model, sweeps, folder):
    """Labels, novelty and probabilities that the compiled code of a model gives."""
    parts = portable(model)
    made = c_files(model, parts, "skin")
    program, names = main_of(model, parts)
    texts = {"skin.c": made.source, "skin.h": made.header, "main.c": program}
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="ascii")
    built = [COMPILER, *STRICT, "skin.c", "main.c", "-o", "skin", "-lm"]
    subprocess.run(built, cwd=folder, check=True)
    values = inputs_of(names, model, sweeps)
    rows = np.stack([values[name].reshape(sweeps.sizes["sweep"], -1) for name in names], axis=1)
    given = rows.astype(np.float32).tobytes()
    printed = subprocess.run([folder / "skin"], input=given, check=True, capture_output=True)
    table = np.array([line.split() for line in printed.stdout.decode().splitlines()], float)
    return np.array([*parts.labels, "cannot tell"])[table[:, 0].astype(int)], table[:, 2:]


def agree(model, sweeps, folder):
    """Compares answers; labels may differ where probabilities tie, or at the guard's limit.

    Probabilities of a model that counts votes jump where a score is 0.
    """
    labels, probabilities = answers_of(model, sweeps, folder)
    expected = model.answers(sweeps)
    off = np.abs(probabilities - expected.chances).max(axis=1)
    assert (off < TOLERANCE).mean() > 0.99
    best = np.sort(expected.chances, axis=1)
    sure = best[:, -1] - best[:, -2] > 2 * TOLERANCE
    assert (labels[sure] == expected.labels[sure]).mean() > 0.995
    return off


@needs_compiler
@pytest.mark.parametrize("case", CASES)
def test_compiled_code_answers_as_its_model(trained, make_sessions, tmp_path, case):
    agree(trained(case), make_sessions(seed=50, spread=0.3, repetitions=20), tmp_path)


@needs_compiler
def test_readings_that_are_skipped(make_sessions, few_readings, tmp_path):
    model = train(few_readings(make_sessions()), "pixel", "ksvm-ovo", quantities="Rs,Cp")
    agree(model, few_readings(make_sessions(seed=50)), tmp_path)


@needs_compiler
def test_without_a_baseline_there_is_no_answer(trained, make_sessions, tmp_path):
    model = trained("the paper's, changes")
    unseen = make_sessions(seed=50, sessions=1, rests=1)
    labels, probabilities = answers_of(model, unseen.isel(sweep=[0]), tmp_path)
    assert labels == "cannot tell" and np.allclose(probabilities, 1 / len(model.classes))


def test_the_header_says_what_the_code_takes(trained):
    model = trained("network")
    made = c_files(model, portable(model), "My skin-2")
    for line in (
        "predicts:     pixel, by network",
        "#define MY_SKIN_2_FREQUENCIES 6",
        "void my_skin_2_baseline_add(my_skin_2_baseline *baseline, const float *Rs, const float",
        " *   X: ohm",
        f"{made.flash} bytes of tables",
    ):
        assert line in made.header
    assert 'my_skin_2_interfaces[MY_SKIN_2_INTERFACES] = { "left", "right" };' in made.source
    small = c_files(model, portable(model, guarded=False), "skin")
    assert small.flash < made.flash and "novelty" not in small.header


@pytest.mark.parametrize("case", ["gaussian", "positions"])
def test_what_has_no_code(trained, case):
    model = replace(trained(case), source="m.npz")
    with pytest.raises(InputError, match="m.npz: C code is for .*, and this "):
        c_files(model, portable(model), "skin")


def test_text_and_numbers_in_c():
    assert string('a"\\?é\n') == '"a\\042\\134\\077\\303\\251\\012"'
    assert [number(each) for each in (3, 1e-12, 0.1)] == ["3.0f", "1e-12f", "0.1f"]
    assert identifier("2nd Skin!") == "model_2nd_skin"
    assert comment("a */ b\nc") == "a * / b\\nc"
