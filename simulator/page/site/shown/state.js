// Settings and touches, kept in the page's address so that a link shows the same.

import { readAt } from "rcskin/skin";

/** @typedef {import("rcskin/skin").Touch} Touch */
/**
 * top, bottom: factors on each sheet's resistance. together: true if both change at once. capacitance, noise: factors. loss: tangent. factor: that of the usual press. strength: that of the
 * next touch. drive: displayed interface. at: number of the displayed frequency. drives, frequencies: those that
 * are read. seed: that of the meter's errors, 0 for a meter without errors. earthed: true if fingers touch.
 * @typedef {{top: number, bottom: number, together: boolean, capacitance: number, loss: number, noise: number, factor: number, strength: number,
 *   drive: number, at: number, seed: number, whole: boolean, arrows: boolean, running: boolean, earthed: boolean,
 *   drives: number[], frequencies: number[], touches: Touch[]}} State
 */

/** @param {any} data of the page @returns {State} */
export function initial(data) {
  const factor = data.press.capacitance_factor;
  return {
    top: 1,
    bottom: 1,
    together: true,
    capacitance: 1,
    loss: data.foam.loss_tangent,
    noise: 1,
    factor,
    strength: Math.min(factor, 1 + data.range.rise[1]),
    drive: 0,
    at: Math.floor(data.frequencies.length / 2),
    seed: 1,
    whole: true,
    arrows: true,
    running: false,
    earthed: data.finger?.earthed ?? false,
    drives: data.interfaces.map((/** @type {any} */ _, /** @type {number} */ k) => k),
    frequencies: data.frequencies.map((/** @type {any} */ _, /** @type {number} */ k) => k),
    touches: [],
  };
}

/** Differences from the initial state, as a part of an address. @param {State} state @param {State} first */
export function written(state, first) {
  const parts = new URLSearchParams();
  for (const [name, value] of Object.entries(state)) {
    const text = JSON.stringify(value);
    if (name !== "running" && text !== JSON.stringify(first[/** @type {keyof State} */ (name)]))
      parts.set(name, text);
  }
  return parts.toString();
}

/** State of an address; values of a wrong kind keep their initial value. @param {string} text @param {State} first @param {any} data @returns {State} */
export function read(text, first, data) {
  const state = structuredClone(first);
  for (const [name, written] of new URLSearchParams(text)) {
    if (!(name in first)) continue;
    try {
      const value = JSON.parse(written);
      if (fits(name, value, first, data)) Object.assign(state, { [name]: value });
    } catch {
      // The address was cut or mistyped: its other parts still count.
    }
  }
  const { drives, frequencies } = reads(state, data) ? state : first;
  const bottom = near(state.bottom, state.top, data);
  return structuredClone({ ...state, drives, frequencies, bottom });
}

/** True if any interface is read at any frequency. @param {Pick<State, "drives" | "frequencies">} state @param {any} data */
export function reads({ drives, frequencies }, data) {
  return drives.some((drive) => readAt(data, drive, frequencies).length > 0);
}

/** Factor of a sheet, limited to the range around the other's that the model covers. @param {number} factor @param {number} other @param {any} data */
export function near(factor, other, data) {
  const { apart } = data.range;
  return Math.min(Math.max(factor, other / apart), other * apart);
}

/** @param {string} name @param {any} value @param {State} first @param {any} data */
function fits(name, value, first, data) {
  const counted = (/** @type {any} */ list, /** @type {number} */ count) =>
    Array.isArray(list) &&
    list.length > 0 &&
    list.every((k) => Number.isInteger(k) && k >= 0 && k < count);
  if (name === "drives") return counted(value, data.interfaces.length);
  if (name === "frequencies") return counted(value, data.frequencies.length);
  if (name === "drive") return counted([value], data.interfaces.length);
  if (name === "at") return counted([value], data.frequencies.length);
  if (name === "touches") return Array.isArray(value) && value.length <= 2 && value.every(isTouch);
  if (name === "top" || name === "bottom" || name === "capacitance") {
    const [low, high] = data.range[name === "capacitance" ? name : "resistance"];
    return typeof value === "number" && value >= low && value <= high;
  }
  return (
    typeof value === typeof first[/** @type {keyof State} */ (name)] &&
    (typeof value !== "number" || Number.isFinite(value))
  );
}

/** @param {any} touch */
function isTouch(touch) {
  return (
    touch &&
    Number.isFinite(touch.finger ?? 0) &&
    ["x", "y", "width", "height", "factor"].every((name) => Number.isFinite(touch[name]))
  );
}
