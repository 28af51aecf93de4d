"""What has to work in the drill deaf_to_cancel."""

from course_kit.grading.checks.vocabulary import check, endpoints_offered


@check(points=1.0, after=["offered"], proves=["counts"], afresh=True)
def counts(node):
    """A goal counts down and succeeds."""
    for order in (3, 5):
        goal = node.goal("/count_down", order=order).accepted_by()
        goal.ends(not_before_s=0.55, sequence=list(range(order, 0, -1)))


@check(points=1.0, after=["counts"], proves=["in_steps"], afresh=True)
def feedback(node):
    """Each number is told while the goal runs."""
    goal = node.goal("/count_down", order=4).accepted_by()
    goal.ends()
    goal.expect_feedback(4, first={"sequence": [4]}, last={"sequence": [4, 3, 2, 1]})


@check(points=1.0, after=["counts"], proves=["cancel"], deadline_s=30.0, afresh=True)
def cancel(node):
    """A running goal can be cancelled."""
    for order in (20, 15):
        goal = node.goal("/count_down", order=order).accepted_by()
        node.wait(0.3)
        goal.cancelled().ends("CANCELED")
    node.goal("/count_down", order=2).accepted_by().ends()


CHECKS = [
    endpoints_offered(title="The action /count_down is there", points=1.0, proves=["action"]),
    counts,
    feedback,
    cancel,
]
