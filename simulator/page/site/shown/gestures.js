// Input of touches: mouse, pen and fingers on the skin, the wheel, and keys.

import { Plan } from "rcskin/field";

/** @typedef {import("rcskin/skin").Touch} Touch */

const KEYS = { ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] };
const MOST = 2; // largest number of touches at once
const STEP = 0.1; // of the capacitance factor

export class Gestures {
  /**
   * @param {HTMLCanvasElement} canvas @param {import("rcskin/skin").Skin} skin
   * @param {{whole: () => boolean, factor: () => number, strengthen: (by: number) => void, changed: (touches: Touch[]) => void}} of
   */
  constructor(canvas, skin, of) {
    this.canvas = canvas;
    this.skin = skin;
    this.of = of;
    /** @type {Map<number, Touch>} by pointer */
    this.held = new Map();
    /** @type {Touch[]} */
    this.touches = [];
    /** @type {{row: number, column: number} | null} */
    this.cursor = null;
    canvas.addEventListener("pointerdown", (event) => this.#press(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, (event) =>
        this.held.delete(/** @type {PointerEvent} */ (event).pointerId),
      );
    }
    canvas.addEventListener("wheel", (event) => this.#turn(event), { passive: false });
    canvas.addEventListener("keydown", (event) => this.#key(event));
    canvas.addEventListener("blur", () => this.#point(null));
  }

  /** @param {Touch[]} touches */
  set(touches) {
    this.touches = touches;
    this.of.changed(touches);
  }

  /** Outlined pixel that keys press. @returns {Touch | null} */
  get pointed() {
    return this.cursor && this.skin.pixel(this.cursor.row, this.cursor.column, 1);
  }

  /** @param {PointerEvent} event */
  #press(event) {
    const touch = this.#under(event);
    if (!touch) return;
    event.preventDefault();
    this.canvas.focus({ preventScroll: true });
    if (event.isTrusted) this.canvas.setPointerCapture(event.pointerId);
    const beside = this.held.size || event.shiftKey ? this.touches.slice(-(MOST - 1)) : [];
    this.#point(null);
    this.held.set(event.pointerId, touch);
    this.set([...beside.filter((other) => !same(other, touch)), touch]);
  }

  /** @param {PointerEvent} event */
  #move(event) {
    const before = this.held.get(event.pointerId);
    const touch = before && this.#under(event);
    if (!touch || same(touch, before)) return;
    this.held.set(event.pointerId, touch);
    this.set([...this.touches.filter((each) => !same(each, before) && !same(each, touch)), touch]);
  }

  /** @param {WheelEvent} event */
  #turn(event) {
    if (!this.touches.length) return;
    event.preventDefault();
    this.of.strengthen(event.deltaY < 0 ? STEP : -STEP);
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    const step = KEYS[/** @type {keyof typeof KEYS} */ (event.key)];
    if (step) {
      this.#point(this.skin.outline.next(this.cursor, step[0], step[1]));
    } else if (event.key === "+" || event.key === "=") this.of.strengthen(STEP);
    else if (event.key === "-") this.of.strengthen(-STEP);
    else if ((event.key === "Enter" || event.key === " ") && this.cursor)
      this.#pressPointed(event.shiftKey);
    else if (event.key === "Escape" || event.key === "Delete") this.set([]);
    else return;
    event.preventDefault();
  }

  /** Presses the outlined pixel, or releases it. @param {boolean} beside */
  #pressPointed(beside) {
    if (!this.cursor) return;
    const touch = this.skin.pixel(this.cursor.row, this.cursor.column, this.of.factor());
    const others = this.touches.filter((each) => !same(each, touch));
    if (others.length < this.touches.length) this.set(others);
    else this.set([...(beside ? others.slice(-(MOST - 1)) : []), touch]);
  }

  /** @param {{row: number, column: number} | null} cursor */
  #point(cursor) {
    if (this.cursor === cursor) return;
    this.cursor = cursor;
    this.of.changed(this.touches);
  }

  /** @param {PointerEvent} event @returns {Touch | null} */
  #under(event) {
    const { skin, pixels } = this.skin.data;
    const box = this.canvas.getBoundingClientRect();
    const [x, y] = new Plan(skin, this.canvas).onSkin(
      event.clientX - box.left,
      event.clientY - box.top,
    );
    if (this.of.whole()) {
      const pixel = this.skin.outline.pixelAt(x, y);
      return pixel && this.skin.pixel(pixel.row, pixel.column, this.of.factor());
    }
    if (!this.skin.outline.has(x, y)) return null;
    const [width, height] = [skin.length / pixels.columns, skin.width / pixels.rows];
    const within = (
      /** @type {number} */ at,
      /** @type {number} */ size,
      /** @type {number} */ side,
    ) => Number(Math.min(Math.max(at, size / 2), side - size / 2).toFixed(5));
    return {
      x: within(x, width, skin.length),
      y: within(y, height, skin.width),
      width,
      height,
      factor: this.of.factor(),
    };
  }
}

/** @param {Touch} a @param {Touch} b */
function same(a, b) {
  return a.x === b.x && a.y === b.y;
}
