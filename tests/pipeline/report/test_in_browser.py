"""The page as Chromium sees it: no complaint, no request, no script of a stranger."""

from collections.abc import Iterator

import pytest

from simgap.report import ReportInputs, write_page
from tests.pipeline.report.artifacts import HOSTILE, make_branch
from tests.pipeline.report.browser import Browser, chromium, find_chromium


@pytest.fixture
def browser() -> Iterator[Browser]:
    executable = find_chromium()
    if executable is None:
        pytest.skip("no Chromium on this machine: the page is not opened in a browser")
    with chromium(executable) as opened:
        yield opened


@pytest.mark.slow
@pytest.mark.parametrize("text", ["", HOSTILE])
def test_the_page_draws_everything_and_asks_for_nothing(tmp_path, browser, text):
    page = tmp_path / "report.html"
    write_page(ReportInputs.of_branch(make_branch(tmp_path, text=text), text or "nanodrone"), page)
    browser.open(page)
    assert browser.evaluate("window.hacked") is None
    assert browser.evaluate("document.querySelectorAll('img[src=x]').length") == 0
    browser.evaluate("document.querySelectorAll('details').forEach(folded => folded.open = true)")
    browser.evaluate("new Promise(done => setTimeout(done, 500))")
    drawn = "[...document.querySelectorAll('.plot')].map(plot => plot.querySelectorAll('svg path').length)"
    assert len(browser.evaluate(drawn)) == 5
    assert all(browser.evaluate(drawn))
    _choose_every_trace(browser)
    assert browser.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    assert browser.complaints() == []
    assert [url for url in browser.requests() if not url.startswith("data:")] == [page.as_uri()]


@pytest.mark.slow
def test_an_attempt_to_reach_the_network_or_to_add_a_script_is_refused(tmp_path, browser):
    page = tmp_path / "report.html"
    write_page(ReportInputs.of_branch(make_branch(tmp_path, bare=True)), page)
    browser.open(page)
    added = (
        "document.body.append(Object.assign(document.createElement('script'), {text: 'window.hacked = 1'}))"
    )
    browser.evaluate(added)
    assert browser.evaluate("window.hacked") is None
    assert browser.evaluate("fetch('data:,x').then(() => 'reached', () => 'refused')") == "refused"


@pytest.mark.slow
@pytest.mark.parametrize("width", [1400, 390])
def test_no_tick_labels_touch_and_nothing_is_wider_than_the_screen(tmp_path, browser, width):
    page = tmp_path / "report.html"
    write_page(ReportInputs.of_branch(make_branch(tmp_path), "nanodrone"), page)
    browser.open(page, width=width)
    touching = """[...document.querySelectorAll('.plot svg, .ticks div')].flatMap((drawn) => {
      const labels = [...drawn.querySelectorAll('text:not(.title), span')]
        .map((text) => [text.textContent, text.getBoundingClientRect()]);
      return labels.flatMap(([one, a], i) => labels.slice(i + 1)
        .filter(([, b]) => a.left < b.right && b.left < a.right && a.top < b.bottom - 2 && b.top < a.bottom - 2)
        .map(([other]) => [one, other]));
    })"""
    assert browser.evaluate(touching) == []
    assert browser.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.slow
def test_a_stretch_is_enlarged_by_dragging_and_shown_whole_again(tmp_path, browser):
    page = tmp_path / "report.html"
    write_page(ReportInputs.of_branch(make_branch(tmp_path), "nanodrone"), page)
    browser.open(page)
    ticks = """[...document.querySelectorAll('.traces svg text[text-anchor=middle]')].map((text) => text.textContent)"""
    whole = browser.evaluate(ticks)
    browser.evaluate("""(() => {
      const svg = document.querySelector('.traces svg'), box = svg.getBoundingClientRect();
      for (const [type, x] of [['pointerdown', 300], ['pointermove', 350], ['pointerup', 400]]) {
        const at = { clientX: box.left + x, clientY: box.top + 60, pointerType: 'mouse', bubbles: true };
        svg.dispatchEvent(new PointerEvent(type, at));
      }
    })()""")
    enlarged = browser.evaluate(ticks)
    assert enlarged != whole
    assert float(enlarged[-1]) < float(whole[-1])
    browser.evaluate("document.querySelector('.traces svg').dispatchEvent(new MouseEvent('dblclick'))")
    assert browser.evaluate(ticks) == whole


def _choose_every_trace(browser: Browser) -> None:
    choose = """[...document.querySelectorAll('.traces select')].flatMap((select) =>
      [...select.options].map((option) => {
        select.value = option.value;
        select.dispatchEvent(new Event('change'));
        return select.value === option.value;
      }))"""
    assert all(browser.evaluate(choose))
