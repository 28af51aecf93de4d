"""What has to work in the drill stuck_call."""

from course_kit.grading.checks.vocabulary import draw_between, endpoints_offered, service_answers

NUMBERS = {"a": draw_between(-99, 99), "b": draw_between(-99, 99)}

CHECKS = [
    endpoints_offered("/add", title="Both services are there", points=1.0, proves=["services"]),
    service_answers(
        "/add",
        [NUMBERS] * 3,
        lambda request: {"sum": request.a + request.b},
        check_id="sum",
        title="/add answers with the sum",
        points=1.0,
        after=["offered"],
        proves=["sum"],
    ),
    service_answers(
        "/add_doubled",
        [NUMBERS] * 3,
        lambda request: {"sum": 2 * (request.a + request.b)},
        check_id="doubled",
        title="/add_doubled answers with twice the sum",
        points=1.0,
        after=["offered"],
        proves=["services", "doubled"],
        within_s=1.0,
    ),
]
