"""Our tables' Markdown as HTML."""

from __future__ import annotations

from tandem.report.from_markdown import html_of

TEXT = """# Heading
First `code` & <tags> and **strong**.

| p | what | time |
|---|---|---|
| 0.1 | a \u00d7 b | 12.50 s |
| 0.2 | <i> | 7 |

- one
- two"""


def test_tables_paragraphs_and_lists_become_html_and_everything_is_escaped():
    text = html_of(TEXT, "numbers")
    assert "<h3>Heading</h3>" in text
    assert "<p>First <code>code</code> &amp; &lt;tags&gt; and <strong>strong</strong>.</p>" in text
    assert '<td class="number">12.50 s</td>' in text
    assert '<th scope="row">0.1</th><td>a × b</td>' in text
    assert "<td>&lt;i&gt;</td>" in text
    assert "<ul><li>one</li><li>two</li></ul>" in text
    assert text.count("<tr>") == 3
    assert 'aria-label="numbers"' in text


def test_a_lone_sign_is_no_markup():
    assert html_of("2 * 3 ` 4", "") == "<p>2 * 3 ` 4</p>"
