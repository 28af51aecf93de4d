"""What has to work in the drill good_but_aborted."""

from course_kit.grading.checks.vocabulary import endpoints_offered, goal_feedback, goal_succeeds

CHECKS = [
    endpoints_offered(title="The action /bake is there", points=1.0, proves=["action"]),
    goal_succeeds(
        "/bake",
        [{"order": 2}, {"order": 5}],
        lambda goal: {"sequence": list(range(goal.order))},
        check_id="loaves",
        title="A goal ends SUCCEEDED, with all loaves",
        points=1.0,
        after=["offered"],
        proves=["loaves"],
        not_before_s=0.19,
    ),
    goal_feedback(
        "/bake",
        [{"order": 4}],
        check_id="feedback",
        title="Each loaf is published while the goal runs",
        points=1.0,
        after=["loaves"],
        proves=["feedback"],
        at_least=4,
        first=lambda _: {"sequence": [0]},
        last=lambda _: {"sequence": [0, 1, 2, 3]},
    ),
]
