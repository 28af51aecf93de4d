"""What has to work in the drill stubborn_limit."""

from course_kit.grading.checks.vocabulary import (
    draw_between,
    endpoints_offered,
    parameter_acts,
    parameter_declared,
    topic_answers,
)

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
    parameter_acts(
        [{"max_speed": 0.5}, {"max_speed": 2.0}],
        "/speed_in",
        "/speed",
        [3.0, 0.25],
        lambda speed, setting: min(speed.data, setting["max_speed"]),
        check_id="change",
        title="A change of max_speed acts on the next message",
        points=1.0,
        after=["declared", "limit"],
        proves=["change"],
    ),
]
