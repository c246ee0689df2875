"""The style sheet of every report page, on the screen and on paper."""

from pathlib import Path

STYLE = Path(__file__).with_name("page.css").read_text(encoding="utf-8")
STUDY_STYLE = STYLE + Path(__file__).with_name("study_page.css").read_text(encoding="utf-8")
