// Meter: its errors drawn from a seed, and the digits that it displays.

/** @typedef {import("rcskin/model").Complex} Complex */

/** Generator of uniform numbers from a seed, by mulberry32. @param {number} seed */
function uniform(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(state ^ (state >>> 15), 1 | state);
    mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** Generator of normal numbers from a seed, by Box and Muller. @param {number} seed */
export function normal(seed) {
  const draw = uniform(seed);
  return () => Math.sqrt(-2 * Math.log(1 - draw())) * Math.cos(2 * Math.PI * draw());
}

/** Value as a meter displays it. @param {number} value @param {number} digits */
export function displayed(value, digits) {
  return value === 0 ? 0 : Number(value.toPrecision(digits));
}

export class Meter {
  /** @param {any} readout as a scene has it @param {number} noise factor on all its errors @param {number} seed @param {number} interfaces */
  constructor(readout, noise, seed, interfaces) {
    this.draw = normal(seed);
    this.magnitude = noise * readout.magnitude_noise;
    this.phase = noise * readout.phase_noise;
    this.digits = readout.display_digits;
    this.session = Array.from({ length: interfaces }, () => ({
      gain: 1 + noise * readout.magnitude_accuracy * this.draw(),
      turn: noise * readout.phase_accuracy * this.draw(),
    }));
  }

  /** One reading of Z, ohm. @param {Complex} Z @param {number} drive @returns {Complex} */
  read(Z, drive) {
    const { gain, turn } = this.session[drive];
    const size = gain * (1 + this.magnitude * this.draw());
    const angle = turn + this.phase * this.draw();
    const [cos, sin] = [size * Math.cos(angle), size * Math.sin(angle)];
    return { re: Z.re * cos - Z.im * sin, im: Z.re * sin + Z.im * cos };
  }
}

/** Observations ln |Z / ohm| and phase in rad of all readings, one reading after the other. @param {Complex[]} Z */
export function observed(Z) {
  const seen = new Float64Array(2 * Z.length);
  Z.forEach((each, k) => {
    seen[2 * k] = Math.log(Math.hypot(each.re, each.im));
    seen[2 * k + 1] = Math.atan2(each.im, each.re);
  });
  return seen;
}
