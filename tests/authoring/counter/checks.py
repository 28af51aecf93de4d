from course_kit.grading.checks.vocabulary import (
    CheckPart,
    Model,
    conversation,
    draw_one_of,
    endpoints_offered,
    parameter_declared,
    step_rule,
)


class Counting(Model):
    number, step = 0, 1

    @step_rule("count", often=10, when=lambda model: model.number + model.step <= 30)
    def count(self, node):
        self.number += self.step
        node.call("/count").expect(success=True, message=str(self.number))

    @step_rule("count", often=3, when=lambda model: model.number + model.step > 30)
    def count_when_full(self, node):
        node.call("/count").refused(what="a count that would go above 30")

    @step_rule("step", step=draw_one_of(1, 2, 7, 10, 0, 11, -3))
    def change(self, node, step):
        change = node.set(step=step)
        if 1 <= step <= 10:
            change.accepted()
            self.step = step
        else:
            change.refused()

    @step_rule("reset", when=lambda model: model.number > 0)
    def reset(self, node):
        node.call("/reset_count").expect(success=True)
        self.number = 0

    @step_rule("reset", often=2, when=lambda model: model.number == 0)
    def reset_at_zero(self, node):
        node.call("/reset_count").refused(what="a reset at 0")


CHECKS = [
    endpoints_offered(points=0.5, proves=["ends"]),
    parameter_declared(
        {"step": 1},
        node="/counter",
        check_id="declared",
        title="step is 1 at the start",
        points=0.5,
        after=["offered"],
        proves=["step"],
    ),
    *conversation(
        Counting,
        CheckPart("count", "It counts, and is full at 30", points=2.0, proves=["counts", "full", "reset"]),
        CheckPart("step", "The step is from 1 to 10", points=1.5, proves=["valid_steps"]),
        CheckPart("reset", "A reset works, and is refused at 0", points=1.5, proves=["reset", "reset_refused"]),
        steps=80,
        after=["declared"],
    ),
]
