"""Runs scripts/capsoc_tools/generate/registers.py on small descriptions and on the real one."""

import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from harness import SOURCE

CTEST = {"name": "registers: the generator writes what it read and explains what it cannot", "whole": True}

GENERATOR = [SOURCE / "scripts" / "tool", "registers"]
DESCRIPTION = SOURCE / "models" / "registers" / "capsoc.svd"

# Four lines, so that the registers of a test start on line 5.
HEAD = """<device><name>d</name><description>D</description><peripherals><peripheral><name>P</name>
<description>Test</description><baseAddress>0x40000000</baseAddress>
<addressBlock><offset>0</offset><size>0x100</size></addressBlock>
<interrupt><name>P</name><description>i</description><value>7</value></interrupt><registers>
"""
TAIL = "</registers></peripheral></peripherals></device>\n"


def field(name, bits, access="read-write", extra=""):
    return (
        f"<field><name>{name}</name><description>f</description><bitRange>[{bits}]</bitRange>"
        f"<access>{access}</access>{extra}</field>"
    )


def register(name, offset, reset="0", fields="", access="read-write"):
    inner = f"<fields>{fields}</fields>" if fields else ""
    return (
        f"<register><name>{name}</name><description>r</description>"
        f"<addressOffset>{offset}</addressOffset><access>{access}</access>"
        f"<resetValue>{reset}</resetValue>{inner}</register>\n"
    )


class Generator(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.output = Path(self.folder.name) / "out"

    def run_on(self, text):
        source = Path(self.folder.name) / "test.svd"
        source.write_text(text, encoding="utf-8")
        return self.run_generator(source)

    def run_generator(self, *arguments):
        command = [sys.executable, *map(str, GENERATOR), *map(str, arguments), str(self.output)]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def made(self, name):
        return (self.output / name).read_text(encoding="utf-8")

    def expect_error(self, text, line, *words):
        result = self.run_on(text)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
        self.assertIn(f"test.svd:{line}: ", result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)

    # What it writes

    def test_the_description_of_the_project_is_accepted_silently(self):
        result = self.run_generator(DESCRIPTION)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))
        self.assertIn("#define COPROCESSOR_CTRL_DEMOD_Msk 0x00000001UL", self.made("capsoc_device.h"))
        self.assertIn("#define COPROCESSOR_CTRL_SRST_Pos 31UL", self.made("capsoc_device.h"))
        self.assertIn("#define COPROCESSOR_ID_Reset 0x43415053UL", self.made("capsoc_device.h"))
        self.assertIn("#define ADC_IRQn 31", self.made("capsoc_device.h"))
        self.assertIn("inline constexpr uint32_t CTRL_offset = 0x008;", self.made("capsoc_registers.h"))
        self.assertIn("| 0x0E0 | LATENCY | read-only |", self.made("registers.md"))
        package = self.made("capsoc_coprocessor_pkg.sv")
        self.assertIn("  localparam logic [11:0] CTRL_OFFSET = 12'h008;", package)
        self.assertIn("  localparam int CTRL_REF_MSB = 3;", package)
        self.assertIn("  localparam logic [31:0] STEP_CV_RESET = 32'h001496BB;", package)

    def test_the_decoder_has_a_bit_for_each_register_at_its_word(self):
        self.assertEqual(self.run_generator(DESCRIPTION).returncode, 0)
        decoder = self.made("capsoc_coprocessor_selects.sv")
        registers = json.loads(self.made("capsoc_registers.json"))["peripherals"]["COPROCESSOR"]["registers"]
        # The first member of a packed struct is its highest bit.
        members = re.findall(r"^  logic (\w+);$", decoder.split("} capsoc_coprocessor_selects_t;")[0], re.M)
        hits = re.findall(r"assign hits\[(\d+)\] = word == 6'h(\w+);  // (\w+)", decoder)
        self.assertEqual(members, [register["name"] for register in registers])
        self.assertEqual(
            [(int(bit), int(word, 16), name) for bit, word, name in hits],
            [
                (len(members) - 1 - place, register["offset"] // 4, register["name"])
                for place, register in enumerate(registers)
            ],
        )
        self.assertIn("assign word = address_i[7:2];", decoder)
        self.assertIn("assign mapped_o = address_i[11:8] == '0 & address_i[1:0] == '0 & word != 6'h3A;", decoder)

    def test_the_decoder_has_numbers_words_and_ranges(self):
        self.assertEqual(self.run_generator(DESCRIPTION).returncode, 0)
        decoder = self.made("capsoc_coprocessor_selects.sv")
        self.assertRegex(decoder, r"assign result_o\[3\] = select_o.REF_PHASE \| select_o.AMPLITUDE \| .*TURN_DET;")
        self.assertIn("assign word_o[2] = address_i[4] & ~(select_o.JUDGE | select_o.TURN_LIMIT);", decoder)
        self.assertRegex(
            decoder, r"assign refused_o = \(\(write_data_i\[31\]\) & \(select_o.STEP_AU .*select_o.A2\)\);"
        )
        self.assertIn("  logic [6:0] NODE;", decoder.split("} capsoc_coprocessor_correction_t;")[0].rsplit("{")[-1])
        self.assertIn("WORDS = 32'hFFF6FFCF;", self.made("capsoc_coprocessor_pkg.sv"))

    def test_the_map_has_names_rules_and_pairs(self):
        self.assertEqual(self.run_generator(DESCRIPTION).returncode, 0)
        made = self.made("capsoc_coprocessor_map.h")
        for line in (
            "  reg_ctrl = description::CTRL_offset,",
            "inline constexpr uint32_t ctrl_demod = description::CTRL_DEMOD_mask;",
            "inline constexpr unsigned ctrl_ref_shift = description::CTRL_REF_shift;",
            "inline constexpr uint32_t ctrl_writable = 0x00007FFF;  // and readable",
            "inline constexpr uint32_t word_judge = 2;",
        ):
            self.assertIn(line + "\n", made)
        self.assertRegex(made, r"0x00000000, 0x7FFFFFFF, registers::no_pair, false, \"\"\},  // STEP_AU\n")
        self.assertRegex(made, r'pair_freq, true, ""\},  // FREQ_HI\n')
        self.assertIn('"reserved bits of LOOP are ignored"},  // LOOP\n', made)

    def test_hardware_names_what_there_is(self):
        def hardware(inner):
            extension = f"<vendorExtensions><hardware>{inner}</hardware></vendorExtensions></device>\n"
            return HEAD + register("A", "0x0") + register("B", "0x80") + TAIL.replace("</device>\n", extension)

        place = "<peripheral>P</peripheral>"
        self.expect_error(hardware("<peripheral>Q</peripheral>"), 7, "Q")
        self.expect_error(hardware(place + "<results>A C</results>"), 7, "no register C")
        self.expect_error(hardware(place + "<words>A B</words>"), 7, "B has word 0", "write B=WORD")
        self.expect_error(hardware(place + "<words>A=32</words>"), 7, "from 0 to 31")
        self.expect_error(hardware(place + "<words>A B=1 A=2</words>"), 7, "A has a word already")
        self.expect_error(hardware(place + "<settings>A B=1</settings><words>B=2</words>"), 7, "B has a word already")
        self.expect_error(hardware(place + "<settings>C</settings>"), 7, "no register C")
        self.assertEqual(self.run_on(hardware(place + "<words>A B=1</words>")).returncode, 0)
        self.expect_error(hardware(f"{place}<optional>{register('A', 8).strip()}</optional>"), 7, "P has a second A")

    def test_an_optional_register_has_names_and_is_in_no_table(self):
        self.assertEqual(self.run_generator(DESCRIPTION).returncode, 0)
        define = "#define COPROCESSOR_CHANNEL (*(__IOM uint32_t *)(COPROCESSOR_BASE + 0x100UL))"
        self.assertIn(define, self.made("capsoc_device.h"))
        self.assertIn("inline constexpr uint32_t CHANNEL_HOLD_mask = 0x00000100;", self.made("capsoc_registers.h"))
        self.assertIn("  localparam logic [11:0] CHANNEL_OFFSET = 12'h100;", self.made("capsoc_coprocessor_pkg.sv"))
        self.assertIn("} capsoc_coprocessor_channel_t;", self.made("capsoc_coprocessor_selects.sv"))
        self.assertIn("| 0x100 | CHANNEL | read-write |", self.made("registers.md"))
        self.assertNotIn("CHANNEL", self.made("capsoc_registers.json"))
        self.assertNotIn('{"CHANNEL", 0x', self.made("capsoc_registers.h"))

    def test_the_settings_have_flip_flops_and_a_list(self):
        self.assertEqual(self.run_generator(DESCRIPTION).returncode, 0)
        rows = self.made("capsoc_coprocessor_settings.def").splitlines()[2:]
        self.assertEqual(rows[0], "SETTING(step_au, 31)")
        self.assertIn("SETTING(judge, 22)", rows)
        self.assertEqual(rows[-1], f"SETTING_PARITY({len(rows) - 1})")
        module = self.made("capsoc_coprocessor_settings.sv")
        self.assertEqual(
            re.findall(r"^  logic \[(\d+):0\] (\w+)_q;$", module, re.M),
            [(str(int(bits) - 1), name) for name, bits in re.findall(r"SETTING\((\w+), (\d+)\)", "".join(rows))],
        )
        self.assertIn("  capsoc_coprocessor_judge_t JUDGE;\n", module)
        # JUDGE and both thresholds reset to a word with an odd number of bits; the list's last register comes first.
        odd = "".join(str(int(re.search(r"judge|threshold", row) is not None)) for row in reversed(rows[:-1]))
        self.assertIn(f"{len(odd)}'b{odd};", module)
        names = ", ".join("reg_" + name for name in re.findall(r"SETTING\((\w+),", "".join(rows)))
        self.assertIn(f"settings_registers[] = {{{names}}};", self.made("capsoc_coprocessor_map.h"))

    def test_what_can_be_a_setting(self):
        def setting(fields, reset="0x0"):
            extension = "<vendorExtensions><hardware><peripheral>P</peripheral><settings>A</settings></hardware>"
            tail = TAIL.replace("</device>", f"{extension}</vendorExtensions></device>")
            return HEAD + register("A", "0x0", reset, fields) + tail

        upper = field("RESERVED_31_8", "31:8", "read-only")
        self.assertEqual(self.run_on(setting(field("LEVEL", "7:0") + upper)).returncode, 0)
        gap = field("LOW", "3:0") + field("RESERVED_5_4", "5:4", "read-only") + field("HIGH", "7:6") + upper
        for fields in (gap, field("LEVEL", "7:0", "read-only") + upper):
            self.expect_error(setting(fields), 6, "A is no setting", "not the lowest")
        parts = field("LEVEL", "7:0") + field("SHOWN", "31:8", "read-only")
        self.expect_error(setting(parts, "0x100"), 6, "A is no setting", "0x100")

    def test_only_what_is_synthesised_has_a_decoder(self):
        self.run_generator(DESCRIPTION)
        self.assertEqual(
            [path.name for path in sorted(self.output.glob("*.sv"))],
            ["capsoc_coprocessor_pkg.sv", "capsoc_coprocessor_selects.sv", "capsoc_coprocessor_settings.sv"],
        )

    def test_the_table_for_programs_has_masks_and_reserved_values(self):
        self.run_generator(DESCRIPTION)
        registers = json.loads(self.made("capsoc_registers.json"))["peripherals"]["COPROCESSOR"]["registers"]
        by_name = {register["name"]: register for register in registers}
        self.assertEqual(by_name["CTRL"]["implemented"], 0x80007FFF)
        self.assertEqual(
            by_name["CTRL"]["reserved_values"], [{"rule": "field", "field": "REF", "low": 2, "high": 3, "values": [3]}]
        )
        self.assertEqual(by_name["A1"]["reserved_values"], [{"rule": "range", "minimum": 0, "maximum": 0x7FFFFFFF}])
        self.assertEqual(by_name["STATUS"]["reserved_values"], [])

    def test_gaps_between_registers_are_reserved_words(self):
        result = self.run_on(HEAD + register("A", "0x0") + register("B", "0x10") + TAIL)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("__IM  uint32_t RESERVED0[3];", self.made("capsoc_device.h"))

    def test_masks_separate_writable_from_write_one_to_clear(self):
        clears = "<modifiedWriteValues>oneToClear</modifiedWriteValues>"
        fields = (
            field("RW", "3:0")
            + field("RO", "7:4", "read-only")
            + field("W1C", "8:8", extra=clears)
            + field("WO", "9:9", "write-only")
            + field("RESERVED_31_10", "31:10", "read-only")
        )
        result = self.run_on(HEAD + register("A", "0x4", "0x1F5", fields) + TAIL)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(
            '{"A", 0x004, Access::read_write, 0x000001F5, 0x0000020F, 0x00000100, 0x000001FF},',
            self.made("capsoc_registers.h"),
        )
        self.assertNotIn("RESERVED_31_10", self.made("capsoc_device.h"))

    def test_a_second_run_leaves_the_files_alone(self):
        self.run_generator(DESCRIPTION)
        before = {path: path.stat().st_mtime_ns for path in self.output.iterdir()}
        self.run_generator(DESCRIPTION)
        self.assertEqual(before, {path: path.stat().st_mtime_ns for path in self.output.iterdir()})
        self.assertEqual(len(before), 9)

    # What it refuses

    def test_bad_xml(self):
        self.expect_error(HEAD + "<register>\n" + TAIL, 6, "not well-formed XML")

    def test_two_registers_at_one_offset(self):
        text = HEAD + register("A", "0x4") + register("B", "0x4") + TAIL
        self.expect_error(text, 6, "B overlaps A", "0x4")

    def test_overlapping_fields(self):
        fields = field("LOW", "7:0") + field("HIGH", "31:7")
        self.expect_error(HEAD + register("A", "0", "0", fields) + TAIL, 5, "A.HIGH overlaps")

    def test_a_gap_between_fields(self):
        fields = field("LOW", "7:0") + field("HIGH", "31:10")
        self.expect_error(HEAD + register("A", "0", "0", fields) + TAIL, 5, "RESERVED_9_8")

    def test_a_gap_above_the_last_field(self):
        self.expect_error(HEAD + register("A", "0", "0", field("LOW", "7:0")) + TAIL, 5, "RESERVED_31_8")

    def test_a_reset_value_outside_the_fields(self):
        fields = field("LOW", "7:0") + field("RESERVED_31_8", "31:8", "read-only")
        self.expect_error(HEAD + register("A", "0", "0x100", fields) + TAIL, 5, "resets to 0x100")

    def test_a_reset_value_beyond_a_word(self):
        self.expect_error(HEAD + register("A", "0", "0x100000000") + TAIL, 5, "resets to")

    def test_an_unaligned_offset_and_one_beyond_the_block(self):
        self.expect_error(HEAD + register("A", "0x2") + TAIL, 5, "multiple of 4")
        self.expect_error(HEAD + register("A", "0x100") + TAIL, 5, "multiple of 4")

    def test_a_number_that_is_none(self):
        self.expect_error(HEAD + register("A", "four") + TAIL, 5, "'four'")

    def test_an_unknown_access(self):
        self.expect_error(HEAD + register("A", "0", access="sometimes") + TAIL, 5, "'sometimes'")

    def test_a_missing_element(self):
        self.expect_error(HEAD + "<register><name>A</name></register>\n" + TAIL, 5, "lacks <description>")

    def test_a_range_of_write_values_that_is_none(self):
        wrong = register("A", "0").replace(
            "</register>",
            "<writeConstraint><range><minimum>2</minimum>" "<maximum>1</maximum></range></writeConstraint></register>",
        )
        self.expect_error(HEAD + wrong + TAIL, 5, "range 2 to 1")

    def test_overlapping_peripherals(self):
        second = HEAD.split("<peripherals>", 1)[1].replace("<name>P</name>\n", "<name>Q</name>\n", 1)
        text = HEAD + "</registers></peripheral>\n" + second.replace("0x40000000", "0x40000080") + TAIL
        self.expect_error(text, 6, "Q overlaps P", "0x40000080")

    def test_another_kind_of_file(self):
        self.expect_error("<svg/>\n", 1, "<svg>")
        self.expect_error("", 1, "not well-formed XML")

    def test_a_file_that_is_not_there(self):
        result = self.run_generator("no/such/file.svd")
        self.assertEqual(result.returncode, 2)
        self.assertIn("no/such/file.svd", result.stderr)
        self.assertNotIn("Traceback", result.stderr)

    def test_wrong_arguments(self):
        result = self.run_generator()
        self.assertEqual(result.returncode, 2)
        self.assertIn("usage", result.stderr)


if __name__ == "__main__":
    unittest.main()
