#!/usr/bin/env python3
"""Names of files and functions in coverage, reports and profiles: programs compiled in other folders, by other
compilers and in other versions of DWARF; names that are not ASCII; names of C++ and Rust. Oracles: addr2line,
c++filt, lcov, genhtml."""

import os
import re
import subprocess
import unittest

from harness import CAPSOC, CLEAN, Case

CTEST = {"name": "names"}

GCC = ("arm-none-eabi-gcc", "-mcpu=cortex-m3", "-mthumb", "-ffreestanding", "-O1")
CLANG = ("clang", "--target=thumbv7m-none-eabi", "-ffreestanding", "-O1")
LINK = ("arm-none-eabi-gcc", "-mcpu=cortex-m3", "-mthumb", "-nostdlib", "-nostartfiles", "-Wl,--no-warn-rwx-segments")

SCRIPT = """ENTRY(reset)
SECTIONS {
  .text 0 : { KEEP(*(.vectors)) *(.text*) *(.rodata*) }
  .ARM.exidx : { *(.ARM.exidx*) }
  .data 0x20000000 : { *(.data*) *(.bss*) *(COMMON) }
}
"""
START = """extern int main(void);
static void fault(void) {
  for (;;) {
  }
}
void reset(void) {
  static const unsigned end[2] = {0x20026, 0};
  main();
  register unsigned operation __asm__("r0") = 0x20;
  register const unsigned* argument __asm__("r1") = end;
  __asm__ volatile("bkpt 0xab" : "+r"(operation) : "r"(argument) : "memory");
  for (;;) {
  }
}
__attribute__((section(".vectors"), used)) static void* const vectors[16] = {
  (void*)0x20010000, (void*)reset, (void*)fault, (void*)fault};
"""
PART = """int part(int x);
__attribute__((noinline)) int part(int x) {
  if (x > 2) return 2 * x;
  return x;
}
"""
MAIN = """int part(int x);
volatile int sum;
int main(void) {
  for (int i = 0; i < 5; ++i) sum += part(i);
  return 0;
}
"""


class ProgramCase(Case):
    maxDiff = 4000

    def setUp(self):
        super().setUp()
        self.write("link.ld", SCRIPT)
        self.write("start.c", START)

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def do(self, *command, cwd=".", code=0, **more):
        where = self.folder / cwd
        where.mkdir(parents=True, exist_ok=True)
        done = subprocess.run(
            [str(c) for c in command], cwd=where, capture_output=True, timeout=120, check=False, env=CLEAN, **more
        )
        self.assertEqual(done.returncode, code, (command, done.stdout, done.stderr))
        return (done.stdout + done.stderr).decode()

    def link(self, elf, *objects):
        """The start-up has no lines: only the program's sources are expected."""
        (self.folder / elf).parent.mkdir(parents=True, exist_ok=True)
        self.do(*GCC, "-c", self.folder / "start.c", "-o", self.folder / "start.o")
        self.do(
            *LINK, "-T", self.folder / "link.ld", self.folder / "start.o", *objects, "-o", self.folder / elf, "-lgcc"
        )
        return self.folder / elf

    def cover(self, elf, cwd="elsewhere", code=0):
        file = self.folder / "c.info"
        file.unlink(missing_ok=True)
        said = self.do(CAPSOC, "run", elf, "--coverage", file, cwd=cwd, code=code)
        return file.read_text() if code == 0 else said

    def sources(self, text):
        return {line[3:] for line in text.splitlines() if line.startswith("SF:")}

    def counts(self, text, source):
        record = text[text.index(f"SF:{source}\n") :]
        record = record[: record.index("end_of_record")]
        return {int(n): int(c) for n, c in re.findall(r"^DA:(\d+),(\d+)$", record, re.MULTILINE)}

    def check(self, elf, main, part, cwd="elsewhere"):
        """`part` is called five times, and genhtml finds each source."""
        text = self.cover(elf, cwd)
        self.assertEqual(self.sources(text), {str(main), str(part)})
        self.assertEqual(self.counts(text, part)[3], 5)
        self.assertIn("FNDA:5,part\n", text)
        self.assertEqual(self.counts(text, main)[4], 5)
        self.do("genhtml", "-q", "-o", self.folder / "html", self.folder / "c.info", cwd="elsewhere")
        self.do("lcov", "--summary", self.folder / "c.info", cwd="elsewhere")


class Folders(ProgramCase):
    def setUp(self):
        super().setUp()
        self.main, self.part = self.write("project/src/main.c", MAIN), self.write("project/src/lib/part.c", PART)

    def build(self, compiler, *options, sources=("../src/main.c", "../src/lib/part.c"), cwd="project/build"):
        objects = []
        for number, source in enumerate(sources):
            objects.append(self.folder / f"{number}.o")
            self.do(*compiler, "-g", *options, "-c", source, "-o", objects[-1], cwd=cwd)
        return self.link("project/build/app.elf", *objects)

    def test_compiled_in_a_folder_beside_the_sources(self):
        for compiler in (GCC, CLANG):
            for options in (
                (),
                ("-gdwarf-2",),
                ("-gdwarf-3",),
                ("-gdwarf-4",),
                ("-gdwarf-5",),
                ("-gdwarf-4", "-gsplit-dwarf"),
                ("-gdwarf-5", "-gsplit-dwarf"),
            ):
                with self.subTest(compiler=compiler[0], options=options):
                    self.check(self.build(compiler, *options), self.main, self.part)

    def test_compiled_in_other_ways(self):
        for compiler in (GCC, CLANG):
            for options in (("-gdwarf-4",), ("-gdwarf-5",)):
                for cwd, sources in (
                    ("project/src", ("main.c", "lib/part.c")),
                    ("project/src", ("./main.c", "./lib/../lib/part.c")),
                    ("project/src/lib", ("../main.c", "part.c")),
                    ("a/b", (self.main, self.part)),
                    ("a/b", ("../../project/src/main.c", self.part)),
                ):
                    with self.subTest(compiler=compiler[0], options=options, cwd=cwd, sources=sources):
                        self.check(self.build(compiler, *options, sources=sources, cwd=cwd), self.main, self.part)

    def test_prefix_maps(self):
        root = self.folder / "project"
        for compiler in (GCC, CLANG):
            for options in (("-gdwarf-4",), ("-gdwarf-5",)):
                for sources in (("../src/main.c", "../src/lib/part.c"), (self.main, self.part)):
                    for mapped in (f"{root}=.", f"{root}/="):
                        with self.subTest(compiler=compiler[0], options=options, sources=sources, mapped=mapped):
                            elf = self.build(compiler, *options, f"-fdebug-prefix-map={mapped}", sources=sources)
                            self.check(elf, self.main, self.part)
                            self.check(elf, self.main, self.part, cwd="project")

    def test_two_sources_of_one_name(self):
        second = self.write("project/src/lib/main.c", PART)
        for options in (("-gdwarf-4",), ("-gdwarf-5",)):
            objects = [self.folder / "1.o", self.folder / "2.o"]
            self.do(*GCC, "-g", *options, "-c", "main.c", "-o", objects[0], cwd="project/src")
            self.do(*GCC, "-g", *options, "-c", "main.c", "-o", objects[1], cwd="project/src/lib")
            self.check(self.link("two.elf", *objects), self.main, second)

    def test_a_folder_that_is_a_link(self):
        (self.folder / "far/away").mkdir(parents=True)
        (self.folder / "project/build").symlink_to(self.folder / "far/away")
        source = self.write("far/src/main.c", MAIN)
        for options in (("-gdwarf-4",), ("-gdwarf-5",)):
            objects = [self.folder / "1.o", self.folder / "2.o"]
            self.do(*GCC, "-g", *options, "-c", "build/../src/main.c", "-o", objects[0], cwd="project")
            self.do(*GCC, "-g", *options, "-c", "src/lib/part.c", "-o", objects[1], cwd="project")
            text = self.cover(self.link("linked.elf", *objects))
            # The compiler was given far/src/main.c by way of the link; project/src/main.c is there, too.
            self.assertIn(str(self.part), self.sources(text))
            self.assertTrue({str(source), str(self.main)} & self.sources(text))

    def test_a_path_that_is_long(self):
        source = self.write("/".join(["a folder with a long name" * 3] * 6) + "/part.c", PART)
        objects = [self.folder / "1.o", self.folder / "2.o"]
        self.do(*GCC, "-g", "-c", self.main, "-o", objects[0])
        self.do(*GCC, "-g", "-c", source, "-o", objects[1])
        self.check(self.link("long.elf", *objects), self.main, source)

    def test_no_source_is_here(self):
        elf = self.build(GCC, f"-ffile-prefix-map={self.folder}/project=/nowhere")
        said = self.cover(elf, code=2)
        self.assertRegex(
            said,
            r"^capsoc: --coverage: \S+app\.elf: none of its 2 source files is on this machine "
            r"\(the first: \S*main\.c\); .*\n$",
        )

    def test_a_library_that_was_compiled_elsewhere_is_left_out(self):
        library = self.write("library/part.c", PART)
        objects = [self.folder / "1.o", self.folder / "2.o"]
        self.do(*GCC, "-g", "-c", self.main, "-o", objects[0])
        self.do(*GCC, "-g", "-c", library, "-o", objects[1])
        library.unlink()
        self.assertEqual(self.sources(self.cover(self.link("library.elf", *objects))), {str(self.main)})

    def test_addr2line_names_the_same_files(self):
        elf = self.build(GCC)
        addresses = [
            line.split()[0]
            for line in self.do("arm-none-eabi-nm", elf).splitlines()
            if line.split()[-1] in ("main", "part")
        ]
        named = {
            os.path.normpath(line.rpartition(":")[0])
            for line in self.do("arm-none-eabi-addr2line", "-e", elf, *addresses).splitlines()
        }
        self.assertEqual(self.sources(self.cover(elf)), named)


class NotAscii(ProgramCase):
    def test_folders_files_and_functions(self):
        main = self.write(
            "Öl prüfen/größe.c",
            """volatile int summe;
__attribute__((noinline)) int größe(int π) {
  if (π == 3) *(volatile int*)0x60000000 = π;
  return π;
}
int main(void) {
  for (int i = 0; i < 4; ++i) summe += größe(i);
  return 0;
}
""",
        )
        for compiler in (GCC, CLANG):
            self.do(*compiler, "-g", "-c", main.name, "-o", self.folder / "1.o", cwd=main.parent)
            elf = self.link("日本.elf", self.folder / "1.o")
            file = self.folder / "c.info"
            file.unlink(missing_ok=True)
            said = self.do(
                CAPSOC,
                "run",
                elf,
                "--coverage",
                file,
                "--profile",
                self.folder / "p.folded",
                "--json",
                self.folder / "r.json",
                "--trace-instructions",
                self.folder / "t.txt",
                code=5,
            )
            text = file.read_text()
            self.assertEqual(self.sources(text), {str(main)})
            self.assertIn("FNDA:4,größe\n", text)
            self.assertRegex(
                said, r"größe\S*, .*/Öl prüfen/größe\.c:3" if compiler == CLANG else r"größe\S*, .*größe\.c:3"
            )
            self.assertIn(";größe ", (self.folder / "p.folded").read_text())
            self.assertIn(" größe ", (self.folder / "t.txt").read_text())
            self.assertIn("größe.c:3", (self.folder / "r.json").read_text())
            self.do("genhtml", "-q", "-o", self.folder / "html", file)
            self.do(CAPSOC, "run", elf, "--profile", self.folder / "p.out", code=5)
            profile = (self.folder / "p.out").read_text()
            self.assertRegex(profile, r"\nc?f[il]=\(\d+\) .*größe\.c\n")
            self.assertRegex(profile, r"\nfn=\(\d+\) größe\n")
            annotated = subprocess.run(
                ["callgrind_annotate", self.folder / "p.out"], capture_output=True, check=True, env=CLEAN
            ).stdout
            self.assertIn("größe", annotated.decode())
            self.do(
                CAPSOC, "run", elf, "-C", "trace.start=größe", "--trace-instructions", self.folder / "t.txt", code=5
            )

    def test_a_name_in_another_encoding_finds_its_file(self):
        name = b"gr\xf6\xdfe.c"
        path = os.fsencode(self.folder) + b"/" + name
        with open(path, "w") as file:
            file.write(MAIN)
        self.write("part.c", PART)
        subprocess.run([*GCC, "-g", "-c", path, "-o", self.folder / "1.o"], check=True)
        self.do(*GCC, "-g", "-c", "part.c", "-o", self.folder / "2.o")
        elf = self.link("app.elf", self.folder / "1.o", self.folder / "2.o")
        self.do(CAPSOC, "run", elf, "--coverage", self.folder / "c.info")
        self.assertIn(b"SF:" + path + b"\n", (self.folder / "c.info").read_bytes())

    def test_control_characters_are_replaced(self):
        self.write(
            "main.c",
            "__attribute__((noinline)) int placeholder(void) { return *(volatile int*)0x60000000; }\n"
            "int main(void) { return placeholder() + 1; }\n",
        )
        self.do(*GCC, "-g", "-c", "main.c", "-o", "1.o")
        damaged = self.folder / "1.o"
        damaged.write_bytes(damaged.read_bytes().replace(b"placeholder", b"f\x1b[31m\xc2\x9b\xff12"))
        elf = self.link("app.elf", self.folder / "1.o")
        said = self.do(
            CAPSOC, "run", elf, "--coverage", self.folder / "c.info", "--profile", self.folder / "p.folded", code=5
        )
        for text in (said, (self.folder / "c.info").read_text(), (self.folder / "p.folded").read_text()):
            self.assertNotRegex(text, "[\x00-\x08\x0b-\x1f\x7f-\x9f]")
        self.assertIn("f?[31m???12", (self.folder / "c.info").read_text())


CPP = """namespace outer {
template <typename T> struct Box {
  explicit Box(T v);
  ~Box();
  T get(const char* why, int n) const;
  T value;
};
template <typename T> __attribute__((noinline)) Box<T>::Box(T v) : value(v) {}
template <typename T> __attribute__((noinline)) Box<T>::~Box() { value = 0; }
template <typename T> __attribute__((noinline)) T Box<T>::get(const char*, int n) const {
  if (n == 2) *(volatile int*)0x60000000 = 1;
  return value + n;
}
}
volatile int sum;
extern "C" int rust_v0() __asm__("_RNvNtCs1234_7mycrate3foo3bar");
extern "C" __attribute__((noinline)) int rust_v0() { return sum; }
extern "C" int rust_legacy() __asm__("_ZN4core3fmt9Formatter3pad17h0123456789abcdefE");
extern "C" __attribute__((noinline)) int rust_legacy() { return sum + 1; }
extern "C" int main() {
  outer::Box<int> box(3);
  for (int i = 0; i < 3; ++i) sum = box.get("x", i) + rust_v0() + rust_legacy();
  return 0;
}
"""


class Demangled(ProgramCase):
    def build(self, compiler=GCC):
        self.write("main.cpp", CPP)
        self.do(*compiler, "-x", "c++", "-fno-exceptions", "-fno-rtti", "-g", "-c", "main.cpp", "-o", "1.o")
        return self.link("app.elf", self.folder / "1.o")

    def filtered(self, elf):
        """What c++filt makes of the functions' symbols."""
        names = [
            line.split()[-1] for line in self.do("arm-none-eabi-nm", elf).splitlines() if line.split()[-2] in "tTwW"
        ]
        names = [name for name in names if name not in ("reset", "fault", "vectors") and "." not in name]
        return dict(zip(names, self.do("c++filt", "--no-verbose", *names).splitlines()))

    def test_coverage_profile_and_reports(self):
        for compiler in (GCC, CLANG):
            elf = self.build(compiler)
            names = self.filtered(elf)
            get = next(name for mangled, name in names.items() if "get" in mangled)
            self.assertEqual(get, "outer::Box<int>::get(char const*, int) const")
            file = self.folder / "c.info"
            file.unlink(missing_ok=True)
            said = self.do(
                CAPSOC,
                "run",
                elf,
                "--coverage",
                file,
                "--profile",
                self.folder / "p.folded",
                "--trace-instructions",
                self.folder / "t.txt",
                code=5,
            )
            functions = {
                name: int(calls) for calls, name in re.findall(r"^FNDA:(\d+),(.*)$", file.read_text(), re.MULTILINE)
            }
            self.assertEqual(set(functions), set(names.values()))
            self.assertEqual(functions[get], 3)
            constructor = next(name for name in functions if "Box(int)" in name and "~" not in name)
            self.assertEqual(functions[constructor], 1, "two symbols of one constructor are one function")
            for name in ("mycrate::foo::bar", "core::fmt::Formatter::pad"):
                self.assertEqual(functions[name], 2)
                self.assertIn(f";{name} ", (self.folder / "p.folded").read_text())
            self.assertRegex(said, r" by +0x\w+  " + re.escape(get) + r"\S*, \S*main\.cpp:11,")
            self.assertRegex(said, r"#0 +0x\w+  " + re.escape(get) + r", \S*main\.cpp:1[12]\n")
            self.assertIn(f" {get}+0x", (self.folder / "t.txt").read_text())
            self.assertNotIn("_Z", said + file.read_text() + (self.folder / "p.folded").read_text())
            self.do("lcov", "--summary", file)
            self.do("genhtml", "-q", "-o", self.folder / "html", file)
            # A name is chosen as it is shown, or as the linker knows it.
            for chosen in (get, next(mangled for mangled, name in names.items() if name == get)):
                self.do(
                    CAPSOC,
                    "run",
                    elf,
                    "-C",
                    f"trace.start={chosen}",
                    "--trace-instructions",
                    self.folder / "t.txt",
                    code=5,
                )
                self.assertIn(get, (self.folder / "t.txt").read_text().splitlines()[1])

    def test_an_object_that_a_register_points_at(self):
        self.write(
            "main.cpp",
            "namespace a { struct S { int words[4]; }; volatile S thing; }\n"
            'extern "C" int f(volatile a::S* s) { return *(volatile int*)0x60000000 + s->words[1]; }\n'
            'extern "C" int main() { return f(&a::thing); }\n',
        )
        self.do(*GCC, "-O0", "-x", "c++", "-g", "-c", "main.cpp", "-o", "1.o")
        self.assertIn("a::thing", self.do(CAPSOC, "run", self.link("app.elf", self.folder / "1.o"), code=5))


if __name__ == "__main__":
    unittest.main()
