"""A real kernel to run cells in."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from tests.lab.kernel import Kernel

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture(scope="session")
def _one_kernel(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    """A kernel on a domain of its own; starting one takes longer than most tests."""
    with environment.exclusive_domain() as domain_id, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain_id))
        with Kernel(cwd=tmp_path_factory.mktemp("kernel")) as running:
            assert running.run("%load_ext course_kit\nfrom course_kit import lab").ok
            yield running


@pytest.fixture
def kernel(_one_kernel: Kernel) -> Kernel:
    """A kernel with the course's extension, in which nothing runs and nothing is recorded."""
    tidied = _one_kernel.run("lab.stop()\nlab.stop_script()\nlab.record()")
    assert tidied.ok, tidied.error
    return _one_kernel


@pytest.fixture
def fresh_kernel(domain: int, tmp_path: Path) -> Iterator[Kernel]:
    """A kernel for a test that ends it."""
    assert domain
    with Kernel(cwd=tmp_path) as running:
        assert running.run("%load_ext course_kit\nfrom course_kit import lab").ok
        yield running
