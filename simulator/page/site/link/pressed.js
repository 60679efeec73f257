// Virtual skin: touches on the page press it, and presses by others are shown.

import { withPrefix } from "rcskin/charts";
import { parsed, unmistakable } from "rcskin/presses";
import { parallelCapacitance } from "rcskin/skin";
import { pressText } from "rcskin/takeaway";

export class Pressed {
  /** @param {typeof import("rcskin/app").page} page @param {(message: any) => boolean} say */
  constructor(page, say) {
    this.page = page;
    this.say = say;
    /** @type {string | null} the page's touches when both were last equal; null before the first frame */
    this.agreed = null;
    /** @type {string | null} press that was requested and not yet answered */
    this.asked = null;
    window.addEventListener("rcskin-drawn", () => this.#ask());
  }

  /** Drops the pending request: the line was lost, and the request may not have arrived. */
  forget() {
    this.asked = null;
    this.agreed = null;
  }

  /** @param {any} state of the virtual meter */
  show({ press, interface: drive, reading, faults }) {
    this.#write("press", press === "none" ? "Nothing is pressed" : `Pressed: ${press}`);
    const latest = reading
      ? `Latest reading: ${inWords(reading)}, at interface ${drive}.`
      : `No reading yet, at interface ${drive}.`;
    const coming = faults.length ? ` Pending faults: ${faults.join(", ")}.` : "";
    this.#write("reading", latest + coming);
    if (this.asked !== null || this.page.gestures.held.size) return;
    const touches = parsed(press, this.page.skin) ?? [];
    const text = pressText(touches);
    if (text === this.agreed) return;
    this.agreed = text;
    this.page.gestures.set(touches);
  }

  /** @param {any} answer to a press */
  answered(answer) {
    this.#write("why", answer.do === "refused" ? answer.why : "");
    this.agreed = this.asked;
    this.asked = null;
    this.#ask();
  }

  #ask() {
    if (this.agreed === null || this.asked !== null) return;
    const { touches } = this.page.state();
    const text = pressText(touches);
    if (text === this.agreed) return;
    const press = unmistakable(touches, this.page.data);
    if (this.say({ do: "press", press })) this.asked = text;
  }

  /** @param {string} id @param {string} text */
  #write(id, text) {
    const element = this.page.element(`skin-${id}`);
    if (element.textContent !== text) element.textContent = text;
  }
}

/** @param {{frequency: number, Z: [number, number]}} reading */
function inWords({ frequency, Z: [re, im] }) {
  const Cp = parallelCapacitance({ re, im }, frequency);
  return `${withPrefix(frequency, "Hz")}, Rs ${withPrefix(re, "ohm")}, Cp ${withPrefix(Cp, "F")}`;
}
