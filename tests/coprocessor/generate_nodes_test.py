"""Runs scripts/capsoc_tools/generate/nodes.py on small lists and on the real one."""

import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from harness import SOURCE

CTEST = {"name": "coprocessor: the probe's nodes are made of their list", "whole": True}

GENERATOR = [SOURCE / "scripts" / "tool", "nodes"]
LIST = SOURCE / "models" / "coprocessor" / "nodes.def"

# Three lines, so that the nodes of a test start on line 4.
HEAD = """// a list
FORMAT(flag, 1, false, 0, word)
FORMAT(q1_31, 32, true, 31, number)
"""
A = 'NODE(a, 0, calibrator, flag, packet.a, end, "dut.a")\n'


class Generator(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.output = Path(self.folder.name) / "out"

    def run_on(self, text):
        source = Path(self.folder.name) / "test.def"
        source.write_text(text, encoding="utf-8")
        return self.run_generator(source, self.output)

    def run_generator(self, *arguments):
        return subprocess.run([sys.executable, *GENERATOR, *arguments], capture_output=True, text=True, check=False)

    def made(self, part):
        return (self.output / f"coprocessor_node_{part}.svh").read_text(encoding="utf-8")

    def expect_error(self, text, line, *words):
        result = self.run_on(text)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
        self.assertIn(f"test.def:{line}: ", result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)

    # What it writes

    def test_the_list_of_the_project_is_accepted_and_each_node_has_its_ports_and_is_driven_once(self):
        result = self.run_generator(LIST, self.output)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))
        nodes = re.findall(r"^NODE\((\w+),", LIST.read_text(encoding="utf-8"), re.MULTILINE)
        self.assertGreater(len(nodes), 0)
        ports = [f"node_{name}_o" for name in nodes] + [f"model_{name}_i" for name in nodes]
        self.assertEqual(re.findall(r"(?:output|input ) logic \[63:0\] (\w+)", self.made("ports")), ports)
        driven = re.findall(r"^ *(?:assign )?node_(\w+)_o <?= ", self.made("captures"), re.MULTILINE)
        self.assertEqual(sorted(driven), sorted(nodes))

    def test_the_last_port_has_no_comma(self):
        self.run_on(HEAD + A)
        self.assertTrue(self.made("ports").endswith("node_a_o,\n  input  logic [63:0] model_a_i\n"))

    def test_a_value_is_extended_as_its_format_says(self):
        self.run_on(HEAD + A + 'NODE(b, 0, calibrator, q1_31, packet.b, end, "dut.b")\n')
        self.assertIn("(input logic [0:0] word);\n    extended_flag = {63'd0, word};", self.made("captures"))
        self.assertIn("(input logic [31:0] word);\n    extended_q1_31 = {{32{word[31]}}, word};", self.made("captures"))
        self.assertIn("node_b_o <= extended_q1_31(dut.b);", self.made("captures"))

    def test_a_value_is_taken_when_the_list_says(self):
        self.run_on(
            HEAD + A + 'NODE(b, 1, calibrator, flag, packet.b, wire, "dut.b")\n'
            'NODE(c, 2, calibrator, flag, f(packet.c), "dut.x && (dut.y, 1)", "{dut.c[1], dut.c[0]}")\n'
            'NODE(d, commit_stage, calibrator, flag, d(), end, "dut.d")\n'
        )
        text = re.sub("`line .*\n", "", self.made("captures"))
        self.assertIn("  assign node_b_o = extended_flag(dut.b);", text)
        self.assertIn("if (ends[0]) begin\n      node_a_o <= ", text)
        self.assertIn("if (dut.x && (dut.y, 1)) begin\n      node_c_o <= extended_flag({dut.c[1], dut.c[0]});", text)
        self.assertIn("if (ends[4]) begin\n      node_d_o <= ", text)

    def test_a_tools_message_names_the_line_of_the_list(self):
        self.run_on(HEAD + A)
        self.assertIn('`line 4 "test.def" 0\n      node_a_o', self.made("captures"))

    def test_a_file_that_would_not_change_is_left_alone(self):
        self.run_on(HEAD + A)
        before = [path.stat().st_mtime_ns for path in sorted(self.output.iterdir())]
        self.run_on(HEAD + A)
        self.assertEqual([path.stat().st_mtime_ns for path in sorted(self.output.iterdir())], before)

    # What it refuses

    def test_a_second_node_or_format_of_a_name(self):
        self.expect_error(HEAD + A + A, 5, "node a", "line 4")
        self.expect_error(HEAD + "FORMAT(flag, 2, false, 0, word)\n", 4, "format flag", "line 2")

    def test_what_is_no_name(self):
        self.expect_error(HEAD + A.replace("NODE(a", "NODE(a-b"), 4, "'a-b'")

    def test_an_unknown_stage_or_one_out_of_order(self):
        self.expect_error(HEAD + A.replace("0", "5"), 4, "stage '5'", "commit_stage")
        self.expect_error(HEAD + A.replace("0", "1") + A.replace("(a", "(b"), 5, "move it up")

    def test_an_unknown_unit(self):
        self.expect_error(HEAD + A.replace("calibrator", "travel"), 4, "unit 'travel'", "turn_judge")

    def test_an_unknown_format(self):
        self.expect_error(HEAD + A.replace("flag", "flags"), 4, "'flags'", "flag, q1_31")

    def test_a_format_that_is_none(self):
        for wrong in (
            "0, false, 0, word",
            "65, false, 0, word",
            "x, false, 0, word",
            "8, no, 0, word",
            "8, true, 9, number",
            "8, true, 0, colour",
        ):
            self.expect_error(HEAD + f"FORMAT(f, {wrong})\n" + A, 4, "f ", "write")

    def test_a_time_or_a_value_that_is_none(self):
        self.expect_error(HEAD + A.replace("end", "later"), 4, "'later'", '"condition"')
        self.expect_error(HEAD + A.replace('"dut.a"', "dut.a"), 4, '"expression"')
        self.expect_error(HEAD + A.replace('"dut.a"', '""'), 4, '"expression"')

    def test_arguments_too_few_too_many_or_broken(self):
        self.expect_error(HEAD + A.replace("packet.a, ", ""), 4, "6 arguments", "7")
        self.expect_error(HEAD + A.replace("packet.a", "a, b"), 4, "8 arguments")
        self.expect_error(HEAD + "FORMAT(f, 3)\n", 4, "2 arguments", "5")
        self.expect_error(HEAD + A.replace('a")', "a)"), 4, "arguments")

    def test_a_line_that_is_none_of_the_lists(self):
        self.expect_error(HEAD + A + "NODES(b)\n", 5, "NODE(...)")
        self.expect_error(HEAD + 'NODE(a, 0, calibrator, flag,\n  packet.a, end, "dut.a")\n', 4, "one a line")

    def test_an_empty_list(self):
        self.expect_error(HEAD, 1, "no NODE")

    def test_what_cannot_be_read_or_written(self):
        missing = self.run_generator("/nonexistent/nodes.def", self.output)
        self.assertEqual(missing.returncode, 2)
        self.assertIn("/nonexistent/nodes.def", missing.stderr)
        self.assertNotIn("Traceback", missing.stderr)
        source = Path(self.folder.name) / "bytes.def"
        source.write_bytes(b"\xff\xfe")
        self.assertEqual(self.run_generator(source, self.output).returncode, 2)
        self.assertEqual(self.run_generator(LIST, source).returncode, 2)
        self.assertEqual(self.run_generator().returncode, 2)


if __name__ == "__main__":
    unittest.main()
