"""What has to work in the drill dark_lamp."""

from course_kit.grading.checks.vocabulary import draw_between, endpoints_offered, topic_answers

CHECKS = [
    endpoints_offered(check_id="connects", title="The lamp hears the slider", points=1.0, proves=["topics"]),
    topic_answers(
        "/brightness",
        "/lamp",
        [0.5, 0.500001, draw_between(0.0, 0.499), 1.0],
        lambda brightness: brightness.data > 0.5,
        check_id="switches",
        title="The lamp is on above 0.5",
        points=1.0,
        after=["connects"],
        proves=["threshold"],
    ),
]
