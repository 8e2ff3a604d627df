#!/usr/bin/env python3
"""scripts/debugger/svd.py without GDB: our own description, and what other vendors' descriptions have in them."""

import os
import random
import re
import subprocess
import tempfile
import unittest
from pathlib import Path
from xml.etree import ElementTree

from debugger import svd
from harness import CAPSOC, SOURCE


CTEST = {"name": "svd: parser", "whole": True, "timeout": 120}

OTHERS = """<device><name>X</name><size>0x20</size><access>read-write</access><peripherals>
<peripheral><name>TIM0</name><baseAddress>0x40000000</baseAddress><registers>
  <register><name>CTRL</name><addressOffset>0</addressOffset><fields>
    <field><name>ON</name><bitOffset>0</bitOffset><bitWidth>1</bitWidth></field>
    <field><name>MODE</name><lsb>4</lsb><msb>6</msb><enumeratedValues>
      <enumeratedValue><name>FAST</name><value>#101</value></enumeratedValue>
      <enumeratedValue><name>SLOW</name><value>0b010</value></enumeratedValue></enumeratedValues></field>
  </fields></register>
  <register><dim>3</dim><dimIncrement>4</dimIncrement><name>CC[%s]</name><addressOffset>0x10</addressOffset><size>16</size></register>
  <register derivedFrom="CTRL"><name>CTRL2</name><addressOffset>4</addressOffset></register>
  <register><name>POP</name><addressOffset>8</addressOffset><readAction>modify</readAction></register>
  <cluster><dim>2</dim><dimIncrement>0x20</dimIncrement><dimIndex>A-B</dimIndex><name>CH%s</name>
    <addressOffset>0x100</addressOffset><access>write-only</access>
    <register><name>DATA</name><addressOffset>4</addressOffset></register></cluster>
</registers></peripheral>
<peripheral derivedFrom="TIM0"><name>TIM1</name><baseAddress>0x40001000</baseAddress></peripheral>
</peripherals></device>"""


# Elements in the order in which the schema (CMSIS-SVD.xsd 1.3) wants them; those that we use.
SCHEMA = {
    "device": "vendor name series version description cpu addressUnitBits width size resetMask peripherals",
    "cpu": "name revision endian mpuPresent fpuPresent nvicPrioBits vendorSystickConfig deviceNumInterrupts",
    "peripherals": "peripheral",
    "registers": "register",
    "fields": "field",
    "enumeratedValues": "enumeratedValue",
    "peripheral": "name description baseAddress addressBlock interrupt registers",
    "addressBlock": "offset size usage",
    "writeConstraint": "range",
    "range": "minimum maximum",
    "interrupt": "name description value",
    "register": "name description addressOffset size access resetValue resetMask dataType modifiedWriteValues "
    "writeConstraint readAction fields",
    "field": "name description bitRange access modifiedWriteValues writeConstraint readAction enumeratedValues",
    "enumeratedValue": "name description value",
}


def check_order(test, path):
    device = ElementTree.parse(path).getroot()
    if device[-1].tag == "vendorExtensions":
        device.remove(device[-1])  # the schema takes anything in there, after all else
    for element in device.iter():
        order = SCHEMA.get(element.tag, "").split()
        names = [child.tag for child in element]
        test.assertEqual([name for name in names if name not in order], [], element.tag)
        test.assertEqual(names, sorted(names, key=order.index), element.tag)


class Own(unittest.TestCase):
    """models/registers/capsoc.svd."""

    def setUp(self):
        self.device = svd.Device()
        self.device.load(SOURCE / "models/registers/capsoc.svd")

    def test_all_our_peripherals_are_there(self):
        # The devices of the map as capsoc prints it that the AN385 has not.
        printed = subprocess.run([CAPSOC, "info"], stdout=subprocess.PIPE, check=True, text=True).stdout
        entries = re.findall(r"^(0x[0-9a-f]+) +0x[0-9a-f]+ +(\w+) +device", printed, re.MULTILINE)
        own = {int(base, 16) for base, name in entries if name in ("coprocessor", "adc_front_end", "clock_controller")}
        self.assertEqual({p.base for p in self.device.peripherals.values()}, own)
        self.assertEqual(len(own), 3)

    def test_elements_stand_in_the_order_of_the_schema(self):
        check_order(self, SOURCE / "models/registers/capsoc.svd")

    def test_names_addresses_and_fields(self):
        _, register, field = self.device.find("coprocessor.status.lock")
        self.assertEqual((register.address, field.low, field.of(0b10)), (0x4000C00C, 1, 1))
        self.assertEqual(self.device.find("CLOCKCTRL.FREQ")[1].address, 0x4000E014)
        reference = self.device.find("COPROCESSOR.CTRL.REF")[2]
        self.assertEqual(reference.values[reference.of(8)], "ANGLE")

    def test_formats_are_understood(self):
        for path, word, meaning in (
            ("COPROCESSOR.A1", 0x40000000, "0.5000000000"),
            ("COPROCESSOR.B1", 0xC0000000, "-0.5000000000"),
            ("COPROCESSOR.AU_HI", 0x40000000, "0.5000000000"),
            ("COPROCESSOR.ANGLE", 0x40000000, "90.0000000 degrees"),
            ("COPROCESSOR.RESIDUE", 0xC0000000, "-90.0000000 degrees"),
            ("ADC.PERIOD", 7, "7"),
        ):
            self.assertEqual(self.device.find(path)[1].meaning(word), meaning, path)

    def test_completion(self):
        self.assertEqual(self.device.complete("COP"), ["COPROCESSOR"])
        self.assertIn("COPROCESSOR.STATUS", self.device.complete("coprocessor.st"))
        self.assertEqual(self.device.complete("COPROCESSOR.STATUS.L"), ["COPROCESSOR.STATUS.LOCK"])
        self.assertEqual(self.device.complete("NOTHING.X"), [])

    def test_every_wrong_name_is_explained(self):
        for path, text in (
            ("NONE", "no peripheral NONE"),
            ("ADC.NONE", "no register NONE"),
            ("ADC.ID.X", "no field X"),
            ("A.B.C.D", "at the most"),
        ):
            with self.assertRaisesRegex(svd.SvdError, text):
                self.device.find(path)


class Board(unittest.TestCase):
    """What `capsoc info --svd` writes: everything modelled."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = Path(folder.name) / "board.svd"
        subprocess.run([CAPSOC, "info", "--svd", self.file], check=True)
        self.device = svd.Device()
        self.device.load(self.file)

    def test_every_device_of_the_map_is_there_and_the_processor(self):
        printed = subprocess.run([CAPSOC, "info"], stdout=subprocess.PIPE, check=True, text=True).stdout
        devices = {
            int(base, 16) for base in re.findall(r"^(0x[0-9a-f]+) +0x[0-9a-f]+ +\w+ +device", printed, re.MULTILINE)
        }
        own = {0xE0000000, 0xE0001000, 0xE000E000, 0xE000E010, 0xE000E100, 0xE000ED00, 0xE000ED90, 0xE000EDF0}
        self.assertEqual({p.base for p in self.device.peripherals.values()}, devices | own)
        for peripheral in self.device.peripherals.values():
            self.assertTrue(peripheral.registers, peripheral.name)

    def test_addresses_are_the_manuals(self):
        # ARM DDI 0479 and DDI 0403, tables of registers.
        for path, address in (
            ("UART3.BAUDDIV", 0x40007010),
            ("TIMER1.RELOAD", 0x40001008),
            ("DUAL_TIMER.TIMER2CONTROL", 0x40002028),
            ("WATCHDOG.WDOGLOCK", 0x40008C00),
            ("GPIO2.INTENSET", 0x40012020),
            ("FPGAIO.BUTTON", 0x40028008),
            ("NVIC.ISER", 0xE000E100),
            ("NVIC.IPR7", 0xE000E41C),
            ("NVIC.STIR", 0xE000EF00),
            ("SCB.CFSR", 0xE000ED28),
            ("SCB.SHPR3", 0xE000ED20),
            ("SYSTICK.RVR", 0xE000E014),
            ("MPU.RASR_A3", 0xE000EDB8),
            ("DWT.FUNCTION3", 0xE0001058),
            ("ITM.TCR", 0xE0000E80),
            ("DCB.DEMCR", 0xE000EDFC),
            ("COPROCESSOR.STATUS", 0x4000C00C),
        ):
            self.assertEqual(self.device.find(path)[1].address, address, path)
        self.assertTrue(self.device.find("UART0.DATA")[1].has_side_effect)

    def test_every_named_bit_is_a_bit_of_its_register(self):
        rows = re.findall(
            r"^REGISTER_FIELD\((\w+), (\w+), (\w+), (\d+), (\d+)\)",
            (SOURCE / "platform/soc/register_fields.def").read_text(),
            re.MULTILINE,
        )
        self.assertGreater(len(rows), 100)
        # CPACR and the block FPU are there with an FPU only.
        with_fpu = svd.Device()
        subprocess.run([CAPSOC, "info", "--svd", self.file, "--profile", "m4f"], check=True)
        with_fpu.load(self.file)
        self.assertNotIn("FPU", self.device.peripherals)
        for kind, register, name, low, bits in rows:
            of_kind = [p.name for p in with_fpu.peripherals.values() if p.name.rstrip("0123456789") == kind]
            self.assertTrue(of_kind, kind)
            for peripheral in of_kind:
                field = with_fpu.find(f"{peripheral}.{register}.{name}")[2]
                if kind != "FPU" and register != "CPACR":
                    self.assertEqual(self.device.find(f"{peripheral}.{register}.{name}")[2].low, field.low)
                self.assertEqual((field.low, field.high - field.low + 1), (int(low), int(bits)), name)
        for peripheral in self.device.peripherals.values():
            for register in peripheral.registers.values():
                taken = [bit for field in register.fields for bit in range(field.low, field.high + 1)]
                self.assertEqual(len(taken), len(set(taken)), f"{peripheral.name}.{register.name}: fields overlap")

    def test_it_is_well_formed_in_the_order_of_the_schema(self):
        subprocess.run(["xmllint", "--noout", self.file], check=True)
        check_order(self, self.file)


class Others(unittest.TestCase):
    """Parts of CMSIS-SVD that our description does not use."""

    def device(self, text):
        with tempfile.NamedTemporaryFile("w", suffix=".svd") as file:
            file.write(text)
            file.flush()
            device = svd.Device()
            device.load(file.name)
        return device

    def test_arrays_clusters_and_derivation(self):
        device = self.device(OTHERS)
        for path, address, size in (
            ("TIM0.CC2", 0x40000018, 2),
            ("TIM1.CC0", 0x40001010, 2),
            ("TIM1.CTRL2", 0x40001004, 4),
            ("TIM0.CHB_DATA", 0x40000124, 4),
        ):
            register = device.find(path)[1]
            self.assertEqual((register.address, register.size), (address, size), path)
        mode = device.find("TIM1.CTRL2.MODE")[2]
        self.assertEqual((mode.of(0x50), mode.values), (5, {5: "FAST", 2: "SLOW"}))
        self.assertTrue(device.find("TIM0.POP")[1].has_side_effect)
        self.assertFalse(device.find("TIM0.CHA_DATA")[1].readable)

    def test_damage_is_one_sentence(self):
        for text in (
            "",
            "<device>",
            "<html/>",
            OTHERS.replace("0x40000000", "zero"),
            OTHERS.replace("<lsb>4</lsb>", "<lsb/>"),
            OTHERS.replace("<name>TIM0</name>", ""),
            OTHERS.replace("<name>ON</name>", ""),
            OTHERS.replace("<name>POP</name>", ""),
            OTHERS.replace("<size>16</size>", "<size>0</size>"),
            OTHERS.replace("<size>16</size>", "<size>99999999999</size>"),
            OTHERS.replace("<size>16</size>", "<size>k</size>"),
            OTHERS.replace("<msb>6</msb>", "<msb>3</msb>"),
            OTHERS.replace("<msb>6</msb>", "<msb>99999999999</msb>"),
            OTHERS.replace("<dim>3</dim>", "<dim>99999999999</dim>"),
            OTHERS.replace("A-B", "0-99999999999"),
            OTHERS.replace("<addressOffset>8<", "<addressOffset>-0x50000000<"),
            "<device><peripherals><peripheral><name>P</name><baseAddress>0</baseAddress><registers>"
            + "<cluster><dim>4096</dim><dimIncrement>4</dimIncrement><name>C%s</name><addressOffset>0</addressOffset>"
            * 3
            + "</cluster>" * 3
            + "</registers></peripheral></peripherals></device>",
        ):
            with self.assertRaises(svd.SvdError, msg=text) as caught:
                self.device(text)
            self.assertNotIn("\n", str(caught.exception))
        with self.assertRaisesRegex(svd.SvdError, "cannot be read"):
            svd.load("/nonexistent.svd")

    def test_random_damage_is_one_sentence_or_a_description(self):
        """CAPSOC_FUZZ_FILES: how many; the numbers are the seeds."""
        odd = [
            "0",
            "-1",
            "99999999999",
            "0xFFFFFFFFFFFF",
            " ",
            "[3:5]",
            "[x]",
            "%s",
            "A-Z",
            "0-99999999",
            "#",
            "k",
            "TIM0",
            "64",
            "a,b",
        ]
        outcomes = {"read": 0, "refused": 0}
        for seed in range(int(os.environ.get("CAPSOC_FUZZ_FILES", 300))):
            choose, text = random.Random(seed), OTHERS
            for _ in range(choose.randint(1, 3)):
                value = choose.choice(list(re.finditer(r">([^<>\n]+)<", text)))
                other = choose.choice([*odd, choose.choice(re.findall(r">([^<>\n]+)<", text))])
                text = text[: value.start(1)] + other + text[value.end(1) :]
                element = choose.choice(list(re.finditer(r"<(\w+)>[^<>]*</\1>", text)))
                if choose.random() < 0.3:
                    text = text[: element.start()] + choose.choice(["", element[0] * 2, "<"]) + text[element.end() :]
            try:
                device = self.device(text)
                outcomes["read"] += 1
            except svd.SvdError as error:
                self.assertNotIn("\n", str(error), seed)
                outcomes["refused"] += 1
                continue
            for peripheral in device.peripherals.values():
                for register in peripheral.registers.values():
                    register.meaning(0x80000001)
                    self.assertTrue(all(field.of(0xFFFFFFFF) >= 0 and field.name for field in register.fields), seed)
            device.complete("TIM0.C")
        print(f"svd: {outcomes}")
        self.assertGreater(min(outcomes.values()), 0)


if __name__ == "__main__":
    unittest.main()
