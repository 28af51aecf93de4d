"""What has to work in the drill two_at_once."""

from course_kit.grading.checks.vocabulary import endpoints_offered, goal_refused, goal_succeeds

CHECKS = [
    endpoints_offered(title="The action /paint is there", points=1.0, proves=["action"]),
    goal_succeeds(
        "/paint",
        [{"order": 2}, {"order": 3}],
        lambda goal: {"sequence": list(range(goal.order))},
        check_id="strokes",
        title="One goal after the other is painted",
        points=1.0,
        after=["offered"],
        proves=["strokes", "next"],
        not_before_s=0.9,
    ),
    goal_refused(
        "/paint",
        [{"order": 2}],
        check_id="one_arm",
        title="A second goal, sent at once, is rejected",
        points=1.0,
        after=["offered"],
        proves=["one_arm"],
        while_running={"order": 5},
    ),
]
