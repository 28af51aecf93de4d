"""The grader process: joins the graph, runs the checks of one exercise, reports each as it is known."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from course_kit.grading.checks.check import choose_part, run_all
from course_kit.grading.checks.context import CheckContext
from course_kit.grading.errors import GradingError
from course_kit.grading.model import bounds, limits
from course_kit.grading.sandbox import machine
from course_kit.grading.sandbox.channel import ChannelClosedError
from course_kit.grading.workers import grader_module
from course_kit.process.libc import set_name

if TYPE_CHECKING:
    from mmap import mmap

    from course_kit.grading.model.job import Job
    from course_kit.grading.sandbox.channel import Channel


def warm_up() -> None:
    """Import what every grading needs. Must not initialise ROS: a context does not survive a fork."""
    import rclpy.action
    import rclpy.executors
    import rclpy.node
    from rcl_interfaces import srv as parameter_services
    from rcl_interfaces.msg import ParameterEvent
    from rclpy.type_support import check_for_type_support
    from type_description_interfaces.srv import GetTypeDescription

    import course_kit.grading.checks.grader_node
    import course_kit.grading.checks.vocabulary

    machine.processor_share()
    for of_every_node in (
        GetTypeDescription,
        ParameterEvent,
        parameter_services.DescribeParameters,
        parameter_services.GetParameters,
        parameter_services.GetParameterTypes,
        parameter_services.ListParameters,
        parameter_services.SetParameters,
        parameter_services.SetParametersAtomically,
    ):
        check_for_type_support(of_every_node)  # else each submission loads it when its node is made
    del rclpy, course_kit


def main(supervisor: Channel, job: Job, lives: mmap) -> None:
    """Run all checks of the job's exercise; returns when each is reported, or why they could not be run."""
    set_name("grade grader")
    os.setpriority(os.PRIO_PROCESS, 0, job.priority)
    limits.bound_reader(job.limits.wall_s)
    problem = ""
    try:
        _run(supervisor, job, lives)
    except ChannelClosedError:
        return
    except GradingError as fault:
        problem = str(fault)
    except Exception as fault:  # noqa: BLE001 - a broken grader or installation; the report says so
        problem = f"{type(fault).__name__}: {fault}"
    supervisor.send({"do": "done", "problem": bounds.cut_text(problem)})


def _run(supervisor: Channel, job: Job, lives: mmap) -> None:
    grader = grader_module.load_for(job)
    context = CheckContext(supervisor, job, getattr(grader, "VARIABLES", {}), lives)
    checks = grader_module.checks_of(grader, job)
    if job.only:
        checks = choose_part(checks, job.only)
    if not (job.fault or job.variable or job.files):
        context.launch()
    try:
        for result in run_all(checks, context):
            supervisor.send({"do": "result", "result": result})
            if job.first_failure and result.status == "failed" and result.max_points:
                break
    finally:
        if not job.isolation.network:  # our own graph ends with us, at once; others wait for those who do not leave
            context.close()
