// Served page: connected to a live session, or to a virtual meter whose skin it presses.

import { page } from "rcskin/app";
import { Line } from "rcskin/line";
import { Measured } from "rcskin/measured";
import { Pressed } from "rcskin/pressed";

const section = /** @type {HTMLElement} */ (document.querySelector(".linked"));
const line = new Line({
  frame: (state) => shown.show(state),
  answered: (answer) => shown instanceof Pressed && shown.answered(answer),
  changed: (up, left) => {
    section.classList.toggle("lost", !up);
    if (!up && shown instanceof Pressed) shown.forget();
    page.element("link").textContent = up
      ? "Linked."
      : "The connection is lost; trying again. If the program was restarted, open the address that it printed.";
    page.element("left").textContent = left
      ? `Frames skipped because drawing is slower: ${left}.`
      : "";
  },
});
const shown = page.element("skin-press")
  ? new Pressed(page, (message) => line.say(message))
  : new Measured(page);
