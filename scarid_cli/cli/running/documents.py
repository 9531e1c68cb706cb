"""The documents that `report` writes: a page, Markdown, and text."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from scarid_cli.errors import UsageFault
from scarid_cli.reporting import text
from scarid_cli.reporting.parts import Section

if TYPE_CHECKING:
    from scarid_cli.cli.running.job import Job
    from scarid_cli.io.writer import Document


@dataclass(frozen=True)
class Documents:
    """Those that were asked for, opened before anything is read.

    `page` is for the caller to write.
    """

    page: Document | None
    markdown: Document | None
    text: Document | None
    show: Callable[[str, str], object]

    @classmethod
    def opened(
        cls, job: Job, html: str | None, markdown: str | None, place: str | None
    ) -> Documents:
        """At the paths of --html, --markdown and --output; UsageFault if the first two are one."""
        if html and html == markdown:
            raise UsageFault(f"--html and --markdown both go to {html}; give two files")
        return cls(job.side_text(html), job.side_text(markdown), job.side_text(place), job.show)

    def write(self, title: str, sections: Sequence[Section]) -> None:
        """Write Markdown and text; the latter to standard output, unless another one goes there."""
        if self.markdown:
            self.markdown.write(text.markdown(title, sections))
        if self.text:
            self.text.write(text.terminal(sections, plain=True))
        elif "-" not in (document.path for document in (self.page, self.markdown) if document):
            self.show(text.terminal(sections), "")
