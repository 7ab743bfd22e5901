"""Screens of the page, and the look of each."""

from __future__ import annotations

SCREENS = ((1366, 768), (1024, 600), (390, 844), (844, 390))
# Clickable elements, and whether another one or the edge of the screen cuts them.
LOOK_SCRIPT = """() => {
  const found = [];
  const boxes = [...document.querySelectorAll('header button, header select, h1, main section > :not(div), #sides > *, #views_of_run > *, #controls > *, #editor, #link_ways > *, #link_drive > *, #lesson_controls > *, #lesson_said, #lesson_page, #arena, #world_tools > :not(span), #world_numbers > *')]
    .filter((e) => e.checkVisibility() && (e.textContent || e.value || e.id === 'arena' || e.querySelector('svg')))
    .map((e) => [e.id || e.tagName, e.getBoundingClientRect()]);
  for (const [name, box] of boxes) {
    if (box.left < -0.5 || box.top < -0.5 || box.right > innerWidth + 0.5 || box.bottom > innerHeight + 0.5)
      found.push(name + ' is cut off');
    if (box.width < 1 || box.height < 1) found.push(name + ' cannot be seen');
  }
  for (const [a, one] of boxes) for (const [b, other] of boxes) {
    if (a < b && Math.min(one.right, other.right) - Math.max(one.left, other.left) > 1
        && Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top) > 1)
      found.push(a + ' is over ' + b);
  }
  for (const e of document.querySelectorAll('button, select')) {
    if (!e.checkVisibility()) continue;
    const box = e.getBoundingClientRect();
    if (box.height < 44 || box.width < 44) found.push((e.id || e.textContent) + ' is too small for a finger');
    if (e.scrollWidth > e.clientWidth + 1 && e.tagName === 'BUTTON') found.push(e.textContent + ' does not fit');
  }
  if (document.documentElement.scrollWidth > innerWidth) found.push('the page is too wide');
  return found;
}"""
