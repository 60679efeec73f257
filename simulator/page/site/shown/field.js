// Skin from above: a field in colours, current in arrows, pixels, foils and touches.

import { unpacked } from "rcskin/arrays";
import { prepared } from "rcskin/charts";
import { css, diverging, ink, sequential } from "rcskin/colours";
import { arrow, foils, frame, grid, traced } from "rcskin/lines";

/** @typedef {{re: Float64Array, im: Float64Array}} Phasor */
/** @typedef {import("rcskin/skin").Touch} Touch */
/** @typedef {import("rcskin/skin").Skin} Skin */

const MARGIN = 34;
const TALLEST = 0.62; // largest height over the window's
const ARROWS = 11; // number along the longer side

/** Place of the skin on a canvas: converts m to pixels of the screen and back. */
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
 * @param {HTMLCanvasElement} canvas @param {Skin} skin @param {{across: Phasor, top: Phasor}} field
 * @param {{phase: number | null, arrows: boolean, touches: Touch[], cursor: Touch | null, driven: string[]}} shown
 * @returns {{least: number, most: number}} range of the difference of potential, V
 */
export function drawSkin(canvas, skin, field, shown) {
  const { data, outline } = skin;
  const context = prepared(canvas);
  const sizes = field.across.re.map((re, k) => Math.hypot(re, field.across.im[k]));
  const scale = { least: Math.min(...sizes), most: Math.max(...sizes) };
  if (!context) return scale;
  const plan = new Plan(data.skin, canvas);
  const style = getComputedStyle(canvas);
  context.save();
  context.clip(traced(plan, outline.rings), "evenodd");
  paint(context, plan, data, field.across, scale, shown.phase);
  if (shown.arrows) arrows(context, plan, data, field.top, shown.phase ?? 0);
  context.restore();
  grid(context, plan, outline, style);
  foils(context, plan, data.plan.foils, shown.driven, style);
  for (const touch of shown.touches) frame(context, plan, outline, touch, "#fff", "#000", 3);
  if (shown.cursor)
    frame(context, plan, outline, shown.cursor, style.getPropertyValue("--mark"), "transparent", 2);
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

/** Draws the current in the top sheet at one moment, from its conductance and potential gradient. @param {CanvasRenderingContext2D} context @param {Plan} plan @param {any} data @param {Phasor} top @param {number} phase */
function arrows(context, plan, data, top, phase) {
  const { rows, columns } = data.raster;
  const { length, width } = data.skin;
  const beside = new Set(data.raster.beside);
  const S = unpacked(data.raster.conductance);
  const points = rows * columns;
  const [cos, sin] = [Math.cos(phase), Math.sin(phase)];
  const fall = (
    /** @type {number} */ low,
    /** @type {number} */ high,
    /** @type {number} */ run,
  ) => {
    const value = (/** @type {number} */ k) => top.re[k] * cos - top.im[k] * sin;
    return (value(low) - value(high)) / run;
  };
  const apart = Math.max(length, width) / ARROWS;
  const found = [];
  for (let y = apart / 2; y < width; y += apart) {
    for (let x = apart / 2; x < length; x += apart) {
      const i = Math.min(Math.max(Math.round((y / width) * rows - 0.5), 1), rows - 2);
      const j = Math.min(Math.max(Math.round((x / length) * columns - 0.5), 1), columns - 2);
      const k = i * columns + j;
      if (beside.has(k)) continue;
      const [left, right] = [k - 1, k + 1].map((next) => (beside.has(next) ? k : next));
      const [below, above] = [k - columns, k + columns].map((next) =>
        beside.has(next) ? k : next,
      );
      const run = (length / columns) * (right - left || 1);
      const rise = (width / rows) * ((above - below) / columns || 1);
      const [ex, ey] = [fall(left, right, run), fall(below, above, rise)];
      const along = S[k] * ex + S[2 * points + k] * ey;
      const up = S[2 * points + k] * ex + S[points + k] * ey;
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

/** Draws the localizer's probability of each pixel. Pixels of a column or row that share a probability show it once, in their middle. @param {HTMLCanvasElement} canvas @param {Skin} skin @param {{row: number, column: number}[]} classes @param {Float64Array} chances @param {"column" | "row" | ""} shared */
export function drawBelief(canvas, skin, classes, chances, shared = "") {
  const context = prepared(canvas);
  if (!context) return;
  const { data, outline } = skin;
  const plan = new Plan(data.skin, canvas);
  const style = getComputedStyle(canvas);
  context.font = `13px ${style.fontFamily}`;
  context.textAlign = "center";
  context.save();
  context.clip(traced(plan, outline.rings), "evenodd");
  classes.forEach(({ row, column }, k) => {
    if (row === 0) return;
    context.fillStyle = css(sequential(chances[k]));
    context.fill(traced(plan, outline.around(row, column)), "evenodd");
  });
  context.restore();
  grid(context, plan, outline, style);
  classes.forEach((pixel, k) => {
    const { row, column } = pixel;
    if (row === 0 || chances[k] < 0.005) return;
    const same = shared ? classes.filter((each) => each[shared] === pixel[shared]) : [pixel];
    if (same[same.length >> 1] !== pixel) return;
    const [right, down] = plan.seen(...outline.middle(row, column));
    context.fillStyle = ink(sequential(chances[k]));
    context.fillText(`${Math.round(100 * chances[k])} %`, right, down + 5);
  });
}
