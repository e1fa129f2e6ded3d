// What scrolls by itself, as a wide table or a long line of code, can be scrolled by keys.
const SCROLLING = ".md-typeset pre, .md-typeset pre > code, .md-typeset__scrollwrap, .md-typeset p:has(> img)";

function makeReachable() {
  for (const one of document.querySelectorAll(SCROLLING)) {
    if (one.scrollWidth > one.clientWidth) one.tabIndex = 0;
    else one.removeAttribute("tabindex");
  }
}
window.addEventListener("load", () => requestAnimationFrame(makeReachable));
window.addEventListener("resize", makeReachable);
