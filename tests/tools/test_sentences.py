import pytest
from hypothesis import given
from hypothesis import strategies as st

from tools.sentences import Count, count, files, main

SHORT = "One two three. Four five.\n"
LONG = " ".join(["word"] * 21) + ".\n"


@pytest.mark.parametrize(
    ("text", "sentences", "words"),
    [
        ("", 0, 0),
        (SHORT, 2, 5),
        ("It weighs 0.5 kg. See e.g. the page.", 2, 8),
        ("Is it?\nIt is! So", 3, 5),
        ("(It is.) Then it ends.", 2, 5),
        ("The value 3.5 % is small.", 1, 5),  # a sign is no word
        ("The gap – a dash – is open.", 1, 6),
    ],
)
def test_sentences_end_where_a_reader_stops(text, sentences, words):
    assert count(text) == Count(sentences, words)


@pytest.mark.parametrize(
    "left_out",
    [
        "# A heading with many words. And two sentences.",
        "```python\nx = 1  # one. Two.\n```",
        "    indented = code",
        "| a cell. Another | b |\n|---|---|\n| c. D | e |",
        "![A picture of many words. Two.](images/x.png)",
        "<!-- a comment. Two. -->",
    ],
)
def test_what_is_no_prose_is_left_out(left_out):
    assert count(f"{SHORT}\n{left_out}\n\n{SHORT}") == Count(4, 10)


def test_a_list_item_is_a_sentence():
    assert count("Give:\n\n- a recording\n- a platform file; it is short\n  and on two lines\n") == Count(
        3, 13
    )
    assert count("1. One two\n2. Three\n") == Count(2, 3)


def test_code_in_a_sentence_is_one_word_and_a_link_is_its_text():
    assert count("Run `simgap diagnose platform=arm` now. See [the page](https://a.b/c.d).") == Count(2, 6)


@given(st.lists(st.integers(1, 30), min_size=1, max_size=10), st.sampled_from([" ", "\n", "\n\n", "\n- "]))
def test_the_mean_is_that_of_the_sentences_written(lengths, gap):
    text = gap.join(" ".join(["Word"] * length) + "." for length in lengths)
    assert count(text) == Count(len(lengths), sum(lengths))


def test_folders_are_searched_and_tutorials_read_for_their_prose(tmp_path, capsys):
    (tmp_path / "b").mkdir()
    (tmp_path / "a.md").write_text(SHORT)
    (tmp_path / "b" / "c.py").write_text("# %% [markdown]\n# One two. Three.\n# %%\nx = 1\n")
    (tmp_path / "b" / "d.svg").write_text("<svg/>")
    assert [path.name for path in files([tmp_path])] == ["a.md", "c.py"]
    assert main([str(tmp_path)]) == 0
    rows = [line.split()[:3] for line in capsys.readouterr().out.splitlines()[1:]]
    assert rows == [["2", "5", "2.5"], ["2", "3", "1.5"], ["4", "8", "2.0"]]


def test_long_sentences_are_refused_file_by_file(tmp_path, capsys):
    (tmp_path / "long.md").write_text(LONG)
    (tmp_path / "short.md").write_text(SHORT * 9)
    assert main([str(tmp_path / "short.md")]) == 0
    capsys.readouterr()
    assert main([str(tmp_path)]) == 1
    (refused,) = [line for line in capsys.readouterr().out.splitlines() if "too long" in line]
    assert "long.md" in refused
