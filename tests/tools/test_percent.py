from tools.percent import Cell, as_markdown, cells

SCRIPT = '''"""A script."""

# %% [markdown]
# # A title
#
# Prose.

# %%
x = 1

# a comment
print(x)

# %% [markdown]

# %% tags=["remove-cell"]
y = 2
'''


def test_cells_are_prose_or_code_and_know_their_line():
    assert cells(SCRIPT) == [
        Cell("# A title\n\nProse.", True, 4),
        Cell("x = 1\n\n# a comment\nprint(x)", False, 9),
        Cell("y = 2", False, 17, is_hidden=True),
    ]
    lines = SCRIPT.split("\n")
    assert all(each.text.split("\n")[0] in lines[each.line - 1] for each in cells(SCRIPT))


def test_a_page_holds_prose_as_it_is_and_code_in_blocks_but_no_hidden_cells():
    expected = "# A title\n\nProse.\n\n```python\nx = 1\n\n# a comment\nprint(x)\n```\n"
    assert as_markdown(SCRIPT) == expected


def test_a_script_without_cells_is_no_page():
    assert cells("x = 1\n") == []
