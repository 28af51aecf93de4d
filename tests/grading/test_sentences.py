"""The task of an exercise, sentence by sentence, is read and checked."""

from __future__ import annotations

from typing import Any

import pytest

from course_kit.grading.model import sentences
from course_kit.grading.model.sentences import Sentence


def test_sentences_are_read_with_all_their_fields() -> None:
    table = {"id": "depth", "text": " Any depth will do. ", "heading": "Queues.", "cell": "task", "freedom": "shallow"}
    assert sentences.read([table]) == (Sentence("depth", "Any depth will do.", "Queues.", "task", "shallow"),)


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"id": "a", "text": "A."}, "has to be written as"),
        (["A."], "a table of texts"),
        ([{"id": "a", "text": 3}], "a table of texts"),
        ([{"text": "A."}], "the sentence 'A.' needs an 'id'"),
        ([{"id": "A b", "text": "A."}], "small letters"),
        ([{"id": "a", "text": " "}], "the sentence 'a' has no 'text'"),
        ([{"id": "a", "txt": "A."}], "no field 'txt'"),
        ([{"id": "a", "text": "A."}, {"id": "a", "text": "B."}], "two sentences have the id 'a'"),
    ],
)
def test_what_cannot_be_meant_is_refused_with_its_cause(tables: Any, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        sentences.read(tables)
