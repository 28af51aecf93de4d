"""Builds an interface package for real: ROS 2's own generators, then g++. The reference live types are held against.

This is what a colcon build does, with the generators and templates that come with the wheels. Learners never need it.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

PREFIX = Path(sys.prefix)
# Packages the test's own definitions refer to, directly or not.
DEPENDENCIES = (
    "action_msgs",
    "builtin_interfaces",
    "geometry_msgs",
    "service_msgs",
    "std_msgs",
    "unique_identifier_msgs",
)
GENERATORS = (
    "rosidl_generator_c",
    "rosidl_typesupport_c",
    "rosidl_typesupport_fastrtps_c",
    "rosidl_typesupport_introspection_c",
)


def missing() -> str | None:
    """What this machine lacks for a build, None if nothing."""
    if not shutil.which("g++"):
        return "g++"
    if not Path(sysconfig.get_paths()["include"], "Python.h").is_file():
        return "Python.h"
    if not all((PREFIX / "share" / name / "resource").is_dir() for name in GENERATORS):
        return "the generators of the ROS wheels"
    return None


class Build:
    """One package, from its texts to an importable Python package.

    Args:
        package: its name.
        texts: folder with msg, srv and action folders.
        target: folder to build in; `python_path` and `library_path` lie below it.
    """

    def __init__(self, package: str, texts: Path, target: Path) -> None:
        self.package, self.texts = package, texts
        self.python_path, self.library_path = target / "python", target / "lib"
        self._work = target / "work"
        self._generated, self._introspection = self._work / "c" / package, self._work / "introspection" / package
        self._python = self.python_path / package
        for folder in (self._work, self.library_path, self._generated, self._introspection, self._python):
            folder.mkdir(parents=True, exist_ok=True)
        self._files = sorted(path.relative_to(texts) for path in texts.glob("*/*.*"))

    def run(self) -> None:
        self._generate()
        self._compile()

    def _generate(self) -> None:
        import rosidl_generator_c
        import rosidl_typesupport_c
        import rosidl_typesupport_fastrtps_c
        import rosidl_typesupport_introspection_c
        from rosidl_adapter import convert_to_idl
        from rosidl_generator_py.generate_py_impl import generate_py
        from rosidl_generator_type_description import generate_type_hash

        for file in self._files:
            convert_to_idl(self.texts, self.package, file, self._work / "idl" / self.package)
        described = self._work / "descriptions"
        shares = [share for share in (PREFIX / "share").iterdir() if (share / "msg").exists()]
        included = [f"{share.name}:{share}" for share in shares]
        generate_type_hash(self._arguments("rosidl_generator_type_description", described, include_paths=included))
        tuples = [f"{file.with_suffix('.idl')}:{described / file.with_suffix('.json')}" for file in self._files]
        c_arguments = self._arguments("rosidl_generator_c", self._generated, type_description_tuples=tuples)
        rosidl_generator_c.generate_c(c_arguments)
        fastrtps = self._arguments("rosidl_typesupport_fastrtps_c", self._generated)
        rosidl_typesupport_fastrtps_c.generate_typesupport_fastrtps_c(fastrtps)
        supports = ["rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c"]
        rosidl_typesupport_c.generate_c(self._arguments("rosidl_typesupport_c", self._generated), supports)
        introspection = self._arguments("rosidl_typesupport_introspection_c", self._introspection)
        rosidl_typesupport_introspection_c.generate_c(introspection)
        generate_py(self._arguments("rosidl_generator_py", self._python), ["rosidl_typesupport_c"])
        (self._python / "__init__.py").touch()
        self._visibility_headers()

    def _arguments(self, generator: str, output: Path, **more: Any) -> str:
        """The arguments file a generator is called with, as its CMake code would write it."""
        idl = self._work / "idl" / self.package
        arguments = {
            "package_name": self.package,
            "output_dir": str(output),
            "template_dir": str(PREFIX / "share" / generator / "resource"),
            "idl_tuples": [f"{idl}:{file.with_suffix('.idl')}" for file in self._files],
            "target_dependencies": [],
            "ros_interface_files": [str(self.texts / file) for file in self._files],
            **more,
        }
        path = self._work / f"{generator}.json"
        path.write_text(json.dumps(arguments))
        return str(path)

    def _visibility_headers(self) -> None:
        folder = self._generated / "msg"
        folder.mkdir(exist_ok=True)
        for generator in GENERATORS:
            template = PREFIX / "share" / generator / "resource" / f"{generator}__visibility_control.h.in"
            if template.exists():
                text = template.read_text().replace("@PROJECT_NAME_UPPER@", self.package.upper())
                header = folder / f"{generator}__visibility_control.h"
                header.write_text(text.replace("@PROJECT_NAME@", self.package))

    def _compile(self) -> None:
        c = [*self._generated.rglob("*.c"), *self._introspection.rglob("*.c"), *self._python.rglob("_*_s.c")]
        cpp = [*self._generated.rglob("*_c.cpp"), *self._generated.rglob("*__type_support.cpp")]
        entry = next(self._python.glob("_*.ep.rosidl_typesupport_c.c"))
        sources = sorted({*c, *cpp} - {entry})
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            objects = list(pool.map(self._object, sources))
        # All layers in one library: the split into several is for installed packages.
        library = self.library_path / f"lib{self.package}.so"
        needed = [f"-l{name}__{layer}" for name in DEPENDENCIES for layer in self._layers(name)]
        runtime = ["rosidl_runtime_c", "rcutils", "fastcdr", *(name for name in GENERATORS if self._is_library(name))]
        link = [*needed, *(f"-l{name}" for name in runtime)]
        self._call("g++", "-shared", "-o", str(library), *objects, *self._link_flags(), *link)
        for layer in GENERATORS[2:]:  # looked up by these names when a type is first used
            name = self.library_path / f"lib{self.package}__{layer}.so"
            name.unlink(missing_ok=True)
            name.symlink_to(library)
        module = self._python / f"{self.package}_s__rosidl_typesupport_c.so"
        entry_object = self._object(entry)
        self._call("g++", "-shared", "-o", str(module), entry_object, *self._link_flags(), f"-l{self.package}")

    def _object(self, source: Path) -> str:
        target = self._work / f"{source.parent.name}_{source.name}.o"
        if source.is_relative_to(self._introspection):
            target = target.with_name(f"introspection_{target.name}")
        compiler = "g++" if source.suffix == ".cpp" else "gcc"
        # Not optimised: it is compiled once, and used a few times.
        self._call(compiler, "-O0", "-DNDEBUG", "-fPIC", "-c", "-o", str(target), str(source), *self._include_flags())
        return str(target)

    def _include_flags(self) -> list[str]:
        folders = [self._work / "c", self._work / "introspection", PREFIX / "include"]
        folders += [folder for folder in (PREFIX / "include").iterdir() if folder.is_dir()]
        return [f"-I{folder}" for folder in (*folders, sysconfig.get_paths()["include"], np.get_include())]

    def _link_flags(self) -> list[str]:
        folders = (self.library_path, PREFIX / "lib")
        return [*(f"-L{folder}" for folder in folders), "-Wl,--allow-shlib-undefined", "-Wl,--no-as-needed"]

    def _layers(self, package: str) -> list[str]:
        layers = ("rosidl_generator_c", "rosidl_generator_py", *GENERATORS[1:])
        return [layer for layer in layers if self._is_library(f"{package}__{layer}")]

    def _is_library(self, name: str) -> bool:
        return (PREFIX / "lib" / f"lib{name}.so").exists()

    def _call(self, *command: str) -> None:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=100)
        assert done.returncode == 0, done.stderr[-4000:]
