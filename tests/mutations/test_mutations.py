# SPDX-License-Identifier: BSD-3-Clause
"""The table of mutants fits the sources, and its changes are written as they should be."""

import sys
import unittest

sys.dont_write_bytecode = True

from table import Mutant, changed_source, locate, read_table


def mutant(number, source, old, new, before="", after="", **more):
    found = Mutant(f"m{number}", "bound", "promise", "", "f", before, old, new, after, "", number=number, **more)
    found.begin = source.index(before + old) + len(before)
    found.end = found.begin + len(old)
    return found


class Table(unittest.TestCase):
    def test_each_row_fits_the_sources(self):
        mutants = read_table()
        self.assertEqual(locate(mutants), [])
        self.assertGreaterEqual(len(mutants), 200)

    def test_a_text_that_occurs_twice_or_not_at_all_is_reported(self):
        rows = [Mutant("m", "bound", "promise", "", "tests/mutations/mutant.h", "", old, "x", "", "here")
                for old in ("inline", "no such text", "std::atoi(text)")]
        self.assertEqual(len(locate(rows)), 2)


class Changes(unittest.TestCase):
    def written(self, source, *mutants):
        return changed_source(mutants, source).replace('#include "keepout/mutant.h"\n', "")

    def test_an_expression_is_chosen(self):
        source = "x = a + b;"
        self.assertEqual(self.written(source, mutant(3, source, "a + b", "a - b")),
                         "x = (keepout_mutants::is(3) ? (a - b) : (a + b));")

    def test_a_statement_is_chosen(self):
        source = "if (x) return;"
        self.assertEqual(self.written(source, mutant(3, source, "return;", "")),
                         "if (x) { if (keepout_mutants::is(3)) {  } else { return; } }")

    def test_mutants_of_one_place_are_alternatives(self):
        source = "x = a;"
        self.assertEqual(self.written(source, mutant(1, source, "a", "b"), mutant(2, source, "a", "c")),
                         "x = (keepout_mutants::is(1) ? (b) : ((keepout_mutants::is(2) ? (c) : (a))));")

    def test_a_place_in_another_one_is_in_its_original(self):
        source = "f(a);"
        self.assertEqual(self.written(source, mutant(1, source, "f(a);", ""), mutant(2, source, "a", "b")),
                         "{ if (keepout_mutants::is(1)) {  } else { f((keepout_mutants::is(2) ? (b) : (a))); } }")

    def test_a_constant_expression_becomes_a_constant(self):
        source = "constexpr double x = 1.0;"
        self.assertEqual(self.written(source, mutant(1, source, "1.0", "2.0")),
                         "const double x = (keepout_mutants::is(1) ? (2.0) : (1.0));")


if __name__ == "__main__":
    unittest.main()
