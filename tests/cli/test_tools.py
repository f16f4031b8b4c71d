#!/usr/bin/env python3
"""Tests of the project's own tools: check_style.py finds what it promises, pf2f90.py refuses what
pFUnit or the project does not allow."""
import contextlib
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ.get("KJOINT_SOURCE_DIR", pathlib.Path(__file__).parents[2]))
sys.path.insert(0, str(SOURCE / "tools"))
import check_style

GOOD = """\
!> A module that follows the guide.
module kj_thing
   use kj_kinds, only: wp
   implicit none
   private

   public :: thing_t, double

   !> A thing
   type :: thing_t
      real(wp) :: size = 0.0_wp
   end type thing_t

contains

   !> Twice a value
   pure real(wp) function double(x)
      real(wp), intent(in) :: x

      double = 2*x    ! print * in a comment
   end function double
end module kj_thing
"""
KINDS = """\
!> Kinds.
module kj_kinds
   implicit none
   private

   integer, parameter, public :: wp = 8
end module kj_kinds
"""


class Style(unittest.TestCase):
    def check(self, text, folder="base", name="kj_thing", listed=True, kinds=KINDS,
              other=None):
        """Findings in a tree with this module, kj_kinds and perhaps kj_law, without the file name."""
        with tempfile.TemporaryDirectory() as tree:
            root = pathlib.Path(tree)
            for path, content in ((f"src/{folder}/{name}.f90", text),
                                  ("src/base/kj_kinds.f90", kinds)):
                (root / path).parent.mkdir(parents=True, exist_ok=True)
                (root / path).write_text(content)
            (root / "tests" / "unit").mkdir(parents=True)
            (root / "tests" / "CMakeLists.txt").write_text("")
            files = f"src/base/kj_kinds.f90 {f'src/{folder}/{name}.f90' if listed else ''}"
            if other:
                files += f" src/{other[0]}/kj_law.f90"
                (root / "src" / other[0]).mkdir(exist_ok=True)
                (root / "src" / other[0] / "kj_law.f90").write_text(other[1])
            (root / "CMakeLists.txt").write_text(files)
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                code = check_style.main(root)
            found = [line.split(":", 1)[1] for line in said.getvalue().splitlines()
                     if ".f90:" in line]
            self.assertEqual(1 if found else 0, code)
            return found

    def finds(self, wanted, text, **where):
        found = self.check(text, **where)
        self.assertEqual(1, len(found), found)
        self.assertIn(wanted, found[0])

    def test_a_good_module_passes(self):
        self.assertEqual([], self.check(GOOD))

    def test_lines_and_files_have_a_length(self):
        self.finds("101 columns", GOOD.replace("!> A thing", "!> A thing".ljust(98, "x")))
        self.finds("more than 600", GOOD + "!\n" * 600)
        self.finds("more than 400 without", GOOD + "!\n" * 400)
        self.assertEqual([], self.check("!> One file: the laws share their terms.\n" + GOOD + "!\n" * 400))
        self.finds("trailing blank", GOOD.replace("contains", "contains "))
        self.finds("tab", GOOD.replace("2*x", "2*\tx"))

    def test_rows_of_tables_may_be_longer(self):
        row = "      thing_t(1._wp), &".ljust(132, "x")
        self.assertEqual([], self.check(GOOD.replace("contains\n", f"contains\n{row}\n")))
        self.finds("more than 132", GOOD.replace("contains\n", f"contains\n{row}x\n"))

    def test_module_and_file_have_one_name(self):
        self.finds("differ in name", GOOD, name="kj_other")
        self.finds("implicit none", GOOD.replace("   implicit none\n", ""))
        self.finds("private", GOOD.replace("   private\n", ""))

    def test_every_source_is_built(self):
        self.finds("not in CMakeLists.txt", GOOD, listed=False)

    def test_use_names_what_it_takes_from_its_folder_or_one_before(self):
        self.finds("without only", GOOD.replace(", only: wp", ""))
        self.finds("hdf5 outside", GOOD.replace("   implicit", "   use hdf5, only: a\n   implicit"))
        kinds = KINDS.replace("   implicit", "   use kj_thing, only: double\n   implicit")
        alone = GOOD.replace("   use kj_kinds, only: wp\n", "")
        for folder in ("joint", "deck", "model", "legacy", "consistent", "history",
                       "files", "api", "capi", "cli"):
            self.assertEqual([], self.check(GOOD, folder=folder))
            self.assertEqual([f"3: base uses kj_thing of the later folder {folder}"],
                             self.check(alone, folder=folder, kinds=kinds))
        self.finds("without a place in the order", GOOD, folder="attic")

    def test_a_formulation_is_used_by_itself_and_by_api_alone(self):
        for folder in ("legacy", "consistent"):
            law = KINDS.replace("kj_kinds", "kj_law")
            text = GOOD.replace("kj_kinds", "kj_law")
            self.assertEqual([], self.check(text, folder="api", other=(folder, law)))
            self.assertEqual([], self.check(text, folder=folder, other=(folder, law)))
            self.finds(f"of the formulation {folder}", text, folder="history", other=(folder, law))

    def test_modules_that_use_each_other_are_a_circle(self):
        kinds = KINDS.replace("   implicit", "   use kj_thing, only: double\n   implicit")
        self.assertEqual(["3: a circle by the use of kj_thing", "3: a circle by the use of kj_kinds"],
                         self.check(GOOD, kinds=kinds))

    def test_the_library_is_silent(self):
        for line in ("print *, x", "write (*, *) x", "stop 1", "error stop", "if (x > 0) stop",
                     "write (error_unit, '(a)') 'x'"):
            text = GOOD.replace("      double = ", f"      {line}\n      double = ")
            self.finds("does not print", text)
            self.assertEqual([], self.check(text, folder="cli"))
        self.finds("environment", GOOD.replace(
            "      double = ", "      call get_environment_variable(x)\n      double = "))

    def test_modules_hold_no_variables(self):
        self.finds("module variable", GOOD.replace("contains", "   integer :: n = 0\n\ncontains"))
        self.finds("save", GOOD.replace("      double = ", "      save\n      double = "))

    def test_long_procedures_and_missing_comments_are_found(self):
        long = "      !\n" * 80 + "      double = "
        self.finds("more than 80", GOOD.replace("      double = ", long))
        self.finds("public double without", GOOD.replace("   !> Twice a value\n", ""))
        self.finds("public thing_t without", GOOD.replace("   !> A thing\n", ""))


class Translator(unittest.TestCase):
    def translate(self, text, name="test_a"):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / f"{name}.pf"
            path.write_text(text)
            tool = SOURCE / "tools" / "pf2f90.py"
            return subprocess.run([sys.executable, tool, folder, path], capture_output=True,
                                  text=True, check=False).stderr.strip()

    def test_the_subset_is_taken_and_the_rest_refused(self):
        good = ("module test_a\nuse funit\ncontains\n@test\nsubroutine it_is()\n"
                "@assertEqual(1, 1)\nend subroutine\nend module\n")
        self.assertEqual("", self.translate(good))
        for old, new, message in (
                ("@assertEqual(1, 1)", "@assertSomething(1)", "not in the allowed subset"),
                ("@assertEqual(1, 1)", "@assertEqual(1, &", "not in the allowed subset"),
                ("@test\n", "@test(npes=[1])\n", "not in the allowed subset"),
                ("it_is()", "it_is(n)", "without arguments"),
                ("it_is", "x" * 45, "44 characters"),
                ("@test\n", "", "no test"),
                ("module test_a", "module test_b", "name of the file")):
            self.assertIn(message, self.translate(good.replace(old, new, 1)))


class Version(unittest.TestCase):
    def test_all_files_name_the_version_of_kj_version(self):
        found = [re.search(pattern, (SOURCE / path).read_text(), re.M).group(1) for path, pattern in (
            ("src/base/kj_version.f90", r"KJOINT_VERSION = '(.*)'"),
            ("fpm.toml", r'^version = "(.*)"'),
            ("CITATION.cff", r"^version: (.*)"))]
        self.assertEqual(1, len(set(found)), found)


if __name__ == "__main__":
    unittest.main()
