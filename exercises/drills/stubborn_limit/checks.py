"""What has to work in the drill stubborn_limit."""

from course_kit.grading.checks.vocabulary import (
    check,
    draw_between,
    endpoints_offered,
    parameter_declared,
    topic_answers,
)


@check(points=1.0, after=["declared", "limit"], proves=["change"])
def change(node):
    """A change of max_speed acts on the next message."""
    for limit, before in ((0.5, [1.0, 0.25]), (2.0, [0.5, 0.25])):
        node.set(max_speed=limit).accepted()
        node.wait(0.2)  # rclpy may tell the callbacks of a change after it has answered
        got = [node.send("/speed_in", speed).expect("/speed").data for speed in (3.0, 0.25)]
        code, why = "math.formula", ""
        if got == before:
            code, why = (
                "parameter.read_once",
                "Your node accepted the change, but what comes out is the same as before.",
            )
        for speed in (3.0, 0.25):
            node.send("/speed_in", speed).expect("/speed", min(speed, limit), why=why, diagnosis=code)


CHECKS = [
    endpoints_offered(title="Both topics are there", points=1.0, proves=["topics"]),
    parameter_declared(
        {"max_speed": 1.0},
        node="/speed_limiter",
        check_id="declared",
        title="max_speed is 1.0 at the start",
        points=1.0,
        after=["offered"],
        proves=["parameter"],
    ),
    topic_answers(
        "/speed_in",
        "/speed",
        [draw_between(-3.0, -0.6), draw_between(0.1, 0.9), draw_between(1.1, 3.0), draw_between(1.1, 3.0)],
        lambda speed: min(speed.data, 1.0),
        check_id="limit",
        title="Speeds above max_speed become max_speed",
        points=1.0,
        after=["offered"],
        proves=["limit"],
    ),
    change,
]
