"""Packages that have not been built: what lies in their source is found as if it were installed."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import sysconfig
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.launch import package_index

if TYPE_CHECKING:
    from collections.abc import Callable

    import pytest

    Run = Callable[..., str]

PAGE = Path(__file__).resolve().parents[2] / "notebooks/own_package.md"
SETUP = """
import os
from glob import glob
package_name = 'arm'
setup(name=package_name, data_files=[
    ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
    (os.path.join('share', package_name), glob('urdf/*')),
    (f'share/{package_name}/files', ['data/one.txt'] + glob(os.path.join('data', 'two*'))),
    ('share/' + package_name + '/never', what_nobody_knows()),
    ('/etc', ['data/one.txt']),
])
data_files.append(('share/' + package_name + '/more', ['data/one.txt']))
"""


def make_package(folder: Path, name: str) -> Path:
    package = folder / name
    for inner in ("launch", "config", "urdf", "data", name):
        (package / inner).mkdir(parents=True)
    (package / "package.xml").write_text(f"<package><name>{name}</name></package>")
    (package / "setup.py").write_text(SETUP)
    (package / "config" / "arm.yaml").write_text("{}")
    for file in ("urdf/arm.urdf", "data/one.txt", "data/two.txt"):
        (package / file).write_text(file)
    return package


def test_what_a_setup_py_installs_is_read(tmp_path: Path) -> None:
    package = make_package(tmp_path, "arm")
    assert sorted(package_index.installed_files(package)) == [
        (PurePosixPath("share/arm"), package / "urdf" / "arm.urdf"),
        (PurePosixPath("share/arm/files"), package / "data" / "one.txt"),
        (PurePosixPath("share/arm/files"), package / "data" / "two.txt"),
        (PurePosixPath("share/arm/more"), package / "data" / "one.txt"),
    ]
    (package / "setup.py").write_text("setup(data_files=[")
    assert list(package_index.installed_files(package)) == []


def test_a_package_of_the_workspace_is_found_with_all_that_it_shares(
    run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = folder / "ws" / "src"
    make_package(source / "robots", "arm")
    (make_package(source, "bringup") / "launch" / "tell.py").write_text((folder / "tell.py").read_text())
    (source / "robots" / "arm" / "scripts").mkdir()
    (source / "robots" / "arm" / "scripts" / "wave.py").write_text("print('waving')")
    monkeypatch.chdir("/")
    done = run(
        "say(FindPackageShare('arm')), say('found ', FindPackageShare('x').find('arm')),"
        "say(Command(['cat ', PathJoinSubstitution([FindPackageShare('arm'), 'arm.urdf'])])),"
        "say(Command(['cat ', FindPackageShare('arm'), '/files/two.txt'])),"
        "Node(package='arm', executable='wave.py', output='screen'),"
        "ExecuteProcess(cmd=[ExecutableInPackage(package='arm', executable='wave.py'), 'x'], output='both'),"
        "ExecuteProcess(cmd=[ExecutableInPackage(package='no', executable='no')]),"
        "ExecuteProcess(cmd=['python3', '-c', 'from ament_index_python.packages import *; "
        "print(get_package_share_directory(\"arm\"))'], output='screen')",
        file="ws/src/bringup/launch/it.launch.py",
    )
    share = Path(re.findall(r"launch.user\]: (.*share/arm)\n", done)[0])
    assert (share / "config" / "arm.yaml").resolve() == source / "robots" / "arm" / "config" / "arm.yaml"
    assert f"]: found {share}\n" in done
    assert "urdf/arm.urdf" in done
    assert "data/two.txt" in done
    assert "[wave.py-1] waving" in done
    assert "[wave.py-2] waving" in done
    assert re.search(rf"^\[python[\d.]*-3\] {re.escape(str(share))}$", done, re.MULTILINE)
    assert "[ERROR] [launch]: it.launch.py, line " in done
    assert done.endswith("ended with 1")


def test_packages_are_found_as_deep_as_in_a_repository_that_was_cloned_into_src(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "src"
    deep = make_package(source / "examples" / "rclpy" / "topics", "talking")
    for unsought in (deep / "inner", source / "build" / "copied", source / ".git" / "hidden", source / "off" / "out"):
        unsought.mkdir(parents=True)
        (unsought / "package.xml").write_text("<package/>")
    (source / "off" / "COLCON_IGNORE").touch()
    monkeypatch.chdir(tmp_path)
    assert package_index.sources_near([]) == {"talking": deep}
    assert package_index.sources_near([deep / "launch"])["talking"] == deep


def test_a_compiled_program_of_a_package_is_named_as_one(run: Run, folder: Path) -> None:
    make_package(folder, "arm")
    done = run("Node(package='arm', executable='driver')", file="arm/launch/it.launch.py")
    assert f"Package 'arm' has no Python program 'driver' in {folder / 'arm'}. A compiled one needs a full" in done


def test_the_page_about_a_package_of_ones_own_does_what_it_says(folder: Path) -> None:
    """Its files are written and its commands are run; pip installs into a folder of the test, without the network."""
    page = PAGE.read_text()
    for name, text in re.findall(r"^`([\w./]+)`[^\n]*\n```\w+\n(.*?)```$", page, flags=re.MULTILINE | re.DOTALL):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    commands = re.findall(r"^```sh\n(.*?)```$", page, flags=re.MULTILINE | re.DOTALL)
    script = "".join(commands).replace("ros2 pkg executables", "rm -r my_pkg\nros2 pkg executables")
    done = subprocess.run(
        ["bash", "-ec", script],
        cwd=folder,
        env=installing_into(folder / "installed"),
        capture_output=True,
        text=True,
        timeout=500,  # against hanging only
        check=False,
    )
    assert done.returncode == 0, done.stderr
    said = done.stdout + done.stderr
    assert "int32 times 3\n" in said
    assert "hello you, 3 times" in said
    assert said.count("hello world, 3 times") == 2
    assert "my_pkg greeter\n" in said


def installing_into(prefix: Path) -> dict[str, str]:
    """An environment in which pip installs into a folder, and Python and ROS find what is there."""
    packages = sysconfig.get_path("purelib", vars={"base": str(prefix), "platbase": str(prefix)})
    return environment.child_environment(
        PIP_PREFIX=str(prefix),
        PIP_NO_BUILD_ISOLATION="0",
        PIP_NO_DEPS="1",
        PIP_DISABLE_PIP_VERSION_CHECK="1",
        PYTHONPATH=packages,
        AMENT_PREFIX_PATH=str(prefix),
        ROS_DOMAIN_ID=os.environ["ROS_DOMAIN_ID"],
    )


def test_a_program_imports_from_another_python_package_of_its_workspace(run: Run, folder: Path) -> None:
    """As in a workspace that colcon has built and somebody has sourced, by `ros2 launch` and `ros2 run` alike."""
    for name, text in (("shape_tools", "def square(side): return side * side"), ("shape_node", "")):
        package = make_package(folder / "src", name)
        (package / name).mkdir(exist_ok=True)
        (package / name / "__init__.py").touch()
        (package / name / "areas.py").write_text(text)
        (package / "setup.py").write_text(f"setup(entry_points={{'console_scripts': ['area = {name}.area:main']}})")
    program = "from shape_tools.areas import square\ndef main(): print('area', square(3))\n"
    (folder / "src" / "shape_node" / "shape_node" / "area.py").write_text(program)
    assert "area 9\n" in run("Node(package='shape_node', executable='area', output='screen')")
    command = [sys.executable, "-m", "course_kit.ros2cli", "run", "shape_node", "area"]
    done = subprocess.run(command, env=environment.child_environment(), capture_output=True, text=True, check=True)
    assert done.stdout == "area 9\n"
