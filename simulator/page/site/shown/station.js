// Measurement setup: the skin as it is set, the meter, and the localizer for both.

import { Localizer, RESTS } from "rcskin/localizer";
import { displayed, Meter } from "rcskin/meter";

/** @typedef {import("rcskin/model").Complex} Complex */
/** @typedef {import("rcskin/skin").Touch} Touch */
/** @typedef {import("rcskin/state").State} State */
/**
 * Z in ohm by interface and frequency, and the mean of the baseline sweeps.
 * @typedef {{touches: Touch[], Z: Complex[][], rest: Complex[][]}} Measured
 */

const LEAST_NOISE = 1e-6; // for a scene whose meter has none: unit of the localizer's errors

export class Station {
  /** @param {import("rcskin/skin").Skin} skin @param {() => State} state */
  constructor(skin, state) {
    this.skin = skin;
    this.state = state;
    this.few = false;
    this.localizer = this.#localizer();
  }

  /** Skin as the sliders set it. @returns {import("rcskin/skin").Cast} */
  get cast() {
    const { top, bottom, capacitance, loss } = this.state();
    return { top, bottom, capacitance, loss };
  }

  /** Touch by a finger or a rod, as the switch is set. @param {Touch} touch @returns {Touch} */
  pressed(touch) {
    return this.state().earthed ? this.skin.byFinger(touch) : touch;
  }

  /** Noise of one reading, |Z| as a fraction and the phase in rad. */
  get noise() {
    const { magnitude_noise, phase_noise } = this.skin.data.readout;
    const { noise } = this.state();
    return { magnitude: noise * magnitude_noise, phase: noise * phase_noise };
  }

  /** Updates the localizer after a change of the skin, the meter or the readings. @param {boolean} moving true if it may change again at once */
  renew(moving) {
    this.few = moving && this.skin.anew(this.cast);
    this.localizer = this.#localizer();
  }

  /** Z in ohm by interface and frequency, without noise. @param {Touch[]} touches @returns {Complex[][]} */
  exact(touches) {
    const { skin, cast } = this;
    const found = skin.responses(touches, cast);
    return found.map((each) => skin.frequencies.map((_, k) => skin.impedance(each, k, cast)));
  }

  /** One sweep of the pressed skin, and several baseline sweeps, in one session. @returns {Measured} */
  measure() {
    const { readout, interfaces } = this.skin.data;
    const { noise, seed, touches } = this.state();
    const meter = new Meter(readout, noise, seed, interfaces.length);
    const read = (/** @type {Complex} */ z, /** @type {number} */ drive) => meter.read(z, drive);
    const rest = this.exact([]).map((values, drive) =>
      values.map((z) => mean(Array.from({ length: RESTS }, () => read(z, drive)))),
    );
    const Z = this.exact(touches).map((values, drive) => values.map((z) => read(z, drive)));
    return { touches, Z, rest };
  }

  /** Readings as the meter displays them. @param {Complex[][]} Z */
  displayed(Z) {
    const digits = this.skin.data.readout.display_digits;
    const shown = (/** @type {Complex} */ z) => ({
      re: displayed(z.re, digits),
      im: displayed(z.im, digits),
    });
    return Z.map((values) => values.map(shown));
  }

  #localizer() {
    const { drives, frequencies, factor, earthed } = this.state();
    const magnitude = this.noise.magnitude || LEAST_NOISE;
    const phase = this.noise.phase || LEAST_NOISE;
    const readings = { drives, frequencies, magnitude, phase };
    return new Localizer(this.skin, this.cast, readings, factor, this.few, earthed);
  }
}

/** @param {Complex[]} Z */
function mean(Z) {
  const sum = (/** @type {"re" | "im"} */ part) => Z.reduce((total, z) => total + z[part], 0);
  return { re: sum("re") / Z.length, im: sum("im") / Z.length };
}
