"""A page of A4 with rectangles and lines of text, as SVG and as PDF: the same page twice.

It knows both formats, but not the content of the page. Both are text, always the same for the same
page. Lengths are points, y goes down from the upper edge.
"""

from __future__ import annotations

from html import escape
from typing import NamedTuple

WIDTH, HEIGHT = 595, 842
SANS_FONT, BOLD_FONT, MONO_FONT = "sans", "bold", "mono"
# Font names in PDF, whose metrics every viewer has, and in SVG.
FONTS = {
    SANS_FONT: ("Helvetica", "font-family='Helvetica, Arial, sans-serif'"),
    BOLD_FONT: ("Helvetica-Bold", "font-family='Helvetica, Arial, sans-serif' font-weight='bold'"),
    MONO_FONT: ("Courier-Bold", "font-family='Courier New, Courier, monospace' font-weight='bold'"),
}


class Box(NamedTuple):
    """A filled rectangle; `colour` is red, green and blue, 0 to 255."""

    x: float
    y: float
    width: float
    height: float
    colour: tuple[int, int, int]


class Line(NamedTuple):
    """A line of text with the baseline `y`."""

    x: float
    y: float
    size: float
    font: str
    colour: tuple[int, int, int]
    text: str


Page = list[Box | Line]


def svg(page: Page, title: str, note: str) -> str:
    """Return the page as SVG. `note` is a comment at its beginning."""
    rows = [
        f"<!-- {note} -->",
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}"'
        f' width="210mm" height="297mm" role="img">',
        f"<title>{escape(title)}</title>",
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>',
    ]
    for box in page:
        colour = "#{:02x}{:02x}{:02x}".format(*box.colour)
        if isinstance(box, Box):
            rows.append(
                f'<rect x="{box.x:g}" y="{box.y:g}" width="{box.width:g}"'
                f' height="{box.height:g}" fill="{colour}"/>'
            )
        else:
            font = FONTS[box.font][1].replace("'", '"')
            rows.append(
                f'<text x="{box.x:g}" y="{box.y:g}" font-size="{box.size:g}" {font}'
                f' fill="{colour}" xml:space="preserve">{escape(box.text)}</text>'
            )
    return "\n".join([*rows, "</svg>"]) + "\n"


def pdf(page: Page, title: str, note: str) -> str:
    """Return the page as PDF, in ASCII. Its signs are those of Windows-1252."""
    names = list(FONTS)
    content = "\n".join(_pdf_row(object_text, names) for object_text in page)
    fonts = " ".join(f"/F{k} {5 + k} 0 R" for k in range(len(names)))
    objects = [
        "<< /Type /Catalog /Pages 2 0 R >>",
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        f"<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {WIDTH} {HEIGHT}]"
        f" /Resources << /Font << {fonts} >> >> /Contents 4 0 R >>",
        f"<< /Length {len(content)} >>\nstream\n{content}\nendstream",
        *(
            f"<< /Type /Font /Subtype /Type1 /BaseFont /{FONTS[name][0]}"
            " /Encoding /WinAnsiEncoding >>"
            for name in names
        ),
        f"<< /Title {_pdf_text(title)} >>",
    ]
    text = f"%PDF-1.4\n% {note}\n"
    offsets = []
    for number, object_text in enumerate(objects, 1):
        offsets.append(len(text))
        text += f"{number} 0 obj\n{object_text}\nendobj\n"
    start = len(text)
    rows = "".join(f"{offset:010} 00000 n \n" for offset in offsets)
    count = len(objects) + 1
    return (
        f"{text}xref\n0 {count}\n0000000000 65535 f \n{rows}"
        f"trailer\n<< /Size {count} /Root 1 0 R /Info {len(objects)} 0 R >>\n"
        f"startxref\n{start}\n%%EOF\n"
    )


def _pdf_row(box: Box | Line, names: list[str]) -> str:
    colour = " ".join(f"{part / 255:.3g}" for part in box.colour)
    if isinstance(box, Box):
        y = HEIGHT - box.y - box.height
        return f"{colour} rg {box.x:g} {y:g} {box.width:g} {box.height:g} re f"
    font = names.index(box.font)
    place = f"{box.x:g} {HEIGHT - box.y:g}"
    return f"BT {colour} rg /F{font} {box.size:g} Tf {place} Td {_pdf_text(box.text)} Tj ET"


def _pdf_text(text: str) -> str:
    """Return a text in round brackets; non-ASCII characters are octal numbers."""
    result = ""
    for byte in text.encode("cp1252"):
        sign = chr(byte)
        result += f"\\{sign}" if sign in "()\\" else sign if 32 <= byte < 127 else f"\\{byte:03o}"
    return f"({result})"
