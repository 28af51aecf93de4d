"""What has to work in the drill good_but_aborted."""

from course_kit.grading.checks.vocabulary import check, endpoints_offered


@check(points=1.0, after=["offered"], proves=["loaves"], afresh=True)
def loaves(node):
    """A goal ends SUCCEEDED, with all loaves."""
    for order in (2, 5):
        goal = node.goal("/bake", order=order).accepted_by()
        goal.ends(not_before_s=0.19, sequence=list(range(order)))


@check(points=1.0, after=["loaves"], proves=["feedback"], afresh=True)
def feedback(node):
    """Each loaf is told while the goal runs."""
    goal = node.goal("/bake", order=4).accepted_by()
    goal.ends()
    goal.expect_feedback(4, first={"sequence": [0]}, last={"sequence": [0, 1, 2, 3]})


CHECKS = [
    endpoints_offered(title="The action /bake is there", points=1.0, proves=["action"]),
    loaves,
    feedback,
]
