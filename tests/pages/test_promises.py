"""Each promise of a page has a test, and each test that is named there exists."""

import ast
import re

import pytest

from .reading import ROOT, text

SECTIONS = {"SECURITY.md": ("What is promised", "What listens, and where")}
"""Headings below which each sentence in a table is a promise, but for the first column."""
FILES, SERVED = "tests/front/test_hostile_names.py", "tests/hardware/page/test_served.py"
OFFLINE, METER = "tests/front/test_offline.py", "tests/hardware/virtual/test_server.py"
MODELS = "tests/localization/model/test_localizer_file.py"
PROMISES = {
    "SECURITY.md": {
        "They are data: no text from a file is run.": f"{FILES}::test_no_content_of_a_file_is_run",
        "No text from a file is put into a page as markup.": (
            f"{FILES}::test_every_output_shows_hostile_names_and_obeys_none"
        ),
        "No text from a file is sent to a terminal as control codes.": (
            "tests/simulator/test_safe_text.py::test_tables_titles_and_lines_show_it_whole"
        ),
        "Numbers are checked against ranges before memory is reserved": (
            "tests/simulator/sweeps/test_inputs.py::test_small_files_that_declare_much_are_refused"
        ),
        "A scene opens no file on another computer.": (
            "tests/simulator/scene/test_map_file.py::test_a_scene_opens_no_file_on_another_computer"
        ),
        "A scene inside sweeps or a model opens none.": (
            "tests/simulator/scene/test_travelling.py"
            "::test_no_command_opens_a_file_that_received_sweeps_name"
        ),
        "They are read without pickle.": f"{MODELS}::test_a_file_is_read_without_pickle",
        "Types that are not on a list are refused.": (
            f"{MODELS}::test_a_file_of_a_foreign_type_is_refused"
        ),
        "A command replaces only what the same command made, and files appear whole": (
            "tests/simulator/sweeps/test_writing.py::test_it_appears_whole_or_not_at_all"
        ),
        "Files carry checksums, which find damage": (
            "tests/simulator/sweeps/test_mutations.py::test_spoilt_files_are_read_right_or_refused"
        ),
        "`--press-with` runs the program that you name, without a shell.": (
            "tests/hardware/record/test_operators.py"
            "::test_a_pressing_command_gets_the_press_without_a_shell"
        ),
        "`--switch-with` does the same.": (
            "tests/hardware/switch/test_by_hand.py"
            "::test_a_command_gets_the_name_as_one_word_without_a_shell"
        ),
        "A name from a file is no option of that program.": (
            "tests/hardware/switch/test_by_hand.py"
            "::test_a_name_from_a_scene_is_neither_an_option_nor_a_command"
        ),
        "rcskin connects only to addresses that you name": (
            f"{OFFLINE}::test_no_command_looks_up_a_host_or_calls_or_listens_to_another_computer"
        ),
        "`meter identify` without a name also asks the networks": (
            "tests/hardware/test_cli.py"
            "::test_only_a_search_without_names_asks_the_networks_of_the_computer"
        ),
        "No telemetry, no search for updates.": (
            f"{OFFLINE}::test_no_native_code_looks_for_another_computer"
        ),
        "Each page that rcskin writes is one file, which loads nothing": (
            f"{OFFLINE}::test_no_page_loads_anything_from_elsewhere"
        ),
        "It listens at 127.0.0.1, or where `--host` says.": (
            f"{METER}::test_only_the_port_of_the_meter_listens_where_it_is_asked_to"
        ),
        "It obeys everyone who reaches it, as a real meter does.": (
            f"{METER}::test_a_line_may_come_in_pieces"
        ),
        "The control port listens at 127.0.0.1 only.": (
            f"{METER}::test_only_the_port_of_the_meter_listens_where_it_is_asked_to"
        ),
        "It obeys who has the token.": (
            "tests/hardware/virtual/test_port_access.py"
            "::test_a_request_without_the_token_is_refused_and_hung_up"
        ),
        "The token lies in a file that only you can read": (
            "tests/hardware/virtual/test_port_access.py"
            "::test_the_token_is_in_a_file_that_only_the_user_reads_while_it_is_served"
        ),
        "They listen at 127.0.0.1 only.": (
            f"{OFFLINE}::test_no_command_looks_up_a_host_or_calls_or_listens_to_another_computer"
        ),
        "They answer who has the token in the page's address": f"{SERVED}::test_who_is_refused",
    }
}
"""The beginning of each promise, and the test that would fail if it did not hold."""


def promised(page):
    """The sentences in the tables of a page's sections that promise."""
    sections = re.split(r"^## ", text(page), flags=re.MULTILINE)[1:]
    for section in sections:
        heading, *lines = section.splitlines()
        rows = [line for line in lines if line.startswith("|")][2:]
        for row in rows if heading in SECTIONS[page] else ():
            for cell in re.split(r" *\| *", row.strip("| "))[1:]:
                yield from re.split(r"(?<=[.!?]) +(?=[A-Z`])", cell)


@pytest.mark.parametrize("page", PROMISES)
def test_every_promise_has_one_test_and_every_test_a_promise(page):
    found = {
        each: [key for key in PROMISES[page] if each.startswith(key)] for each in promised(page)
    }
    assert {*map(len, found.values())} == {1}, [key for key in found if len(found[key]) != 1]
    assert sorted(key for keys in found.values() for key in keys) == sorted(PROMISES[page])


@pytest.mark.parametrize("named", sorted({n for each in PROMISES.values() for n in each.values()}))
def test_every_test_of_a_promise_exists(named):
    path, name = named.split("::")
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    functions = {each.name: each for each in tree.body if isinstance(each, ast.FunctionDef)}
    assert not any("skip" in ast.unparse(each) for each in functions[name].decorator_list)
