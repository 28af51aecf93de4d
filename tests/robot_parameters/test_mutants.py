"""Each check can fail: take away what it looks at, and it turns red, and no other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.graders import robot_parameters
from tests.robot_parameters.mutants import MUTANTS
from tests.robot_parameters.test_broken import BROKEN

if TYPE_CHECKING:
    from tests.robot_parameters.conftest import Mutant, Reports


@pytest.mark.parametrize("program", MUTANTS, ids=lambda mutant: mutant.name)
def test_mutant_fails_where_it_is_wrong(program: Mutant, reports: Reports) -> None:
    report = reports.of(program)
    failed = [check for check in report.checks if check.status in ("failed", "error")]
    assert {(check.id, check.diagnosis) for check in failed} == program.failed
    assert program.says in " ".join(check.message for check in failed)
    for check in failed:
        assert check.expected
        assert check.hint


def test_each_check_can_fail(reports: Reports) -> None:
    seen = {
        check.id for program in (*MUTANTS, *BROKEN) for check in reports.of(program).checks if check.status == "failed"
    }
    assert seen == {check.id for check in robot_parameters.CHECKS}
