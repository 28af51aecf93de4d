"""What has to work in the drill empty_dashboard."""

from course_kit.grading.checks.vocabulary import draw_between, endpoints_offered, topic_answers

CHECKS = [
    endpoints_offered(
        check_id="connects", title="A default subscription connects to /voltage", points=1.0, proves=["connects"]
    ),
    topic_answers(
        "/millivolts",
        "/voltage",
        [draw_between(9000, 12600)] * 4,
        lambda millivolts: millivolts.data / 1000,
        check_id="volts",
        title="Each message on /millivolts becomes one on /voltage",
        points=1.0,
        after=["connects"],
        proves=["volts"],
    ),
]
