"""A script for the page: it records each tone, without sound, and each animation."""

from __future__ import annotations

NOTE_EFFECTS = """() => {
  window.heard = []; window.shaken = window.started = window.stopped = 0;
  const param = () => ({set value(hertz) { window.heard.push(hertz); },
    setValueAtTime(hertz) { if (hertz > 1) window.heard.push(hertz); },
    linearRampToValueAtTime() {}, exponentialRampToValueAtTime() {}});
  const node = () => ({connect: (to) => to});
  window.AudioContext = class {
    destination = {};
    resume() {}
    suspend() {}
    get currentTime() { return performance.now() / 1000; }
    createGain() {
      return {...node(), gain: {setValueAtTime() {}, linearRampToValueAtTime() {}}};
    }
    createOscillator() {
      return {...node(), frequency: param(), addEventListener() {},
        start() { window.started += 1; }, stop(at) { if (at === undefined) window.stopped += 1; }};
    }
  };
  const animate = Element.prototype.animate;
  Element.prototype.animate = function (...how) {
    window.shaken += 1;
    return animate.apply(this, how);
  };
}"""
