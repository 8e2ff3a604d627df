"""Peripheral registers by name in GDB, from a CMSIS-SVD description.

    (gdb) source scripts/debugger/svd.py          # loads the registers of the whole board
    (gdb) svd load FILE.svd                  # adds another one
    (gdb) svd list [PERIPHERAL]              # peripherals, or the registers of one
    (gdb) svd COPROCESSOR                    # all its registers that can be read
    (gdb) svd COPROCESSOR.STATUS             # one, with its fields
    (gdb) print $svd("COPROCESSOR.STATUS.LOCK")

Names are completed by Tab and taken in any case. Registers whose reading has a side effect (readAction) or that are
write-only are shown by "svd PERIPHERAL.REGISTER" and not by "svd PERIPHERAL". The parser at the top knows nothing of
GDB.
"""

import copy
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

try:
    import gdb
except ImportError:  # for the tests of the parser
    gdb = None


class SvdError(Exception):
    """One sentence that says what is wrong."""


def number(text):
    """A number of the schema: decimal, 0x.., #binary, 0bbinary; decimal with k, M, G, T."""
    text = text.strip().lstrip("+")
    scale = 1
    if text and not text.lower().startswith("0x") and text[-1] in "kKmMgGtT":
        scale = 1024 ** ("kmgt".index(text[-1].lower()) + 1)
        text = text[:-1]
    if text.startswith("#") or text.lower().startswith("0b"):
        return int(text.lstrip("#").lower().replace("0b", "").replace("x", "0"), 2) * scale
    return int(text, 16 if text.lower().startswith("0x") else 10) * scale


def text_of(element, name, default=None):
    """The text of a child, its white space joined."""
    found = element.find(name)
    return default if found is None or found.text is None else " ".join(found.text.split())


def name_of(element):
    name = text_of(element, "name")
    if not name:
        raise ValueError(f"a {element.tag} has no name")
    return name


def within(value, low, high, what):
    """A number that is used for something; a damaged file would have any."""
    if not low <= value <= high:
        raise ValueError(f"{what} is {value}, not {low} to {high}")
    return value


class Field:
    def __init__(self, element):
        self.name = name_of(element)
        self.description = text_of(element, "description", "")
        if element.find("bitRange") is not None:
            self.high, self.low = map(int, re.match(r"\[(\d+):(\d+)\]", text_of(element, "bitRange")).groups())
        elif element.find("lsb") is not None:
            self.low, self.high = number(text_of(element, "lsb")), number(text_of(element, "msb"))
        else:
            self.low = number(text_of(element, "bitOffset"))
            self.high = self.low + number(text_of(element, "bitWidth", "32")) - 1
        within(self.high, 0, 63, f"the last bit of {self.name}")
        within(self.low, 0, self.high, f"the first bit of {self.name}")
        self.values = {}
        for value in element.iterfind("enumeratedValues/enumeratedValue"):
            if value.find("value") is not None:
                self.values[number(text_of(value, "value"))] = text_of(value, "name")

    def of(self, word):
        return word >> self.low & (1 << self.high - self.low + 1) - 1


class Register:
    def __init__(self, name, address, element, inherited):
        self.name, self.address = name, within(address, 0, 0xFFFFFFFF, f"the address of {name}")
        self.description = text_of(element, "description", "")
        self.size = within(number(inherited["size"]) // 8, 1, 8, f"the size of {name} in bytes")
        self.access = inherited["access"]
        self.has_side_effect = element.find("readAction") is not None
        self.is_signed = text_of(element, "dataType", "").startswith("int")
        self.fields = [Field(field) for field in element.iterfind("fields/field")]
        fractions = re.findall(r"\bQ\d+\.(\d+)\b", self.description)
        self.fraction = int(fractions[-1]) if fractions else None  # "Q2.46 rounded to Q1.31"
        self.is_angle = re.search(r"\b2\^-32 turn\b", self.description) is not None

    @property
    def readable(self):
        return self.access not in ("write-only", "writeOnce")

    def field(self, name):
        for field in self.fields:
            if field.name.upper() == name.upper():
                return field
        raise SvdError(f"{self.name} has no field {name}: it has {', '.join(f.name for f in self.fields) or 'none'}")

    def meaning(self, word):
        """What a word stands for, as text; empty if it is just a number."""
        signed = word - (word >> 31 << 32) if self.is_signed and self.size == 4 else word
        if self.is_angle and self.size == 4:
            return f"{signed * 360 / 2 ** 32:.7f} degrees"
        if self.fraction is not None:
            return f"{signed / 2 ** self.fraction:.10f}"
        return f"{signed}"


def expand(element):
    """Name and offset of each element of a dim array (or of the one element)."""
    name, count = name_of(element), text_of(element, "dim")
    if count is None:
        return [(name, 0)]
    most = 1 << 12
    step, indices = number(text_of(element, "dimIncrement")), text_of(element, "dimIndex")
    if indices is None:
        indices = [str(i) for i in range(within(number(count), 0, most, f"how many {name} there are"))]
    elif re.fullmatch(r"\d+-\d+", indices):
        first, last = map(int, indices.split("-"))
        indices = [str(i) for i in range(first, within(last, 0, first + most, f"the last {name}") + 1)]
    elif re.fullmatch(r"[A-Z]-[A-Z]", indices):
        indices = [chr(code) for code in range(ord(indices[0]), ord(indices[2]) + 1)]
    else:
        indices = [index.strip() for index in indices.split(",")]
    return [(name.replace("[%s]", index).replace("%s", index), i * step) for i, index in enumerate(indices)]


class Peripheral:
    def __init__(self, element, inherited):
        self.name = name_of(element)
        self.description = text_of(element, "description", "")
        self.base = number(text_of(element, "baseAddress"))
        self.registers = {}
        self.expanded = 0
        if element.find("registers") is not None:
            self.add(element.find("registers"), "", self.base, self.inherit(element, inherited))

    @staticmethod
    def inherit(element, inherited):
        return {key: text_of(element, key, value) for key, value in inherited.items()}

    def add(self, parent, prefix, base, inherited):
        """Registers and clusters of an element, by upper-case name."""
        originals = {text_of(e, "name"): e for e in parent.iterfind("register")}
        for element in parent:
            if element.tag not in ("register", "cluster"):
                continue
            element = derived(element, originals)
            for name, offset in expand(element):
                self.expanded = within(self.expanded + 1, 0, 1 << 16, f"how many registers {self.name} has")
                address = base + number(text_of(element, "addressOffset")) + offset
                settings = self.inherit(element, inherited)
                if element.tag == "cluster":
                    self.add(element, f"{prefix}{name}_", address, settings)
                else:
                    self.registers[(prefix + name).upper()] = Register(prefix + name, address, element, settings)

    def register(self, name):
        if name.upper() not in self.registers:
            raise SvdError(f"{self.name} has no register {name}; `svd list {self.name}` names them")
        return self.registers[name.upper()]


def derived(element, originals):
    """An element with derivedFrom completed by what it derives from."""
    origin = originals.get(element.get("derivedFrom"))
    if origin is None:
        return element
    whole = copy.deepcopy(origin)
    for child in element:
        for old in whole.findall(child.tag):
            whole.remove(old)
        whole.append(child)
    return whole


def load(path):
    """The peripherals of a description, by upper-case name."""
    try:
        device = ElementTree.parse(path).getroot()
        if device.tag != "device":
            raise SvdError(f"{path}: is no CMSIS-SVD description; its root is <{device.tag}>")
        inherited = Peripheral.inherit(device, {"size": "32", "access": "read-write"})
        elements = device.findall("peripherals/peripheral")
        originals = {text_of(e, "name"): e for e in elements}
        peripherals = [Peripheral(derived(e, originals), inherited) for e in elements]
        return {p.name.upper(): p for p in peripherals}
    except OSError as error:
        raise SvdError(f"{path}: cannot be read ({error.strerror})") from error
    except (ElementTree.ParseError, AttributeError, TypeError, ValueError, KeyError, RecursionError) as error:
        raise SvdError(f"{path}: is no sound CMSIS-SVD description ({error})") from error


class Device:
    """Everything loaded so far."""

    def __init__(self):
        self.peripherals = {}

    def load(self, path):
        found = load(path)
        self.peripherals.update(found)
        return len(found)

    def peripheral(self, name):
        if name.upper() not in self.peripherals:
            raise SvdError(f"there is no peripheral {name}; `svd list` names them")
        return self.peripherals[name.upper()]

    def find(self, path):
        """Peripheral, register or None, field or None of "P", "P.R" or "P.R.F"."""
        names = path.split(".")
        if len(names) > 3:
            raise SvdError(f"{path}: give PERIPHERAL.REGISTER.FIELD at the most")
        peripheral = self.peripheral(names[0])
        register = peripheral.register(names[1]) if len(names) > 1 else None
        field = register.field(names[2]) if len(names) > 2 else None
        return peripheral, register, field

    def complete(self, text):
        """What "COPRO", "COPROCESSOR.ST" or "COPROCESSOR.STATUS.L" may become."""
        *path, start = text.upper().split(".")
        try:
            if not path:
                choices = [p.name for p in self.peripherals.values()]
            elif len(path) == 1:
                choices = [f"{path[0]}.{name}" for name in self.peripheral(path[0]).registers]
            else:
                register = self.peripheral(path[0]).register(path[1])
                choices = [f"{path[0]}.{path[1]}.{field.name}" for field in register.fields]
        except SvdError:
            return []
        return [choice for choice in choices if choice.upper().startswith(text.upper())]


if gdb is not None:
    DEVICE = Device()

    def read(register):
        """A register's word from the target; servers without side effects leave it as it is."""
        memory = gdb.selected_inferior().read_memory(register.address, register.size)
        return int.from_bytes(bytes(memory), "little")

    def line(register, word):
        return (
            f"{register.name:<20} {register.address:#010x}  {word:#0{2 + 2 * register.size}x}  {register.meaning(word)}"
        )

    def show_fields(register, word):
        for field in register.fields:
            if field.name.startswith("RESERVED"):
                continue
            value = field.of(word)
            name = field.values.get(value)
            bits = f"[{field.high}:{field.low}]" if field.high != field.low else f"[{field.low}]"
            print(f"    {bits:<8} {field.name:<16} {value:#x}{' ' + name if name else ''}  {field.description}")

    class SvdCommand(gdb.Command):
        """Registers of peripherals by name: svd load FILE, svd list [P], svd P, svd P.REGISTER[.FIELD]."""

        def __init__(self):
            super().__init__("svd", gdb.COMMAND_DATA)

        def invoke(self, argument, from_tty):
            del from_tty
            words = gdb.string_to_argv(argument)
            try:
                if words[:1] == ["load"] and len(words) == 2:
                    print(f"{DEVICE.load(words[1])} peripherals")
                elif words[:1] == ["list"] and len(words) <= 2:
                    self.list(words[1:])
                elif len(words) == 1:
                    self.show(words[0])
                else:
                    raise SvdError("give: svd load FILE, svd list [PERIPHERAL], svd PERIPHERAL[.REGISTER[.FIELD]]")
            except SvdError as error:
                raise gdb.GdbError(str(error)) from error

        @staticmethod
        def list(names):
            if names:
                for register in DEVICE.peripheral(names[0]).registers.values():
                    print(f"{register.name:<20} {register.address:#010x}  {register.access:<11} {register.description}")
                return
            for peripheral in DEVICE.peripherals.values():
                print(f"{peripheral.name:<20} {peripheral.base:#010x}  {peripheral.description}")

        @staticmethod
        def show(path):
            peripheral, register, field = DEVICE.find(path)
            if register is None:
                for each in peripheral.registers.values():
                    if each.readable and not each.has_side_effect:
                        print(line(each, read(each)))
                return
            word = read(register)
            if field is not None:
                value = field.of(word)
                print(f"{register.name}.{field.name} = {value:#x} {field.values.get(value, '')}".rstrip())
                return
            print(line(register, word))
            show_fields(register, word)

        def complete(self, text, word):
            argument = text.lstrip()
            if argument.startswith("load "):
                return gdb.COMPLETE_FILENAME
            if argument.startswith("list "):
                return DEVICE.complete(argument[5:])
            found = DEVICE.complete(argument)
            if "." not in argument:
                found += [each for each in ("load", "list") if each.startswith(argument)]
            # GDB asks for what follows the last break of a word.
            cut = len(argument) - len(word or "")
            return [each[cut:] for each in found]

    class SvdFunction(gdb.Function):
        """$svd("PERIPHERAL.REGISTER[.FIELD]"): the value, as an unsigned number."""

        def __init__(self):
            super().__init__("svd")

        def invoke(self, path):
            try:
                _, register, field = DEVICE.find(path.string())
                if register is None:
                    raise SvdError(f"{path.string()}: name a register of it")
            except SvdError as error:
                raise gdb.GdbError(str(error)) from error
            word = read(register)
            return gdb.Value(field.of(word) if field else word).cast(gdb.lookup_type("unsigned long"))

    SvdCommand()
    SvdFunction()
    # Not __file__: in a script that sources this one it is that script's.
    HERE = Path((lambda: None).__code__.co_filename).resolve().parent
    for DEFAULT in (
        HERE / "board.svd",  # a project of capsoc new; the sources, built and not; an install tree
        HERE.parents[1] / "build/generated/board.svd",
        HERE.parents[1] / "models/registers/capsoc.svd",
        HERE.parent / "svd/board.svd",
    ):
        if DEFAULT.exists():
            DEVICE.load(DEFAULT)
            break
