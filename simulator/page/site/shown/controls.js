// Sliders, boxes and their values: they show the state, and change it.

import { withPrefix } from "rcskin/charts";
import { near, reads } from "rcskin/state";

/** @typedef {import("rcskin/state").State} State */

const BY_DECADE = /** @type {const} */ (["top", "bottom", "capacitance", "noise"]);
const AS_IT_IS = /** @type {const} */ (["loss", "factor"]);
const TICKED = /** @type {const} */ (["whole", "arrows", "running", "together", "earthed"]);

/** @param {string} id @returns {any} */
export const element = (id) => document.getElementById(id);

export class Controls {
  /**
   * @param {any} data of the page @param {() => State} state
   * @param {(values: Partial<State>, cast: boolean) => void} set cast: true if the skin or its readings change
   * @param {(factor: number) => void} setStrength
   */
  constructor(data, state, set, setStrength) {
    this.data = data;
    this.state = state;
    this.set = set;
    this.#limits();
    this.#boxes(
      "read-frequencies",
      "frequencies",
      data.frequencies.map((/** @type {number} */ f) => withPrefix(f, "Hz")),
    );
    this.#boxes(
      "read-interfaces",
      "drives",
      data.interfaces.map((/** @type {any} */ each) => each.name),
    );
    this.#on("strength", "input", (box) => setStrength(Number(box.value)));
    this.#on("at", "input", (box) => set({ at: Number(box.value) }, false));
    this.#on("drive", "change", (box) => set({ drive: Number(box.value) }, false));
    for (const name of BY_DECADE)
      this.#on(name, "input", (box) => {
        const value = Number((10 ** Number(box.value)).toPrecision(4));
        set({ [name]: value, ...this.#besides(name, value) }, true);
        this.show();
      });
    for (const name of AS_IT_IS)
      this.#on(name, "input", (box) => set({ [name]: Number(box.value) }, true));
    this.ticked = TICKED.filter((name) => element(name));
    for (const name of this.ticked)
      this.#on(name, "change", (box) => set({ [name]: box.checked }, name === "earthed"));
  }

  /** Sets every control to the state. */
  show() {
    const state = this.state();
    element("strength").value = state.strength;
    element("at").value = state.at;
    element("drive").value = state.drive;
    for (const name of BY_DECADE) element(name).value = Math.log10(state[name]);
    for (const name of AS_IT_IS) element(name).value = state[name];
    for (const name of this.ticked) element(name).checked = state[name];
    for (const name of /** @type {const} */ (["frequencies", "drives"])) {
      const boxes = /** @type {NodeListOf<HTMLInputElement>} */ (
        document.querySelectorAll(`input[data-of="${name}"]`)
      );
      for (const [k, box] of boxes.entries()) box.checked = state[name].includes(k);
    }
    this.tell();
  }

  /** Writes the values next to the sliders, in their units. */
  tell() {
    const { data } = this;
    const state = this.state();
    const [top, bottom] = [state.top, state.bottom].map((factor, k) =>
      withPrefix(data.sheets[k] * factor, "ohm/sq"),
    );
    const texts = {
      strength: `${state.strength.toFixed(2)} × C`,
      at: withPrefix(data.frequencies[state.at], "Hz"),
      top,
      bottom,
      capacitance: withPrefix(data.foam.capacitance_per_area * state.capacitance, "F/m²"),
      loss: state.loss.toFixed(3),
      noise: `${Number((100 * state.noise * data.readout.magnitude_noise).toPrecision(2))} %`,
      factor: `${state.factor.toFixed(2)} × C`,
    };
    for (const [name, text] of Object.entries(texts)) {
      element(`${name}-value`).textContent = text;
      element(name).setAttribute("aria-valuetext", text);
    }
  }

  /** Change of the other sheet by a sheet's slider. @param {string} name @param {number} value @returns {Partial<State>} */
  #besides(name, value) {
    const other = { top: "bottom", bottom: "top" }[name];
    if (other !== "top" && other !== "bottom") return {};
    const { together, [other]: before } = this.state();
    return { [other]: together ? value : near(before, value, this.data) };
  }

  #limits() {
    const { range, interfaces, frequencies } = this.data;
    const strongest = 1 + range.rise[1];
    Object.assign(element("strength"), { min: 1, max: strongest });
    Object.assign(element("factor"), { max: strongest });
    Object.assign(element("at"), { max: frequencies.length - 1 });
    for (const name of ["top", "bottom", "capacitance"]) {
      const [min, max] = range[name === "capacitance" ? name : "resistance"].map(Math.log10);
      Object.assign(element(name), { min, max });
    }
    element("whole-label").hidden = this.data.plan.groups !== null;
    for (const [k, each] of interfaces.entries())
      element("drive").append(new Option(each.name, String(k)));
    for (const id of ["drive-label", "read-interfaces"])
      element(id).hidden = interfaces.length === 1;
  }

  /** Adds a check box for every frequency or interface; the last ticked one stays ticked. @param {string} id @param {"frequencies" | "drives"} name @param {string[]} labels */
  #boxes(id, name, labels) {
    for (const [k, text] of labels.entries()) {
      const label = document.createElement("label");
      const box = document.createElement("input");
      box.type = "checkbox";
      box.dataset.of = name;
      box.addEventListener("change", () => {
        const others = this.state()[name].filter((each) => each !== k);
        const chosen = box.checked ? [...others, k].sort((a, b) => a - b) : others;
        const asked = { ...this.state(), [name]: chosen };
        const read = reads(asked, this.data);
        box.checked ||= !read;
        if (read) this.set({ [name]: chosen }, true);
      });
      label.append(box, text);
      element(id).append(label);
    }
  }

  /** @param {string} id @param {string} event @param {(box: any) => void} act */
  #on(id, event, act) {
    element(id).addEventListener(event, (/** @type {Event} */ happened) => act(happened.target));
  }
}
