"""`ros2 interface show` of example_interfaces has the lines that a full ROS 2 shows, as a tutorial prints them."""

from __future__ import annotations

from course_kit import interfaces

# What each line is, as in the texts of ROS 2: "#" a comment, "_" empty, "C" a field with a comment, "c" one without
SHAPES = {
    "#c-#c-#c": ["Fibonacci"],
    "####c": ["Bool", "Byte", "Char", "String", "WString", "Float32", "Float64"]
    + [f"{sign}nt{bits}" for sign in ("I", "UI") for bits in (8, 16, 32, 64)],
    "###_##_CC": [f"{name}MultiArray" for name in ("Byte", "Float32", "Float64")]
    + [f"{sign}nt{bits}MultiArray" for sign in ("I", "UI") for bits in (8, 16, 32, 64)],
    "##": ["Empty"],
    "###_CCC": ["MultiArrayDimension"],
    "###_#######################_CC": ["MultiArrayLayout"],
    "cc-c": ["AddTwoInts"],
    "###_C-CC": ["SetBool"],
    "###_-CC": ["Trigger"],
}


def shape(text: str) -> str:
    return "".join(map(kind, text.splitlines()))


def kind(line: str) -> str:
    if line in {"", "---"}:
        return "-" if line else "_"
    return "#" if line.startswith("#") else "C" if "#" in line else "c"


def test_each_text_has_the_lines_of_the_real_one() -> None:
    found = {
        name.rpartition("/")[2]: shape(interfaces.text_of(name)) for name in interfaces.types("example_interfaces")
    }
    assert found == {name: wanted for wanted, names in SHAPES.items() for name in names}
