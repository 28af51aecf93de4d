"""What has to work in the drill long_queue."""

from course_kit.grading.checks.vocabulary import draw_between, endpoints_offered, service_answers

WEIGHTS = {"a": draw_between(1, 99), "b": draw_between(1, 99)}

CHECKS = [
    endpoints_offered(title="The service /weigh is there", points=1.0, proves=["service"]),
    service_answers(
        "/weigh",
        [WEIGHTS] * 2,
        lambda request: {"sum": request.a + request.b},
        check_id="weight",
        title="/weigh answers with the sum, once the scale is steady",
        points=1.0,
        after=["offered"],
        proves=["weight", "steady"],
        not_before_s=0.4,
        within_s=1.2,
    ),
    service_answers(
        "/weigh",
        [WEIGHTS] * 8,
        lambda request: {"sum": request.a + request.b},
        check_id="together",
        title="Eight clients are served together",
        points=1.0,
        after=["weight"],
        proves=["together"],
        at_a_time=8,
        within_s=3.0,
    ),
]
