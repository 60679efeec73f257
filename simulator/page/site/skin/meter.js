// The meter: its errors drawn from a seed, what it displays, and how far readings may be trusted.

/** @typedef {import("rcskin/model").Complex} Complex */

/** Uniform numbers from a seed, as mulberry32 draws them. @param {number} seed */
function uniform(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(state ^ (state >>> 15), 1 | state);
    mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** Normal numbers from a seed, as Box and Muller make them. @param {number} seed */
export function normal(seed) {
  const draw = uniform(seed);
  return () => Math.sqrt(-2 * Math.log(1 - draw())) * Math.cos(2 * Math.PI * draw());
}

/** A value as a meter shows it. @param {number} value @param {number} digits */
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

  /** One reading of Z in ohm. @param {Complex} Z @param {number} drive @returns {Complex} */
  read(Z, drive) {
    const { gain, turn } = this.session[drive];
    const size = gain * (1 + this.magnitude * this.draw());
    const angle = turn + this.phase * this.draw();
    const [cos, sin] = [size * Math.cos(angle), size * Math.sin(angle)];
    return { re: Z.re * cos - Z.im * sin, im: Z.re * sin + Z.im * cos };
  }
}

/** ln |Z / ohm| and the phase in rad of all readings, one after the other. @param {Complex[]} Z */
export function observed(Z) {
  const seen = new Float64Array(2 * Z.length);
  Z.forEach((each, k) => {
    seen[2 * k] = Math.log(Math.hypot(each.re, each.im));
    seen[2 * k + 1] = Math.atan2(each.im, each.re);
  });
  return seen;
}
