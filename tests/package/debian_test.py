#!/usr/bin/env python3
"""The Debian packages: made by cpack, unpacked into a folder, and used from there."""

import gzip
import re
import tempfile
import unittest
from pathlib import Path

from harness import BUILD, SOURCE, output_of

CTEST = {"name": "package: debian", "whole": True, "timeout": 900}

PACKAGES = ("capsoc", "libcapsoc-dev", "python3-capsoc")
COMPONENTS = "base kit bus armv7m cmsdk an385 peripherals coprocessor sensor identification soc"
PROJECT = f"""
cmake_minimum_required(VERSION 3.16)
project(user LANGUAGES CXX)
find_package(capsoc 0.1 REQUIRED COMPONENTS {COMPONENTS})
foreach(component {COMPONENTS.replace("base ", "")})
  get_target_property(links capsoc::${{component}} INTERFACE_LINK_LIBRARIES)
  list(FILTER links INCLUDE REGEX "libcapsoc_.*\\\\.a$")
  foreach(archive ${{links}})
    if(NOT EXISTS "${{archive}}")
      message(FATAL_ERROR "${{archive}} is missing")
    endif()
  endforeach()
endforeach()
add_executable(user main.cpp)
target_link_libraries(user PRIVATE capsoc::base)
"""
MAIN = """
#include <cstdio>

#include "base/random.h"

int main() {
  std::printf("%.3f\\n", capsoc::RandomSequence(1, 2).uniform(3));
  return 0;
}
"""


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.top = Path(folder.name).resolve()
        # Compressed quickly: it is only unpacked again.
        settings = ["-D", "CPACK_DEBIAN_COMPRESSION_TYPE=zstd", "-D", "CPACK_STRIP_FILES=OFF"]
        output_of("cpack", "--config", BUILD / "CPackConfig.cmake", "-G", "DEB", "-B", cls.top / "made", *settings)
        cls.files = {path.name.split("_")[0]: path for path in (cls.top / "made").glob("*.deb")}
        cls.root = cls.top / "root"
        for file in cls.files.values():
            output_of("dpkg-deb", "-x", file, cls.root)
        cls.share = cls.root / "usr/share"

    def field(self, package, name):
        return output_of("dpkg-deb", "--field", self.files[package], name).strip()

    def test_there_are_three_which_need_what_they_use(self):
        self.assertEqual(sorted(self.files), sorted(PACKAGES))
        version = self.field("capsoc", "Version")
        self.assertRegex(self.field("capsoc", "Depends"), r"libc6 \(>= [\d.]+\).*libsystemc")
        self.assertNotRegex(self.field("capsoc", "Depends"), "-dev|python")
        needs = self.field("libcapsoc-dev", "Depends").split(", ")
        self.assertEqual(needs[0], f"capsoc (= {version})")
        self.assertLessEqual({"libsystemc-dev", "libspdlog-dev", "libeigen3-dev", "zlib1g-dev"}, set(needs))
        self.assertIn(f"capsoc (= {version})", self.field("python3-capsoc", "Depends"))
        self.assertEqual(self.field("python3-capsoc", "Architecture"), "all")
        self.assertEqual(self.field("libcapsoc-dev", "Section"), "libdevel")

    def test_no_file_is_in_two_and_none_outside_usr(self):
        seen = {}
        for package, file in self.files.items():
            for line in output_of("dpkg-deb", "--contents", file).splitlines():
                name = line.split(maxsplit=5)[5]
                self.assertRegex(name, r"^\./(usr/.*)?$")
                if not name.endswith("/"):
                    self.assertNotIn(name, seen)
                    seen[name] = package
        self.assertEqual(seen["./usr/lib/python3/dist-packages/capsoc/__init__.py"], "python3-capsoc")
        self.assertEqual(seen["./usr/include/capsoc/kit/protocol_monitor.h"], "libcapsoc-dev")
        self.assertEqual(seen["./usr/bin/capsoc"], "capsoc")

    def test_each_has_licences_and_changes(self):
        for package in PACKAGES:
            documents = self.share / "doc" / package
            notices = (documents / "copyright").read_text(encoding="utf-8")
            for name in ("Apache-2.0", "spdlog", "Eigen", "elfutils"):
                self.assertIn(name, notices, package)
            changes = gzip.decompress((documents / "changelog.gz").read_bytes()).decode()
            self.assertEqual(changes, (SOURCE / "CHANGELOG.md").read_text(encoding="utf-8"))

    def test_the_program_runs(self):
        said = output_of(self.root / "usr/bin/capsoc", "run", self.share / "capsoc/firmware/hello.elf")
        self.assertEqual(said, "hello from capsoc\n")
        self.assertTrue((self.share / "man/man1/capsoc-run.1.gz").exists())

    def test_a_project_finds_the_models(self):
        source = self.top / "user"
        source.mkdir()
        (source / "CMakeLists.txt").write_text(PROJECT, encoding="utf-8")
        (source / "main.cpp").write_text(MAIN, encoding="utf-8")
        output_of("cmake", "-S", source, "-B", source / "build", f"-DCMAKE_PREFIX_PATH={self.root}/usr")
        output_of("cmake", "--build", source / "build")
        self.assertTrue(re.fullmatch(r"0\.\d{3}", output_of(source / "build/user").strip()))

    def test_python_finds_the_package_and_pytest_its_plugin(self):
        environment = {"PYTHONPATH": str(self.root / "usr/lib/python3/dist-packages"), "PYTHONDONTWRITEBYTECODE": "1"}
        program = (
            "import capsoc, importlib.metadata as m\n"
            "print(capsoc.find_program(), m.version('capsoc'))\n"
            "print(*(e.value for e in m.entry_points(group='pytest11') if e.name == 'capsoc'))"
        )
        said = output_of("/usr/bin/python3", "-c", program, environment=environment).split()
        self.assertEqual(said, [f"{self.root}/usr/bin/capsoc", self.field("capsoc", "Version"), "capsoc.pytest_plugin"])


if __name__ == "__main__":
    unittest.main()
