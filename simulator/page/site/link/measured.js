// View of a live session: answer in words and on the skin, faults, measured and simulated curves.

import { Chart, withPrefix } from "rcskin/charts";
import { drawBelief, fit } from "rcskin/field";
import { fitted, residual, summary } from "rcskin/fitted";
import { drawPlace } from "rcskin/place";
import { SpectraCharts } from "rcskin/spectra";

/** @typedef {import("rcskin/model").Complex} Complex */

const SURE = 2; // standard errors, within which 19 of 20 readings lie
const NOT_READ = { re: NaN, im: NaN };

export class Measured {
  /** @param {typeof import("rcskin/app").page} page */
  constructor(page) {
    this.page = page;
    const canvas = (/** @type {string} */ id) => page.element(`live-${id}`);
    this.spectra = new SpectraCharts(canvas, page.skin.frequencies);
    this.size = new Chart(canvas("size"), "|Z| less simulated", "standard errors", 1, false);
    this.phase = new Chart(canvas("phase"), "Phase less simulated", "standard errors", 1, false);
    /** @type {any} */
    this.shown = null;
    window.addEventListener("rcskin-drawn", () => this.shown && this.#draw());
  }

  /** @param {any} state as the session sends it */
  show(state) {
    this.shown = state;
    this.#draw();
  }

  #draw() {
    const { answer, why, remarks, notes, measured, times, progress } = this.shown;
    this.#write("answer", answer ? sentence(answer.words) : "");
    this.#write("spoken", answer ? answer.label : "");
    this.#write("why", [why, ...remarks].filter(Boolean).map(sentence).join(". "));
    const items = notes.map((/** @type {string} */ note) => {
      const item = document.createElement("li");
      item.textContent = note;
      return item;
    });
    this.page.element("live-notes").replaceChildren(...items);
    this.#write("times", inFigures(times, progress));
    this.#drawAnswer(answer);
    if (measured) this.#drawMeasured(measured);
  }

  /** @param {any} answer */
  #drawAnswer(answer) {
    const { data, skin } = this.page;
    const canvas = this.page.element("live-pixels");
    const { held } = skin.outline;
    const chances = held.map(({ row, column }) => answer?.pixels?.[row - 1][column - 1] ?? 0);
    fit(canvas, data.skin);
    drawBelief(canvas, skin, held, Float64Array.from(chances), answer?.shared ?? "");
    if (answer?.position) drawPlace(canvas, data, answer.position, answer.deviation);
    canvas.setAttribute("aria-label", answer?.words ?? "no answer");
  }

  /** @param {any} measured */
  #drawMeasured(measured) {
    const { station, skin, state } = this.page;
    const Z = complex(measured.Z);
    const unpressed = station.exact([]);
    const rest = measured.rest ? complex(measured.rest) : unpressed;
    const found = fitted(station.localizer, Z, rest);
    const nearest = () => skin.pixel(found.row, found.column, 1 + found.rise);
    const touches = found.row ? [station.pressed(nearest())] : [];
    const simulated = { Z: station.exact(touches), rest: unpressed };
    const left = residual({ Z, rest }, simulated, this.#error(measured.rests));
    const { drive, at } = state();
    const spectra = {
      rest: unpressed[drive],
      last: touches.length ? simulated.Z[drive] : [],
      now: Z[drive],
      heldAgainst: rest[drive],
    };
    const marked = skin.frequencies[at];
    this.spectra.draw(spectra, station.noise, marked);
    for (const name of /** @type {const} */ (["size", "phase"])) {
      const flat = (/** @type {number} */ value) => skin.frequencies.map(() => value);
      this[name].draw(
        skin.frequencies,
        [
          { kind: "rest", values: flat(0), low: flat(-SURE), high: flat(SURE) },
          { kind: "now", values: left[name][drive] },
        ],
        marked,
      );
    }
    this.#write("residual", this.#inWords(measured, found, left));
  }

  /** Standard errors of a change, or of a reading alone if no baseline is known. @param {number} rests */
  #error(rests) {
    const { magnitude, phase } = this.page.station.localizer.readings;
    if (rests > 0) {
      const more = Math.sqrt(1 + 1 / rests);
      return { magnitude: more * magnitude, phase: more * phase };
    }
    const { magnitude_accuracy, phase_accuracy } = this.page.data.readout;
    const { noise } = this.page.state();
    return {
      magnitude: Math.hypot(magnitude, noise * magnitude_accuracy),
      phase: Math.hypot(phase, noise * phase_accuracy),
    };
  }

  /** @param {any} measured @param {import("rcskin/fitted").Fit} found @param {import("rcskin/fitted").Residual} left */
  #inWords(measured, found, left) {
    const { rms, worst } = summary(left);
    const { data, skin, station } = this.page;
    const where = data.interfaces.length > 1 ? ` at ${data.interfaces[worst.drive].name}` : "";
    const press = found.row
      ? `row ${found.row}, column ${found.column} at ${(1 + found.rise).toFixed(2)} × C`
      : "nothing pressed";
    const unit = station.noise.magnitude
      ? "standard errors of the meter"
      : "millionths (the scene's meter has no noise)";
    const what = measured.rests ? "change from the unpressed skin" : "sweep";
    const clock = new Date(measured.at).toLocaleTimeString();
    return (
      `Sweep of ${clock}. Nearest simulated: ${press}. The measured ${what} differs from it by ` +
      `${rms.toPrecision(2)} ${unit} (root mean square), at most by ` +
      `${worst.value.toPrecision(2)} at ${withPrefix(skin.frequencies[worst.at], "Hz")}${where}. ` +
      "Where the simulation is right, 19 of 20 values lie in the band."
    );
  }

  /** @param {string} id @param {string} text */
  #write(id, text) {
    const element = this.page.element(`live-${id}`);
    if (element.textContent !== text) element.textContent = text;
  }
}

/** @param {([number, number] | null)[][]} pairs @returns {Complex[][]} */
function complex(pairs) {
  return pairs.map((row) => row.map((pair) => (pair ? { re: pair[0], im: pair[1] } : NOT_READ)));
}

/** @param {any} times s @param {any} progress */
function inFigures(times, progress) {
  const now = progress.frequency ? `, ${withPrefix(progress.frequency, "Hz")}` : "";
  const sweep = `Sweep: ${progress.done} of ${progress.of} readings${now}.`;
  if (!times) return sweep;
  const ms = (/** @type {number} */ seconds) => `${Math.round(1000 * seconds)} ms`;
  const rate = times.rate ? `, ${times.rate.toPrecision(2)} answers/s` : "";
  return (
    `Sweep ${ms(times.measuring)}, answer ${ms(times.localizing)}${rate}. ` +
    `Sweeps lost: ${times.failed}. ${sweep}`
  );
}

/** Text with a capital first letter, if it begins with a word. @param {string} text */
function sentence(text) {
  return text.replace(/^[a-z](?=[a-z])/, (first) => first.toUpperCase());
}
