// Parser of a press as rcskin's commands write it.

import { pressText } from "rcskin/takeaway";

/** @typedef {import("rcskin/skin").Touch} Touch */

const MOST = 2; // largest number of touches of a page
const PIXEL = /^(\d+),(\d+)(?::([\d.]+))?(?::([\d.e-]+)F)?$/;
const RECTANGLE = /^rect\(([^()]*)\)(?::([\d.]+))?(?::([\d.e-]+)F)?$/;

/** Touches of a press; null if a page cannot have them. @param {string} text @param {import("rcskin/skin").Skin} skin @returns {Touch[] | null} */
export function parsed(text, skin) {
  if (text === "none") return [];
  const touches = text.split("+").map((each) => touch(each, skin));
  return touches.length <= MOST && touches.every((each) => each !== null) ? touches : null;
}

/** Touches as text that names rods too; without that name the scene's finger would press. @param {Touch[]} touches @param {any} data of the page */
export function unmistakable(touches, data) {
  if (!data.finger) return pressText(touches);
  const named = (/** @type {Touch} */ each) => pressText([each]) + (each.finger ? "" : ":rod");
  return touches.map(named).join("+") || "none";
}

/** @param {string} text @param {import("rcskin/skin").Skin} skin @returns {Touch | null} */
function touch(text, skin) {
  const { press, range } = skin.data;
  const factor = (/** @type {string | undefined} */ written) =>
    written === undefined ? press.capacitance_factor : Number(written);
  const pixel = PIXEL.exec(text);
  const rectangle = RECTANGLE.exec(text);
  const strength = factor((pixel ?? [])[3] ?? (rectangle ?? [])[2]);
  const capacitance = (pixel ?? [])[4] ?? (rectangle ?? [])[3];
  const finger = skin.data.finger ? { finger: Number(capacitance ?? 0) } : {};
  if (!(strength > 0 && strength <= 1 + range.rise[1])) return null;
  if (pixel) {
    const [row, column] = [Number(pixel[1]), Number(pixel[2])];
    const there = skin.outline.holds(row, column);
    return there ? { ...skin.pixel(row, column, strength), ...finger } : null;
  }
  if (!rectangle) return null;
  const sides = rectangle[1].split(",").map(Number);
  if (sides.length !== 4 || !sides.every(Number.isFinite)) return null;
  const [x, y, width, height] = sides;
  return { x, y, width, height, factor: strength, ...finger };
}
