"""Each promise of a page has a test, and each test that is named there exists."""

import ast
import re

import pytest

from .reading import ROOT, prose, text

SECTIONS = {"SECURITY.md": ("What is promised", "What listens, and where")}
"""Headings below which each sentence in a table promises, but for the first column."""
FILES, SERVED = "tests/front/test_hostile_names.py", "tests/hardware/page/test_served.py"
OFFLINE, METER = "tests/front/test_offline.py", "tests/hardware/virtual/test_server.py"
MODELS = "tests/localization/model/test_localizer_file.py"
SWEEPS, DATA = "tests/simulator/sweeps/", "tests/simulator/dataset/"
LOCALIZERS = "tests/localization/"
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
            f"{SWEEPS}test_inputs.py::test_small_files_that_declare_much_are_refused"
        ),
        "A scene opens no file on another computer.": (
            "tests/simulator/scene/test_maps.py::test_a_scene_opens_no_file_on_another_computer"
        ),
        "A scene inside sweeps or a model opens none.": (
            "tests/simulator/scene/test_files.py"
            "::test_no_command_opens_a_file_that_received_sweeps_name"
        ),
        "They are read without pickle.": f"{MODELS}::test_a_file_is_read_without_pickle",
        "Their sizes are checked before memory is reserved for them.": (
            f"{MODELS}::test_a_size_that_a_file_does_not_have_takes_no_memory"
        ),
        "A command replaces nothing that exists without `--overwrite`": (
            f"{SWEEPS}test_writing.py::test_what_exists_is_replaced_on_demand_only"
        ),
        "Files appear whole or not at all.": (
            f"{SWEEPS}test_writing.py::test_it_appears_whole_or_not_at_all"
        ),
        "Files carry checksums, which find damage": (
            f"{SWEEPS}test_mutations.py::test_spoilt_files_are_read_right_or_refused"
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
    },
    "docs/reference/files.md": {
        "`rcskin.read` opens each format as an": (
            f"{SWEEPS}test_files.py::test_numbers_are_read_back_to_the_same_bits"
        ),
        "A CSV holds sessions and times in columns.": (
            "tests/hardware/record/test_sessions.py"
            "::test_a_csv_of_a_recording_holds_what_its_netcdf_does"
        ),
        "Every file carries checksums": (
            f"{SWEEPS}test_spoilt.py::test_a_spoilt_file_is_refused_or_gives_the_same_bits"
        ),
        "A file that was cut off or damaged is refused in one line.": (
            f"{SWEEPS}test_spoilt.py::test_a_spoilt_file_is_refused_or_gives_the_same_bits"
        ),
        "If you change a CSV on purpose, delete its lines": (
            f"{SWEEPS}test_spoilt.py"
            "::test_a_csv_changed_on_purpose_is_read_without_the_lines_of_its_checksum"
        ),
        "Cp must follow from Rs and X.": (
            f"{SWEEPS}test_files.py::test_bad_tables_are_reported_with_file_and_line"
        ),
        "`rcskin check` compares the three in every file.": (
            f"{SWEEPS}test_spoilt.py::test_check_compares_Cp_with_Rs_and_X"
        ),
        "They are in double precision if `display_digits` is larger.": (
            f"{DATA}test_generate.py"
            "::test_more_digits_than_single_precision_keeps_are_stored_in_double"
        ),
        "Sweep k depends on the seed and on k only.": (
            f"{DATA}test_generate.py"
            "::test_a_sweep_depends_neither_on_how_many_there_are_nor_on_blocks"
        ),
        "The bytes depend on scene, number of sweeps, seed, tolerance and version only": (
            f"{DATA}test_generate.py::test_any_number_of_processes_gives_the_same_bytes"
        ),
        "CSV has one line for each sweep, interface and frequency.": (
            f"{DATA}exports/test_tables.py::test_csv_is_read_back_as_the_same_sweeps"
        ),
        "Parquet has one row for each sweep": (
            f"{DATA}exports/test_tables.py::test_parquet_has_one_row_a_sweep"
        ),
        "NetCDF keeps everything.": (f"{DATA}exports/test_tables.py::test_netcdf_keeps_everything"),
        "A model file contains no code.": (
            f"{LOCALIZERS}model/test_localizer_file.py"
            "::test_a_forged_description_is_refused_by_what_is_wrong"
        ),
        "A note names the version of rcskin if it differs from yours.": (
            f"{LOCALIZERS}model/test_localizer_model.py::test_a_model_knows_what_it_was_trained_on"
        ),
        "A file of another layout": (
            f"{LOCALIZERS}model/test_localizer_file.py"
            "::test_a_file_of_an_older_version_says_to_train_again"
        ),
        "A model refuses sweeps of another skin": (
            f"{LOCALIZERS}test_same_skin.py::test_sweeps_of_another_skin_are_refused_and_insisted_on"
        ),
        "| a file, or a folder of data | refused, unless `--overwrite` is given": (
            f"{SWEEPS}test_writing.py::test_what_exists_is_replaced_on_demand_only"
        ),
        "| measured sweeps | refused, unless `--overwrite-measured` is given": (
            f"{SWEEPS}test_writing.py::test_measured_sweeps_need_a_demand_of_their_own"
        ),
        "| a `.nc`, `.csv` or `.zarr` that is damaged | refused": (
            f"{SWEEPS}test_writing.py::test_damage_makes_measured_sweeps_no_easier_to_lose"
        ),
        "nothing is computed, and a line says so; `--overwrite` makes it anew": (
            f"{DATA}test_dataset_command.py::test_a_complete_data_set_is_made_anew_on_demand_only"
        ),
        "| a folder that `export --format lerobot` did not write | refused": (
            f"{DATA}exports/test_refusals.py::test_no_option_replaces_a_folder_of_other_files"
        ),
        "A command looks before it computes.": (
            f"{SWEEPS}test_writing.py::test_a_refusal_does_not_look_into_the_file"
        ),
        "If a file appears while the command computes, it stays.": (
            f"{SWEEPS}test_writing.py"
            "::test_what_appears_meanwhile_is_kept_and_so_is_what_is_finished"
        ),
        "They also count as measured if they do not hold the tolerance of a simulation.": (
            f"{SWEEPS}test_writing.py::test_measured_sweeps_need_a_demand_of_their_own"
        ),
        "that was interrupted goes on with the same command.": (
            f"{DATA}test_resume.py::test_killed_several_times_it_ends_with_the_same_bytes"
        ),
        "the functions that write take `overwrite=True`": (
            "tests/front/test_front_door.py::test_what_exists_is_replaced_on_demand_only"
        ),
        "A file is written completely or not at all.": (
            f"{SWEEPS}test_writing.py::test_it_appears_whole_or_not_at_all"
        ),
        "It gets its name when all of it is on the disk.": (
            f"{SWEEPS}test_writing.py::test_what_is_renamed_is_on_the_disk_first_and_its_name_after"
        ),
        "A symbolic link stays, and its target is replaced.": (
            f"{SWEEPS}test_writing.py::test_a_symbolic_link_stays_and_its_target_is_replaced"
        ),
        "If another program holds the target open (Windows), the finished result stays": (
            f"{SWEEPS}test_writing.py"
            "::test_what_is_finished_stays_where_the_target_is_open_elsewhere"
        ),
        "A command that is killed may leave an unfinished file, `.rcskin-*`": (
            f"{SWEEPS}test_writing.py::test_a_killed_writer_leaves_an_unfinished_file_and_no_output"
        ),
        "the next command that looks for that `.zarr` puts the earlier one back.": (
            f"{SWEEPS}test_writing.py"
            "::test_a_folder_whose_writer_was_killed_between_two_renames_is_put_back"
        ),
        "compiled kernels; a damaged file is made again": (
            "tests/simulator/test_kernel_cache.py"
            "::test_kernels_go_into_the_users_cache_and_a_spoilt_one_is_made_again"
        ),
        "Nothing is written into the installation.": (
            "tests/simulator/test_kernel_cache.py"
            "::test_kernels_go_into_the_users_cache_and_a_spoilt_one_is_made_again"
        ),
        "If a folder cannot be written, each process compiles its own kernels.": (
            "tests/simulator/test_kernel_cache.py::test_a_cache_that_cannot_be_written_is_done_without"
        ),
        "| 1 | any other failure: a tolerance that cannot be kept": (
            "tests/simulator/test_cli.py"
            "::test_a_tolerance_out_of_reach_ends_with_code_1_and_no_file"
        ),
        "a broken law (`check`)": (
            "tests/simulator/check/test_command.py"
            "::test_a_broken_law_ends_with_code_1_and_names_sweep_and_frequencies"
        ),
        "no answer of a meter (`live`)": (
            "tests/hardware/live/test_command.py::test_an_unplugged_meter_is_given_up_with_code_1"
        ),
        "| 2 | an input or option is refused, in one line |": (
            "tests/simulator/test_cli.py::test_bad_input_ends_with_one_line_and_code_2"
        ),
        "| 3 | done, but the meter did not confirm that a setting was put back |": (
            "tests/hardware/record/test_left_as_found.py"
            "::test_a_good_recording_that_leaves_it_changed_says_so_in_its_code"
        ),
        "ended by a signal: 130 by Ctrl-C": (
            "tests/simulator/test_interrupt.py"
            "::test_work_that_goes_on_is_ended_and_leaves_nothing_unfinished"
        ),
    },
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
def test_promises_stand_on_their_page(page):
    words = " ".join(prose(page).split())
    assert [each for each in PROMISES[page] if each not in words] == []


@pytest.mark.parametrize("page", SECTIONS)
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
