// Admittances of excitations and interfaces at any s, from Lanczos' method.

/** @typedef {{re: number, im: number}} Complex */
/** Response of an interface. @typedef {{admittance: (s: Complex) => Complex}} Shown */

/**
 * Admittance of an excitation under one press at any s: Y = G + s C - s² b0² / (1 + s a1 - s² b1² / (1 + ...)).
 */
export class Response {
  /**
   * @param {number} conductance S
   * @param {number} capacitance F
   * @param {number[]} diagonal a1, a2, ...
   * @param {number[]} squared b0², b1², ...
   */
  constructor(conductance, capacitance, diagonal, squared) {
    this.conductance = conductance;
    this.capacitance = capacitance;
    this.diagonal = diagonal;
    this.squared = squared;
  }

  /** Y in S. @param {Complex} s rad/s @returns {Complex} */
  admittance(s) {
    let re = 0;
    let im = 0;
    const s2re = s.re * s.re - s.im * s.im;
    const s2im = 2 * s.re * s.im;
    const { diagonal, squared } = this;
    for (let k = diagonal.length - 1; k >= 0; k--) {
      const next = k + 1 < diagonal.length ? squared[k + 1] : 0;
      const nre = 1 + s.re * diagonal[k] - next * (s2re * re - s2im * im);
      const nim = s.im * diagonal[k] - next * (s2re * im + s2im * re);
      const size = nre * nre + nim * nim;
      re = nre / size;
      im = -nim / size;
    }
    const first = diagonal.length ? squared[0] : 0;
    return {
      re: this.conductance + s.re * this.capacitance - first * (s2re * re - s2im * im),
      im: s.im * this.capacitance - first * (s2re * im + s2im * re),
    };
  }
}

/** Weighted sum of the forms of several excitations, for an interface whose low terminal is a virtual earth. */
export class Sum {
  /** @param {[number, Response][]} parts weight and form */
  constructor(parts) {
    this.parts = parts;
  }

  /** Y in S. @param {Complex} s rad/s @returns {Complex} */
  admittance(s) {
    const sum = { re: 0, im: 0 };
    for (const [weight, form] of this.parts) {
      const Y = form.admittance(s);
      sum.re += weight * Y.re;
      sum.im += weight * Y.im;
    }
    return sum;
  }
}
