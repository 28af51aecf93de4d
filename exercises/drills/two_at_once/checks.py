"""What has to work in the drill two_at_once."""

from course_kit.grading.checks.vocabulary import check, endpoints_offered


@check(points=1.0, after=["offered"], proves=["strokes", "next"], afresh=True)
def strokes(node):
    """One goal after the other is painted."""
    for order, code in ((2, "action.rejects_all"), (3, "validation.overzealous")):
        goal = node.goal("/paint", order=order).accepted_by(diagnosis=code)
        goal.ends(not_before_s=0.9, sequence=list(range(order)))


@check(points=1.0, after=["offered"], proves=["one_arm"], afresh=True)
def one_arm(node):
    """A second goal, sent at once, is rejected."""
    first = node.goal("/paint", order=5).accepted_by()
    second = node.goal("/paint", order=2)
    second.rejected(what="a second goal while the first was running", diagnosis="action.concurrent_goals")
    first.ends()


CHECKS = [
    endpoints_offered(title="The action /paint is there", points=1.0, proves=["action"]),
    strokes,
    one_arm,
]
