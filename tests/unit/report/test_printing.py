"""A page as a PDF: three pages at most of the short report, and the way by hand where there is no browser."""

import re
import shutil
import subprocess

import pytest

from fem.__main__ import main
from fem.report import printing

NEEDS_BROWSER = pytest.mark.skipif(
    printing.find_browser() is None, reason="no Chromium or Chrome to print with"
)


@pytest.fixture(scope="module")
def folder(gallery, tmp_path_factory):
    return gallery.copy("rigid", tmp_path_factory.mktemp("printed"))


def test_the_document_stands_on_the_page_and_at_the_head_of_every_sheet(folder):
    assert main(["report", str(folder), "-q", "--short", "--revision", "B"]) == 0
    text = (folder / "report-short.html").read_text(encoding="utf-8")
    heads = re.search(r"@top-left \{ content: (.*?); \} @top-right \{ content: (.*?); \}", text)
    said = [re.sub(r"\\([0-9a-f]{6})", lambda sign: chr(int(sign[1], 16)), one) for one in heads.groups()]
    assert said == ['"Store <3> · 7-A"', '"revision B"']
    assert "Store &lt;3&gt; · 7-A" in text
    assert 'id="sheet"' not in text
    assert 'id="static"' in text


@NEEDS_BROWSER
def test_the_page_that_is_printed_unasked_is_the_short_one_of_three_sheets_at_most(folder, capsys):
    assert main(["report", str(folder), "-q", "--pdf"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == str(folder / "report-short.pdf")
    pdf = (folder / "report-short.pdf").read_bytes()
    assert pdf.startswith(b"%PDF")
    if shutil.which("pdfinfo"):
        info = subprocess.run(
            ["pdfinfo", folder / "report-short.pdf"], capture_output=True, text=True, check=True
        ).stdout
        assert int(re.search(r"^Pages:\s+(\d+)", info, flags=re.MULTILINE)[1]) <= 3
        assert "A4" in info


def test_without_a_browser_the_way_by_hand_is_printed(folder, monkeypatch, capsys):
    monkeypatch.setenv("PATH", str(folder))
    monkeypatch.setattr(printing, "PLACES", ())
    for place in ((), ("--to", str(folder / "calc.pdf"))):
        assert main(["report", str(folder), "-q", "--short", "--pdf", *place]) == 0
        assert capsys.readouterr().out.splitlines()[-1] == printing.BY_HAND
    assert (folder / "calc.html").is_file()
