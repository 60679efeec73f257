// Served page: connected to a live session, or to a virtual meter whose skin it presses.

import { page } from "rcskin/app";
import { Line } from "rcskin/line";
import { Measured } from "rcskin/measured";
import { Pressed } from "rcskin/pressed";

const section = /** @type {HTMLElement} */ (document.querySelector(".linked"));
const line = new Line({
  frame: (state) => shown.show(state),
  told: (answer) => shown instanceof Pressed && shown.told(answer),
  changed: (up, left) => {
    section.classList.toggle("lost", !up);
    if (!up && shown instanceof Pressed) shown.forget();
    page.element("link").textContent = up
      ? "Linked."
      : "The link is lost; trying again. If the program was started anew, open the address that it tells.";
    page.element("left").textContent = left
      ? `Frames left out, drawing being slower: ${left}.`
      : "";
  },
});
const shown = page.element("skin-press")
  ? new Pressed(page, (message) => line.say(message))
  : new Measured(page);
