"""Generates the register headers and the reference page from the CMSIS-SVD description.

usage: registers DESCRIPTION.svd OUTPUT_DIRECTORY

Writes capsoc_device.h (firmware, C), capsoc_registers.h (models, C++), registers.md (readers) and
capsoc_registers.json (register tests). A peripheral that is synthesised has the model's register map capsoc_NAME_map.h
(C++), a package capsoc_NAME_pkg.sv and the address decoder capsoc_NAME_selects.sv (SystemVerilog). Where there are
settings, their flip-flops are capsoc_NAME_settings.sv (SystemVerilog), and capsoc_NAME_settings.def (C) lists them.
A file whose content would not change is left alone, so that nothing that depends on it is rebuilt.
An error in the description ends with status 2 and one sentence that names file and line.
"""

import json
import re
import sys
from dataclasses import dataclass, field
from xml.parsers import expat

from capsoc_tools.generate.output import SourceError, generate
from capsoc_tools.generate.settings import setting_error, setting_rows, sv_settings

WORD_MASK = 0xFFFFFFFF
ACCESSES = ("read-only", "read-write", "write-only")
SYNTHESISED = ("COPROCESSOR",)


@dataclass
class Element:
    """An XML element that knows its line (the standard tree does not keep it)."""

    tag: str
    line: int
    text: str = ""
    children: list = field(default_factory=list)

    def all(self, tag):
        return [child for child in self.children if child.tag == tag]

    def find(self, tag):
        found = self.all(tag)
        if len(found) > 1:
            raise SourceError(found[1].line, f"<{self.tag}> has a second <{tag}>; keep one")
        return found[0] if found else None

    def value(self, tag, default=None):
        found = self.find(tag)
        if found is None:
            if default is not None:
                return default
            raise SourceError(self.line, f"<{self.tag}> lacks <{tag}>; add it")
        return " ".join(found.text.split())

    def number(self, tag, default=None):
        if self.find(tag) is None and default is not None:
            return default
        text = self.value(tag)
        try:
            return int(text, 0)
        except ValueError:
            raise SourceError(self.find(tag).line, f"<{tag}> is '{text}'; write a decimal or 0x number") from None


@dataclass
class Field:
    name: str
    description: str
    low: int
    high: int
    access: str
    one_to_clear: bool
    values: list
    line: int

    @property
    def mask(self):
        return ((1 << (self.high - self.low + 1)) - 1) << self.low

    @property
    def reserved(self):
        return self.name.startswith("RESERVED")


@dataclass
class Register:
    name: str
    description: str
    offset: int
    access: str
    reset: int
    data_type: str
    fields: list
    write_range: tuple
    line: int

    def mask(self, accesses, one_to_clear=None):
        chosen = 0
        for part in self.fields:
            if part.reserved or part.access not in accesses:
                continue
            if one_to_clear is None or part.one_to_clear == one_to_clear:
                chosen |= part.mask
        if self.fields:
            return chosen
        return WORD_MASK if self.access in accesses and one_to_clear is not True else 0

    @property
    def readable_mask(self):
        return self.mask(("read-only", "read-write"))

    @property
    def writable_mask(self):
        return self.mask(("read-write", "write-only"), one_to_clear=False)

    @property
    def one_to_clear_mask(self):
        return self.mask(("read-write", "write-only"), one_to_clear=True)


@dataclass
class Peripheral:
    name: str
    description: str
    base: int
    size: int
    interrupts: list
    registers: list
    line: int
    results: list = field(default_factory=list)  # registers, by their number
    words: dict = field(default_factory=dict)  # register: its word in the bank's memory
    settings: list = field(default_factory=list)  # registers that software alone writes and the hardware reads
    optional: list = field(default_factory=list)  # registers that the board's hardware has not


@dataclass
class Pair:
    """A number of more than 32 bits in two registers, NAME_LO and NAME_HI."""

    name: str
    low: Register
    high: Register


def pairs_of(peripheral):
    """The pairs of a peripheral, by the offset of their low words."""
    by_name = {register.name: register for register in peripheral.registers}
    return [
        Pair(register.name[:-3], register, by_name[register.name[:-3] + "_HI"])
        for register in peripheral.registers
        if register.name.endswith("_LO") and register.name[:-3] + "_HI" in by_name
    ]


@dataclass
class Device:
    name: str
    description: str
    peripherals: list
    priority_bits: int


# Reading


def parse_xml(path):
    """The root element, every element with its line."""
    root, stack = [], []
    parser = expat.ParserCreate()
    parser.buffer_text = True

    def start(tag, _attributes):
        element = Element(tag, parser.CurrentLineNumber)
        (stack[-1].children if stack else root).append(element)
        stack.append(element)

    def end(_tag):
        stack.pop()

    def text(data):
        if stack:
            stack[-1].text += data

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = text
    try:
        parser.Parse(path.read_bytes(), True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        raise SourceError(error.lineno, f"not well-formed XML ({reason}); xmllint shows the place") from None
    return root[0]


def read_name(element):
    name = element.value("name")
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
        raise SourceError(element.line, f"'{name}' is no identifier; use letters, digits and _")
    return name


def read_access(element, default):
    access = element.value("access", default)
    if access not in ACCESSES:
        raise SourceError(element.find("access").line, f"access '{access}' is unknown; use {', '.join(ACCESSES)}")
    return access


def read_values(element, width):
    group = element.find("enumeratedValues")
    values = []
    for entry in group.all("enumeratedValue") if group else []:
        number = entry.number("value")
        if not 0 <= number < 1 << width:
            raise SourceError(entry.line, f"value {number} does not fit {width} bits; widen the field")
        values.append((read_name(entry), number, entry.value("description")))
    return values


def read_field(element, access):
    match = re.fullmatch(r"\[(\d+):(\d+)\]", element.value("bitRange"))
    if not match:
        raise SourceError(element.find("bitRange").line, "<bitRange> is not [high:low]")
    high, low = int(match[1]), int(match[2])
    name = read_name(element)
    if not 31 >= high >= low:
        raise SourceError(element.line, f"{name} is bits {high}:{low}; use 31 >= high >= low")
    modified = element.value("modifiedWriteValues", "modify")
    if modified not in ("modify", "oneToClear"):
        raise SourceError(element.line, f"modifiedWriteValues '{modified}' is not supported; use oneToClear")
    return Field(
        name,
        element.value("description"),
        low,
        high,
        read_access(element, access),
        modified == "oneToClear",
        read_values(element, high - low + 1),
        element.line,
    )


def check_fields(register):
    expected = 0
    for part in sorted(register.fields, key=lambda each: each.low):
        if part.low < expected:
            raise SourceError(part.line, f"{register.name}.{part.name} overlaps the field below it; move one")
        if part.low > expected:
            raise SourceError(
                part.line,
                f"{register.name} says nothing about bits {part.low - 1}:{expected}; "
                f"add a field RESERVED_{part.low - 1}_{expected}",
            )
        expected = part.high + 1
    if register.fields and expected != 32:
        raise SourceError(
            register.line,
            f"{register.name} says nothing about bits 31:{expected}; " f"add a field RESERVED_31_{expected}",
        )
    check_unique(register.fields, register.name)


def check_reset(register):
    known = WORD_MASK
    for part in register.fields:
        if part.reserved:
            known &= ~part.mask
    if not 0 <= register.reset <= WORD_MASK or register.reset & ~known:
        raise SourceError(
            register.line,
            f"{register.name} resets to {register.reset:#x}, outside its fields ({known:#x}); "
            "correct the reset value or the fields",
        )


def check_unique(items, where):
    seen = set()
    for item in items:
        if item.name in seen:
            raise SourceError(item.line, f"{where} has a second {item.name}; rename one")
        seen.add(item.name)


def read_write_range(element):
    """The values that a write may have, (lowest, highest); None: all."""
    constraint = element.find("writeConstraint")
    if constraint is None:
        return None
    limits = constraint.find("range")
    if limits is None:
        raise SourceError(constraint.line, "<writeConstraint> lacks <range>; add it")
    low, high = limits.number("minimum"), limits.number("maximum")
    if not 0 <= low <= high <= WORD_MASK:
        raise SourceError(limits.line, f"the range {low} to {high} is empty or beyond a word")
    return (low, high)


def read_register(element, size):
    access = read_access(element, "read-write")
    parts = element.find("fields")
    register = Register(
        read_name(element),
        element.value("description"),
        element.number("addressOffset"),
        access,
        element.number("resetValue"),
        element.value("dataType", "uint32_t"),
        sorted(
            (read_field(each, access) for each in (parts.all("field") if parts else [])),
            key=lambda each: each.low,
        ),
        read_write_range(element),
        element.line,
    )
    if register.data_type not in ("uint32_t", "int32_t"):
        raise SourceError(element.line, f"{register.name} is no uint32_t or int32_t")
    if register.offset % 4 or not 0 <= register.offset <= size - 4:
        raise SourceError(
            element.line,
            f"{register.name} is at offset {register.offset:#x}; "
            f"use a multiple of 4 below the block's size {size:#x}",
        )
    check_fields(register)
    check_reset(register)
    return register


def read_peripheral(element):
    block = element.find("addressBlock")
    if block is None:
        raise SourceError(element.line, "<peripheral> lacks <addressBlock>; add it")
    size = block.number("size")
    parts = element.find("registers")
    registers = [read_register(each, size) for each in (parts.all("register") if parts else [])]
    registers.sort(key=lambda each: each.offset)
    for below, above in zip(registers, registers[1:]):
        if above.offset == below.offset:
            raise SourceError(
                max(above.line, below.line),
                f"{above.name} overlaps {below.name} at offset {above.offset:#x}; move one",
            )
    name = read_name(element)
    check_unique(registers, name)
    interrupts = [(read_name(i), i.number("value"), i.value("description")) for i in element.all("interrupt")]
    return Peripheral(
        name, element.value("description"), element.number("baseAddress"), size, interrupts, registers, element.line
    )


def known_register(peripheral, name, element):
    for register in peripheral.registers:
        if register.name == name:
            return register
    raise SourceError(element.line, f"{peripheral.name} has no register {name}; correct the name")


def read_hardware(element, peripherals):
    """What only the RTL of a peripheral needs: numbers of its results, its settings, the words of its bank's memory. A
    word is NAME, which stands at the low five bits of its own word's number, or NAME=WORD; a setting has one, too."""
    name = element.value("peripheral")
    peripheral = next((each for each in peripherals if each.name == name), None)
    if peripheral is None:
        raise SourceError(element.line, f"<hardware> names {name}, and there is no such peripheral")
    results = element.find("results")
    if results is not None:
        peripheral.results = [known_register(peripheral, each, results) for each in results.text.split()]
    settings = element.find("settings")
    for register in read_words(settings, peripheral):
        error = setting_error(register)
        if error is not None:
            raise SourceError(settings.line, error)
        peripheral.settings.append(register)
    read_words(element.find("words"), peripheral)
    optional = element.find("optional")
    if optional is not None:
        peripheral.optional = [read_register(each, peripheral.size) for each in optional.all("register")]
        check_unique(peripheral.registers + peripheral.optional, name)


def read_words(element, peripheral):
    """Gives each register that the element names its word, and returns these registers."""
    registers = []
    for entry in element.text.split() if element is not None else []:
        register_name, _, place = entry.partition("=")
        register = known_register(peripheral, register_name, element)
        word = int(place) if place.isdecimal() else register.offset // 4 % 32
        if (place and not place.isdecimal()) or word > 31:
            raise SourceError(element.line, f"the word of '{entry}' is no number from 0 to 31")
        if register_name in peripheral.words:
            raise SourceError(element.line, f"{register_name} has a word already; name it once")
        if not place and word in peripheral.words.values():
            raise SourceError(
                element.line, f"{register_name} has word {word}, which is taken; write {register_name}=WORD"
            )
        peripheral.words[register_name] = word
        registers.append(register)
    return registers


def read_device(path):
    root = parse_xml(path)
    if root.tag != "device":
        raise SourceError(root.line, f"the root is <{root.tag}>; a CMSIS-SVD has <device>")
    parts = root.find("peripherals")
    if parts is None:
        raise SourceError(root.line, "<device> lacks <peripherals>; add it")
    peripherals = sorted((read_peripheral(each) for each in parts.all("peripheral")), key=lambda each: each.base)
    check_unique(peripherals, "the device")
    for below, above in zip(peripherals, peripherals[1:]):
        if above.base < below.base + below.size:
            raise SourceError(above.line, f"{above.name} overlaps {below.name} at {above.base:#x}; move one")
    extensions = root.find("vendorExtensions")
    for element in extensions.all("hardware") if extensions else []:
        read_hardware(element, peripherals)
    cpu = root.find("cpu")
    return Device(root.value("name"), root.value("description"), peripherals, cpu.number("nvicPrioBits") if cpu else 0)


# Writing

NOTICE = "Generated from {source} by scripts/capsoc_tools/generate/registers.py: change that file, not this one."
C_QUALIFIERS = {"read-only": "__IM ", "read-write": "__IOM", "write-only": "__OM "}


def c_struct(peripheral):
    lines = [f"/* {peripheral.description} */", "typedef struct {"]
    position, gaps = 0, 0
    for register in peripheral.registers:
        if register.offset > position:
            words = (register.offset - position) // 4
            lines.append(f"  __IM  uint32_t RESERVED{gaps}[{words}];")
            gaps += 1
        declaration = f"{C_QUALIFIERS[register.access]} {register.data_type} {register.name};"
        lines.append(f"  {declaration} /* 0x{register.offset:03X}: {register.description} */")
        position = register.offset + 4
    # The prefix keeps ADC_Type and the like free for vendor headers.
    lines.append(f"}} CAPSOC_{peripheral.name}_Type;")
    return lines


def c_optional(peripheral):
    return [
        f"#define {peripheral.name}_{register.name} "
        f"(*({C_QUALIFIERS[register.access].strip()} uint32_t *)({peripheral.name}_BASE + 0x{register.offset:03X}UL)) "
        f"/* {register.description} */"
        for register in peripheral.optional
    ]


def c_fields(peripheral):
    lines = []
    for register in peripheral.registers + peripheral.optional:
        lines.append(f"#define {peripheral.name}_{register.name}_Reset 0x{register.reset:08X}UL")
        for part in register.fields:
            if part.reserved:
                continue
            prefix = f"{peripheral.name}_{register.name}_{part.name}"
            lines.append(f"#define {prefix}_Pos {part.low}UL /* {part.description} */")
            lines.append(f"#define {prefix}_Msk 0x{part.mask:08X}UL")
            for name, value, description in part.values:
                lines.append(f"#define {prefix}_{name} {value}UL /* {description} */")
    return lines


def device_header(device, source):
    lines = [
        f"/* {device.description}. {NOTICE.format(source=source)} */",
        "",
        "#ifndef CAPSOC_DEVICE_H",
        "#define CAPSOC_DEVICE_H",
        "",
        "#include <stdint.h>",
        "",
        "/* As in CMSIS: what software may do with a register. */",
    ]
    for name, meaning in (("__IM", "volatile const"), ("__OM", "volatile"), ("__IOM", "volatile")):
        lines += [f"#ifndef {name}", f"#define {name} {meaning}", "#endif"]
    lines += ["", "/* Interrupt lines of the NVIC */"]
    for peripheral in device.peripherals:
        for name, number, description in peripheral.interrupts:
            lines.append(f"#define {name}_IRQn {number} /* {description} */")
    for peripheral in device.peripherals:
        lines += [""] + c_struct(peripheral)
        lines += [
            "",
            f"#define {peripheral.name}_BASE 0x{peripheral.base:08X}UL",
            f"#define {peripheral.name} " f"((CAPSOC_{peripheral.name}_Type *){peripheral.name}_BASE)",
            "",
        ]
        lines += c_optional(peripheral) + c_fields(peripheral)
    return "\n".join(lines + ["", "#endif", ""])


CPP_HEAD = """#pragma once

#include <cstddef>
#include <cstdint>

#include "kit/register_description.h"

namespace capsoc::registers {
"""


def cpp_namespace(peripheral):
    lines = [
        "",
        f"/// {peripheral.description}",
        f"namespace {peripheral.name.lower()} {{",
        "",
        f"inline constexpr uint32_t base_address = 0x{peripheral.base:08X};",
        f"inline constexpr uint32_t block_size = 0x{peripheral.size:X};",
    ]
    for name, number, _ in peripheral.interrupts:
        suffix = "" if name == peripheral.name else "_" + name.lower()
        lines.append(f"inline constexpr unsigned interrupt{suffix} = {number};")
    for register in peripheral.registers + peripheral.optional:
        lines += [
            "",
            f"inline constexpr uint32_t {register.name}_offset = 0x{register.offset:03X};",
            f"inline constexpr uint32_t {register.name}_reset = 0x{register.reset:08X};",
        ]
        for part in register.fields:
            if part.reserved:
                continue
            prefix = f"{register.name}_{part.name}"
            lines.append(f"inline constexpr uint32_t {prefix}_mask = 0x{part.mask:08X};")
            lines.append(f"inline constexpr unsigned {prefix}_shift = {part.low};")
            lines += [f"inline constexpr uint32_t {prefix}_{name.lower()} = {value};" for name, value, _ in part.values]
    lines += ["", "inline constexpr RegisterDescription table[] = {"]
    for register in peripheral.registers:
        lines.append(
            f'    {{"{register.name}", 0x{register.offset:03X}, '
            f"Access::{register.access.replace('-', '_')}, 0x{register.reset:08X}, "
            f"0x{register.writable_mask:08X}, 0x{register.one_to_clear_mask:08X}, "
            f"0x{register.readable_mask:08X}}},"
        )
    lines += ["};", "", "inline constexpr FieldDescription fields[] = {"]
    for register in peripheral.registers:
        lines += [
            f'    {{"{register.name}", "{part.name}", {part.low}, {part.mask.bit_count()}}},'
            for part in register.fields
            if not part.reserved
        ]
    return lines + ["};", "", f"}}  // namespace {peripheral.name.lower()}"]


def cpp_header(device, source):
    lines = [f"// {NOTICE.format(source=source)}", CPP_HEAD.rstrip("\n")]
    for peripheral in device.peripherals:
        lines += cpp_namespace(peripheral)
    return "\n".join(lines + ["", "}  // namespace capsoc::registers", ""])


MAP_HEAD = """#pragma once

#include <cstdint>

#include "capsoc_registers.h"
#include "kit/register_rule.h"

namespace capsoc::{name} {{

namespace description = registers::{name};
"""
# The prefix of a register's fields where it is not the register's name.
FIELD_PREFIXES = {"FLAGS": "flag", "TURN_FLAGS": "turn"}


def map_offsets(peripheral):
    lines = ["", "enum Offset : uint32_t {"]
    for register in peripheral.registers:
        lines.append(f"  reg_{register.name.lower()} = description::{register.name}_offset,")
    return lines + [f"  reg_last = reg_{peripheral.registers[-1].name.lower()},", "};"]


def map_fields(register):
    """One bit: its mask under the field's name; a wider field has _mask and _shift."""
    prefix = FIELD_PREFIXES.get(register.name, register.name.lower())
    lines = ["", f"// {register.name}"]
    for part in register.fields:
        if part.reserved:
            continue
        field_name = f"{prefix}_{part.name.lower()}"
        described = f"description::{register.name}_{part.name}"
        if part.low == part.high:
            lines.append(f"inline constexpr uint32_t {field_name} = {described}_mask;")
        else:
            lines.append(f"inline constexpr uint32_t {field_name}_mask = {described}_mask;")
            lines.append(f"inline constexpr unsigned {field_name}_shift = {described}_shift;")
    kept = register.mask(("read-write",))
    if kept:
        lines.append(f"inline constexpr uint32_t {prefix}_writable = 0x{kept:08X};  // and readable")
    return lines


def map_rules(peripheral):
    """One row for each word from the first register to the last, so that an offset finds its row by its number."""
    pairs = pairs_of(peripheral)
    halves = {half.name: number for number, pair in enumerate(pairs) for half in (pair.low, pair.high)}
    highs = {pair.high.name for pair in pairs}
    at = {register.offset: number for number, register in enumerate(peripheral.registers)}
    lines = ["", "// Pairs of registers, LO and HI, by offset.", "enum Pair : unsigned {"]
    lines += [f"  pair_{pair.name.lower()}," for pair in pairs]
    lines += ["  pair_count", "};", "", "// One row a word, from offset 0 to reg_last."]
    lines.append("inline constexpr registers::RegisterRule rules[] = {")
    for offset in range(0, peripheral.registers[-1].offset + 4, 4):
        if offset not in at:
            lines.append("    {},")
            continue
        register = peripheral.registers[at[offset]]
        lowest, highest = register.write_range or (0, WORD_MASK)
        pair = f"pair_{pairs[halves[register.name]].name.lower()}" if register.name in halves else "registers::no_pair"
        # Software may write any word to flags and to halves of a pair; elsewhere a reserved bit is worth a word.
        tells = register.writable_mask not in (0, WORD_MASK) and register.name not in halves
        lines.append(
            f"    {{&description::table[{at[offset]}], 0x{lowest:08X}, 0x{highest:08X}, {pair}, "
            f"{'true' if register.name in highs else 'false'}, "
            + (f'"reserved bits of {register.name} are ignored"' if tells else '""')
            + f"}},  // {register.name}"
        )
    lines += ["};"]
    if peripheral.words:
        lines += ["", "// Words of the memory in the RTL's register bank."]
        lines += [f"inline constexpr uint32_t word_{name.lower()} = {word};" for name, word in peripheral.words.items()]
    if peripheral.settings:
        names = ", ".join(f"reg_{register.name.lower()}" for register in peripheral.settings)
        lines += ["", "// Settings, in the order of their parity bits in the RTL."]
        lines += [f"inline constexpr uint32_t settings_registers[] = {{{names}}};"]
    return lines


def map_header(peripheral, source):
    """Short names for the model of a peripheral that is synthesised, and its rules."""
    name = peripheral.name.lower()
    lines = [f"// {NOTICE.format(source=source)}", MAP_HEAD.format(name=name).rstrip("\n")]
    lines += map_offsets(peripheral)
    for register in peripheral.registers:
        if register.fields:
            lines += map_fields(register)
    lines += map_rules(peripheral)
    return "\n".join(lines + ["", f"}}  // namespace capsoc::{name}", ""])


def cell(text):
    return text.replace("|", "\\|")


def access_word(part):
    return "write 1 to clear" if part.one_to_clear else part.access


def reference_page(device, source):
    lines = [f"<!-- {NOTICE.format(source=source)} -->", "# Registers", "", f"{device.description}."]
    for peripheral in device.peripherals:
        lines += ["", f"## {peripheral.name} (0x{peripheral.base:08X})", "", peripheral.description]
        for name, number, description in peripheral.interrupts:
            lines += ["", f"Interrupt {number}, {name}: {description}."]
        lines += ["", "| offset | name | access | reset | meaning |", "|---|---|---|---|---|"]
        for register in peripheral.registers + peripheral.optional:
            lines.append(
                f"| 0x{register.offset:03X} | {register.name} | {register.access} | "
                f"0x{register.reset:08X} | {cell(register.description)} |"
            )
        for register in peripheral.registers + peripheral.optional:
            if not register.fields:
                continue
            lines += [
                "",
                f"### {peripheral.name}.{register.name}",
                "",
                "| bits | field | access | meaning |",
                "|---|---|---|---|",
            ]
            for part in register.fields:
                if part.reserved:
                    continue
                bits = str(part.low) if part.low == part.high else f"{part.high}:{part.low}"
                values = "; ".join(f"{v} {n}: {d}" for n, v, d in part.values)
                meaning = part.description + (f" {values}." if values else "")
                lines.append(f"| {bits} | {part.name} | {access_word(part)} | {cell(meaning)} |")
    return "\n".join(lines + [""])


def sv_package(peripheral, source):
    """Plain localparams only: what Verilator, Icarus Verilog and Yosys all read."""
    name = f"capsoc_{peripheral.name.lower()}_pkg"
    # Registers are words of a block, so that all addresses of a package have one width.
    width = max(1, (peripheral.size - 1).bit_length())
    lines = [
        f"// {NOTICE.format(source=source)}",
        "// Offsets in bytes, reset values, bits that can be read and written, lowest and highest bit of every field "
        "(LSB, MSB).",
        f"package {name};",
        "",
        "  // No design needs every name of its description.",
        "  // verilator lint_off UNUSEDPARAM",
    ]
    for register in peripheral.registers + peripheral.optional:
        prefix = register.name
        lines += [
            "",
            f"  localparam logic [{width - 1}:0] {prefix}_OFFSET = "
            f"{width}'h{register.offset:0{(width + 3) // 4}X};",
            f"  localparam logic [31:0] {prefix}_RESET = 32'h{register.reset:08X};",
            f"  localparam logic [31:0] {prefix}_READABLE = 32'h{register.readable_mask:08X};",
            f"  localparam logic [31:0] {prefix}_WRITABLE = "
            f"32'h{register.writable_mask | register.one_to_clear_mask:08X};",
        ]
        if (word := peripheral.words.get(register.name)) is not None:
            lines.append(f"  localparam int {prefix}_WORD = {word};")
        for part in register.fields:
            if part.reserved:
                continue
            lines += [
                f"  localparam int {prefix}_{part.name}_LSB = {part.low};",
                f"  localparam int {prefix}_{part.name}_MSB = {part.high};",
            ]
            bits = part.high - part.low + 1
            lines += [
                f"  localparam logic [{bits - 1}:0] {prefix}_{part.name}_{value_name} = " f"{bits}'d{value};"
                for value_name, value, _ in part.values
            ]
    if peripheral.words:
        used = sum(1 << word for word in set(peripheral.words.values()))
        lines += [
            "",
            "  // Words of the bank's memory that are in use",
            f"  localparam logic [31:0] WORDS = 32'h{used:08X};",
        ]
    return "\n".join(lines + ["", "  // verilator lint_on UNUSEDPARAM", f"endpackage : {name}", ""])


def sv_fields(peripheral):
    """For each register with fields a type that names them. Members are fields, the highest first."""
    lines = ["", "// The words of registers, by field."]
    for register in peripheral.registers + peripheral.optional:
        if not register.fields:
            continue
        lines.append("typedef struct packed {")
        for part in reversed(register.fields):
            width = f"[{part.high - part.low}:0] " if part.high > part.low else ""
            lines.append(f"  logic {width}{part.name};")
        lines.append(f"}} capsoc_{peripheral.name.lower()}_{register.name.lower()}_t;")
    return lines


def any_of(registers):
    """One of these is selected."""
    return " | ".join(f"select_o.{register.name}" for register in registers) or "1'b0"


def sv_bits(target, width, registers, number):
    """Assigns for every bit of a number the registers whose number has it."""
    lines = []
    for bit in range(width):
        chosen = [register for register in registers if number(register) >> bit & 1]
        lines.append(f"  assign {target}[{bit}] = {any_of(chosen)};")
    return lines


def sv_word_address(peripheral):
    """A word's address is the low five bits of its number, unless the description sets another one."""
    lines = []
    moved = [register for register in peripheral.registers if register.name in peripheral.words]
    for bit in range(5):
        own = {register.name: register.offset // 4 >> bit & 1 for register in moved}
        due = {register.name: peripheral.words[register.name] >> bit & 1 for register in moved}
        falls = [register for register in moved if own[register.name] and not due[register.name]]
        rises = [register for register in moved if due[register.name] and not own[register.name]]
        text = f"address_i[{bit + 2}]"
        text += f" & ~({any_of(falls)})" if falls else ""
        lines.append(f"  assign word_o[{bit}] = {f'({text}) | {any_of(rises)}' if rises else text};")
    return lines


def sv_stored(peripheral, stored):
    """What a read shows of a word of the memory. Halves of pairs are there as they are read, and as 0 at reset."""
    halves = {half.name for pair in pairs_of(peripheral) for half in (pair.low, pair.high)}
    plain = [register for register in stored if register.name not in halves]
    lines = []
    for bit in range(32):
        hidden = [register for register in plain if not register.readable_mask >> bit & 1]
        high = [register for register in plain if register.reset >> bit & 1]
        lines.append(f"  assign readable_o[{bit}] = ~({any_of(hidden)});")
        lines.append(f"  assign reset_o[{bit}] = {any_of(high)};")
    return lines


def sv_refused(peripheral):
    """The value that is written is outside the register's range."""
    ranges = {}
    for register in peripheral.registers:
        if register.write_range:
            ranges.setdefault(register.write_range, []).append(register)
    terms = []
    for (low, high), registers in ranges.items():
        if low == 0 and high & (high + 1) == 0:
            above = high.bit_length()
            outside = "write_data_i[31]" if above == 31 else f"|write_data_i[31:{above}]"
        else:
            outside = f"write_data_i < 32'd{low} | write_data_i > 32'd{high}"
        terms.append(f"(({outside}) & ({any_of(registers)}))")
    return " | ".join(terms) or "1'b0"


def sv_selects(peripheral, source):
    """The type with one bit for each register, the types of fields, and the decoder. The types stand outside of the
    package, for the reason that rtl/coprocessor_types.sv gives."""
    name = f"capsoc_{peripheral.name.lower()}_selects"
    groups = f"capsoc_{peripheral.name.lower()}_groups"
    pairs = pairs_of(peripheral)
    words = [register.offset // 4 for register in peripheral.registers]
    width = max(1, (peripheral.size - 1).bit_length())
    bits = max(words, default=0).bit_length() or 1  # of the number of a word; the address has zeros above
    gaps = [word for word in range(1 << bits) if word not in words]
    above = f"address_i[{width - 1}:{bits + 2}] == '0 & " if width > bits + 2 else ""
    result_bits = max(1, (len(peripheral.results) - 1).bit_length())
    stored = [register for register in peripheral.registers if register.name in peripheral.words]
    lines = [
        f"// {NOTICE.format(source=source)}",
        "// Which register an address names: one bit for each. The bits look at the number of the word alone; "
        "mapped_o says",
        "// whether there is a register at this address.",
        "typedef struct packed {",
    ]
    lines += [f"  logic {register.name};" for register in peripheral.registers]
    lines += [
        f"}} {name}_t;",
        "",
        "// What kind of register it is: HI of a pair, one of both, a result, a word of the memory. As the bits above.",
        "typedef struct packed {",
        "  logic high, pair, result, stored;",
        f"}} {groups}_t;",
    ]
    lines += sv_fields(peripheral)
    lines += [
        "",
        f"module {name} (",
        f"  input  logic [{width - 1}:0] address_i,  // of a byte",
        "  input  logic [31:0] write_data_i,",
        f"  output {name}_t select_o,",
        f"  output {groups}_t group_o,",
        f"  output logic [{result_bits - 1}:0] result_o,  // number of a result; 0 for others",
        "  output logic [4:0] word_o,  // address in the bank's memory, of a register that is there",
        "  output logic [31:0] readable_o,  // bits of a word of the memory that a read shows",
        "  output logic [31:0] reset_o,  // what a word of the memory that was never written reads as",
        "  output logic refused_o,  // the register takes no such value",
        "  output logic mapped_o",
        ");",
        "",
        f"  logic [{bits - 1}:0] word;",
        f"  logic [{len(words) - 1}:0] hits;",
        f"  assign word = address_i[{bits + 1}:2];",
    ]
    lines += [
        f"  assign hits[{len(words) - 1 - place}] = word == {bits}'h{word:0{(bits + 3) // 4}X};  // {register.name}"
        for place, (word, register) in enumerate(zip(words, peripheral.registers))
    ]
    # Few words have no register: they take less than an OR over all that have one.
    inside = "".join(f" & word != {bits}'h{word:0{(bits + 3) // 4}X}" for word in gaps)
    lines += ["  assign select_o = hits;", f"  assign mapped_o = {above}address_i[1:0] == '0{inside};", ""]
    lines += [
        "  logic low, high;",
        f"  assign low = {any_of([pair.low for pair in pairs])};",
        f"  assign high = {any_of([pair.high for pair in pairs])};",
        "  assign group_o.high = high;",
        "  assign group_o.pair = low | high;",
        f"  assign group_o.result = {any_of(peripheral.results)};",
        f"  assign group_o.stored = {any_of(stored)};",
    ]
    numbers = {register.name: number for number, register in enumerate(peripheral.results)}
    lines += sv_bits("result_o", result_bits, peripheral.results, lambda register: numbers[register.name])
    lines += sv_word_address(peripheral)
    lines += sv_stored(peripheral, stored)
    lines += [
        f"  assign refused_o = {sv_refused(peripheral)};",
        "  logic unused_data;  // of a word that only some bits decide about",
        "  assign unused_data = ^write_data_i;",
    ]
    return "\n".join(lines + ["", f"endmodule : {name}", ""])


def reserved_values(register):
    """What a write must not contain: a word outside a range, a field outside its enumeration."""
    rules = []
    if register.write_range:
        low, high = register.write_range
        rules.append({"rule": "range", "minimum": low, "maximum": high})
    for part in register.fields:
        bits = part.high - part.low + 1
        if part.reserved or not part.values or part.access == "read-only" or bits > 8:
            continue
        named = {value for _, value, _ in part.values}
        unnamed = [value for value in range(1 << bits) if value not in named]
        if unnamed:
            rules.append({"rule": "field", "field": part.name, "low": part.low, "high": part.high, "values": unnamed})
    return rules


def test_table(device, source):
    """Every register for programs: masks as numbers, reserved write values as rules."""
    peripherals = {}
    for peripheral in device.peripherals:
        registers = [
            {
                "name": register.name,
                "offset": register.offset,
                "access": register.access,
                "reset": register.reset,
                "implemented": (register.readable_mask | register.writable_mask | register.one_to_clear_mask),
                "readable": register.readable_mask,
                "writable": register.writable_mask,
                "one_to_clear": register.one_to_clear_mask,
                "reserved_values": reserved_values(register),
            }
            for register in peripheral.registers
        ]
        peripherals[peripheral.name] = {"base": peripheral.base, "size": peripheral.size, "registers": registers}
    table = {"notice": NOTICE.format(source=source), "peripherals": peripherals}
    return json.dumps(table, indent=1) + "\n"


def texts(source):
    device = read_device(source)
    made = {
        name: make(device, source.name)
        for name, make in (
            ("capsoc_device.h", device_header),
            ("capsoc_registers.h", cpp_header),
            ("registers.md", reference_page),
            ("capsoc_registers.json", test_table),
        )
    }
    for peripheral in device.peripherals:
        if peripheral.name in SYNTHESISED:
            for part, make in (("map.h", map_header), ("pkg.sv", sv_package), ("selects.sv", sv_selects)):
                made[f"capsoc_{peripheral.name.lower()}_{part}"] = make(peripheral, source.name)
        if peripheral.settings:
            notice = NOTICE.format(source=source.name)
            made[f"capsoc_{peripheral.name.lower()}_settings.sv"] = sv_settings(peripheral, notice)
            made[f"capsoc_{peripheral.name.lower()}_settings.def"] = setting_rows(peripheral, notice)
    return made


def main(arguments):
    return generate(arguments, "registers DESCRIPTION.svd OUTPUT_DIRECTORY", texts)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
