"""What is stored of a run: what the notebook says, and nothing of when and where it was run."""

from __future__ import annotations

import nbformat

from course_kit.dev.store_outputs import WIDGET, normalise_notebook


def test_numbers_begin_anew_and_times_and_widgets_are_left_out() -> None:
    cell, output = nbformat.v4.new_code_cell, nbformat.v4.new_output
    panel = output("display_data", {"text/plain": "A panel.", WIDGET: {"model_id": "1"}})
    result = output("execute_result", {"text/plain": "3"}, execution_count=9)
    notebook = nbformat.v4.new_notebook(
        metadata={"language_info": {"name": "python", "version": "3.12.1"}},
        cells=[
            cell("panel()", execution_count=7, outputs=[panel], metadata={"execution": {"iopub.status.idle": "now"}}),
            nbformat.v4.new_markdown_cell("Text."),
            cell(""),
            cell("1 + 2", execution_count=9, outputs=[result]),
        ],
    )
    stored = normalise_notebook(notebook)
    first, _, empty, last = stored.cells
    assert stored.metadata.language_info == {"name": "python"}
    assert first.metadata == {}
    assert first.outputs[0].data == {"text/plain": "A panel."}
    assert (first.execution_count, empty.execution_count, last.execution_count) == (1, None, 2)
    assert last.outputs[0].execution_count == 2
