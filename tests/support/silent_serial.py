"""A script for the page: a Web Serial port that takes no bytes and sends none.

Writing there never ends until it is aborted.
"""

from __future__ import annotations

SILENT_SERIAL = """
const port = window.port = {
  opened: 0,
  isOpen: false,
  getInfo: () => ({}),
  setSignals: async () => {},
  async open() {
    if (this.isOpen) throw new DOMException('open', 'InvalidStateError');
    this.opened += 1;
    this.isOpen = true;
    this.readable = new ReadableStream();
    let free;
    this.writable = new WritableStream({
      start(controller) { controller.signal.addEventListener('abort', () => free?.()); },
      write: () => new Promise((resolve) => { free = resolve; }),
    });
  },
  async close() {
    this.isOpen = false;
  },
};
Object.defineProperty(navigator, 'serial', {
  value: { getPorts: async () => [port], requestPort: async () => port },
});
"""
