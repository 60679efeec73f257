// The skin from above: a field in colours, current in arrows, pixels, foils and touches.

import { line, prepared } from "rcskin/charts";
import { css, diverging, ink, sequential } from "rcskin/colours";

/** @typedef {{re: Float64Array, im: Float64Array}} Phasor */
/** @typedef {import("rcskin/skin").Touch} Touch */

const MARGIN = 34;
const TALLEST = 0.62; // of the window
const ARROWS = 11; // along the longer side

/** Where the skin lies on a canvas: m to pixels of the screen and back. */
export class Plan {
  /** @param {{length: number, width: number}} skin @param {HTMLCanvasElement} canvas */
  constructor(skin, canvas) {
    const { width, height } = canvas.getBoundingClientRect();
    this.scale = Math.min((width - 2 * MARGIN) / skin.length, (height - 2 * MARGIN) / skin.width);
    this.left = (width - this.scale * skin.length) / 2;
    this.bottom = (height + this.scale * skin.width) / 2;
  }

  /** @param {number} x @param {number} y @returns {[number, number]} */
  seen(x, y) {
    return [this.left + this.scale * x, this.bottom - this.scale * y];
  }

  /** @param {number} right @param {number} down @returns {[number, number]} */
  onSkin(right, down) {
    return [(right - this.left) / this.scale, (this.bottom - down) / this.scale];
  }
}

/** Gives a canvas the height that a skin needs on it. @param {HTMLCanvasElement} canvas @param {{length: number, width: number}} skin */
export function fit(canvas, skin) {
  const across = canvas.getBoundingClientRect().width - 2 * MARGIN;
  const tall = Math.min((across * skin.width) / skin.length, TALLEST * window.innerHeight);
  canvas.style.height = `${Math.round(tall + 2 * MARGIN)}px`;
}

/**
 * @param {HTMLCanvasElement} canvas @param {any} data of the page @param {{across: Phasor, top: Phasor}} field
 * @param {{phase: number | null, arrows: boolean, touches: Touch[], cursor: Touch | null, driven: string[]}} shown
 * @returns {{least: number, most: number}} of the difference of potential, V
 */
export function drawSkin(canvas, data, field, shown) {
  const context = prepared(canvas);
  const sizes = field.across.re.map((re, k) => Math.hypot(re, field.across.im[k]));
  const scale = { least: Math.min(...sizes), most: Math.max(...sizes) };
  if (!context) return scale;
  const plan = new Plan(data.skin, canvas);
  const style = getComputedStyle(canvas);
  paint(context, plan, data, field.across, scale, shown.phase);
  if (shown.arrows) arrows(context, plan, data, field.top, shown.phase ?? 0);
  grid(context, plan, data, style);
  for (const foil of data.foils) {
    const [away, down] = beside(data.skin, foil);
    const points = foil.path.map((/** @type {[number, number]} */ place) => {
      const [right, below] = plan.seen(...place);
      return [right + away, below + down];
    });
    const colour = style.getPropertyValue(
      shown.driven.includes(foil.name) ? `--${foil.electrode}` : "--grid",
    );
    line(context, points, colour, 5, []);
  }
  for (const touch of shown.touches) frame(context, plan, touch, "#fff", "#000", 3);
  if (shown.cursor)
    frame(context, plan, shown.cursor, style.getPropertyValue("--mark"), "transparent", 2);
  return scale;
}

/** @param {CanvasRenderingContext2D} context @param {Plan} plan @param {any} data @param {Phasor} across @param {{least: number, most: number}} scale @param {number | null} phase */
function paint(context, plan, data, across, { least, most }, phase) {
  const { rows, columns } = data.raster;
  const picture = new ImageData(columns, rows);
  const [cos, sin] = phase === null ? [1, 0] : [Math.cos(phase), Math.sin(phase)];
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const point = row * columns + column;
      const [re, im] = [across.re[point], across.im[point]];
      const colour =
        phase === null
          ? sequential((Math.hypot(re, im) - least) / (most - least || 1))
          : diverging(0.5 + (re * cos - im * sin) / most / 2);
      picture.data.set([...colour, 255], 4 * ((rows - 1 - row) * columns + column));
    }
  }
  const small = new OffscreenCanvas(columns, rows);
  small.getContext("2d")?.putImageData(picture, 0, 0);
  const [left, top] = plan.seen(0, data.skin.width);
  context.drawImage(small, left, top, plan.scale * data.skin.length, plan.scale * data.skin.width);
}

/** The current in the top sheet at one moment, falling with its potential. @param {CanvasRenderingContext2D} context @param {Plan} plan @param {any} data @param {Phasor} top @param {number} phase */
function arrows(context, plan, data, top, phase) {
  const { rows, columns } = data.raster;
  const { length, width } = data.skin;
  const [cos, sin] = [Math.cos(phase), Math.sin(phase)];
  const value = (/** @type {number} */ i, /** @type {number} */ j) =>
    top.re[i * columns + j] * cos - top.im[i * columns + j] * sin;
  const apart = Math.max(length, width) / ARROWS;
  const found = [];
  for (let y = apart / 2; y < width; y += apart) {
    for (let x = apart / 2; x < length; x += apart) {
      const i = Math.min(Math.max(Math.round((y / width) * rows - 0.5), 1), rows - 2);
      const j = Math.min(Math.max(Math.round((x / length) * columns - 0.5), 1), columns - 2);
      const along = -((value(i, j + 1) - value(i, j - 1)) * columns) / (2 * length);
      const up = -((value(i + 1, j) - value(i - 1, j)) * rows) / (2 * width);
      found.push({ x, y, along, up, size: Math.hypot(along, up) });
    }
  }
  const most = Math.max(...found.map((each) => each.size), 1e-300);
  for (const { x, y, along, up, size } of found) {
    const long = apart * 0.85 * Math.sqrt(size / most);
    if (plan.scale * long < 3) continue;
    arrow(
      context,
      plan.seen(x - (long / 2) * (along / size), y - (long / 2) * (up / size)),
      plan.seen(x + (long / 2) * (along / size), y + (long / 2) * (up / size)),
    );
  }
}

/** @param {CanvasRenderingContext2D} context @param {[number, number]} from @param {[number, number]} to */
function arrow(context, from, to) {
  const angle = Math.atan2(to[1] - from[1], to[0] - from[0]);
  const head = Math.min(6, Math.hypot(to[0] - from[0], to[1] - from[1]) / 2);
  const wing = (/** @type {number} */ turn) => [
    to[0] - head * Math.cos(angle + turn),
    to[1] - head * Math.sin(angle + turn),
  ];
  for (const [colour, width] of /** @type {[string, number][]} */ ([
    ["#000", 3.2],
    ["#fff", 1.6],
  ])) {
    line(context, [from, to, wing(0.5), to, wing(-0.5)], colour, width, []);
  }
}

/** @param {CanvasRenderingContext2D} context @param {Plan} plan @param {any} data @param {CSSStyleDeclaration} style */
function grid(context, plan, data, style) {
  const { rows, columns } = data.pixels;
  const { length, width } = data.skin;
  context.fillStyle = style.getPropertyValue("--ink");
  context.font = `12px ${style.fontFamily}`;
  context.textAlign = "center";
  for (let column = 0; column <= columns; column++) {
    const x = (column * length) / columns;
    line(context, [plan.seen(x, 0), plan.seen(x, width)], "rgb(255 255 255 / 0.55)", 1, []);
    if (column < columns)
      context.fillText(
        `${column + 1}`,
        plan.seen(x + length / columns / 2, 0)[0],
        plan.seen(0, 0)[1] + 26,
      );
  }
  for (let row = 0; row <= rows; row++) {
    const y = (row * width) / rows;
    line(context, [plan.seen(0, y), plan.seen(length, y)], "rgb(255 255 255 / 0.55)", 1, []);
    if (row < rows)
      context.fillText(
        `${row + 1}`,
        plan.seen(0, 0)[0] - 22,
        plan.seen(0, y + width / rows / 2)[1] + 4,
      );
  }
}

/** Foils are drawn beside the skin, the top sheet's within the bottom sheet's. @param {{length: number, width: number}} skin @param {any} foil */
function beside({ length, width }, foil) {
  const [x, y] = [0, 1].map(
    (axis) => (foil.path[0][axis] + foil.path[foil.path.length - 1][axis]) / 2,
  );
  const away = foil.electrode === "top" ? 4 : 10;
  const on = (/** @type {number} */ place, /** @type {number} */ side) =>
    Number(place > side * (1 - 1e-9)) - Number(place < 1e-9 * side);
  return [away * on(x, length), -away * on(y, width)];
}

/** @param {CanvasRenderingContext2D} context @param {Plan} plan @param {Touch} touch @param {string} inner @param {string} outer @param {number} width */
function frame(context, plan, touch, inner, outer, width) {
  const [left, top] = plan.seen(touch.x - touch.width / 2, touch.y + touch.height / 2);
  for (const [colour, extra] of /** @type {[string, number][]} */ ([
    [outer, 2],
    [inner, 0],
  ])) {
    context.strokeStyle = colour;
    context.lineWidth = width + extra;
    context.strokeRect(left, top, plan.scale * touch.width, plan.scale * touch.height);
  }
}

/** Where the localizer believes a touch, pixel by pixel. @param {HTMLCanvasElement} canvas @param {any} data @param {{row: number, column: number}[]} classes @param {Float64Array} chances */
export function drawBelief(canvas, data, classes, chances) {
  const context = prepared(canvas);
  if (!context) return;
  const plan = new Plan(data.skin, canvas);
  const style = getComputedStyle(canvas);
  const { rows, columns } = data.pixels;
  const [width, height] = [data.skin.length / columns, data.skin.width / rows];
  context.font = `13px ${style.fontFamily}`;
  context.textAlign = "center";
  classes.forEach(({ row, column }, k) => {
    if (row === 0) return;
    const colour = sequential(chances[k]);
    const [left, top] = plan.seen((column - 1) * width, row * height);
    context.fillStyle = css(colour);
    context.fillRect(left, top, plan.scale * width - 1, plan.scale * height - 1);
    if (chances[k] < 0.005) return;
    context.fillStyle = ink(colour);
    context.fillText(
      `${Math.round(100 * chances[k])} %`,
      left + (plan.scale * width) / 2,
      top + (plan.scale * height) / 2 + 5,
    );
  });
  grid(context, plan, data, style);
}
