// A slider under a finger: it is set by a tap, or by a drag along it. A finger that scrolls the page sets nothing.

const CLICK_PX = 8; // a finger that moved less has tapped

/** Its listeners of `input` hear of no other change. @param {HTMLInputElement} slider a horizontal one */
export function deliberate(slider) {
  /** What a finger does: where it began, the value before, and the one that the browser would have set. @type {{id: number, x: number, before: string, wanted: string} | null} */
  let held = null;
  const settle = (/** @type {string} */ value) => {
    slider.value = value;
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  };
  slider.addEventListener("pointerdown", ({ pointerType, pointerId, clientX }) => {
    if (pointerType === "touch") held = { id: pointerId, x: clientX, before: slider.value, wanted: slider.value };
  });
  slider.addEventListener("pointermove", ({ pointerId, clientX }) => {
    if (held?.id === pointerId && Math.abs(clientX - held.x) > CLICK_PX) held = null; // it drags
  });
  slider.addEventListener("pointerup", ({ pointerId }) => {
    if (held?.id !== pointerId) return;
    const { wanted, before } = held;
    held = null;
    if (wanted !== before) settle(wanted);
  });
  slider.addEventListener("pointercancel", () => {
    if (held) slider.value = held.before;
    held = null;
  });
  slider.addEventListener("input", (event) => {
    if (!held) return;
    held.wanted = slider.value;
    slider.value = held.before;
    event.stopImmediatePropagation();
  }, true);
}
