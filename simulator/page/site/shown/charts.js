// Curves over frequency, on a logarithmic axis, drawn on a canvas.

/** @typedef {{values: number[], kind: "rest" | "last" | "now", low?: number[], high?: number[]}} Curve */

const ROOM = { left: 56, right: 26, top: 22, bottom: 30 };

/** Round numbers for ticks, about `count` of them from low to high. @param {number} low @param {number} high @param {number} count */
function round(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((n) => n * power).find((each) => each >= rough) ?? power;
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high * (1 + 1e-12); k++) found.push(k * step);
  return { values: found, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

/** Number with its unit and the unit's prefix. @param {number} value @param {string} unit */
export function withPrefix(value, unit) {
  if (value === 0) return `0 ${unit}`;
  const rounded = Math.abs(Number(value.toPrecision(3)));
  const power = Math.max(-5, Math.min(3, Math.floor(Math.log10(rounded) / 3 + 1e-9)));
  const prefix =
    { "-5": "f", "-4": "p", "-3": "n", "-2": "µ", "-1": "m", 0: "", 1: "k", 2: "M", 3: "G" }[
      power
    ] ?? "";
  return `${Number((value / 1000 ** power).toPrecision(3))} ${prefix}${unit}`;
}

export class Chart {
  /** @param {HTMLCanvasElement} canvas @param {string} title @param {string} unit @param {number} scale by which values are shown @param {boolean} logarithmic */
  constructor(canvas, title, unit, scale, logarithmic) {
    this.canvas = canvas;
    this.title = title;
    this.unit = unit;
    this.scale = scale;
    this.logarithmic = logarithmic;
  }

  /** @param {number[]} frequencies Hz @param {Curve[]} curves @param {number} [marked] Hz */
  draw(frequencies, curves, marked) {
    const context = prepared(this.canvas);
    if (!context) return;
    const { width, height } = this.canvas.getBoundingClientRect();
    const style = getComputedStyle(this.canvas);
    const shown = (/** @type {number} */ value) =>
      this.logarithmic ? Math.log10(this.scale * value) : this.scale * value;
    const [low, high] = bounds(curves, shown, this.logarithmic);
    const first = Math.log10(frequencies[0]);
    const decades = Math.log10(frequencies[frequencies.length - 1]) - first || 1;
    const x = (/** @type {number} */ f) =>
      ROOM.left + ((Math.log10(f) - first) / decades) * (width - ROOM.left - ROOM.right);
    const y = (/** @type {number} */ v) =>
      height - ROOM.bottom - ((v - low) / (high - low)) * (height - ROOM.top - ROOM.bottom);
    context.font = `12px ${style.fontFamily}`;
    this.#axes(context, { frequencies, x, y, low, high, width, height, style });
    if (marked)
      line(
        context,
        [
          [x(marked), ROOM.top],
          [x(marked), height - ROOM.bottom],
        ],
        style.getPropertyValue("--mark"),
        1,
        [2, 3],
      );
    for (const curve of curves) {
      const colour = style.getPropertyValue(`--${curve.kind}`);
      const { low: lower, high: upper } = curve;
      if (lower && upper) {
        const ring = [
          ...frequencies.map((f, k) => [x(f), y(shown(upper[k]))]),
          ...frequencies.map((f, k) => [x(f), y(shown(lower[k]))]).reverse(),
        ];
        area(context, ring, style.getPropertyValue("--band"));
      }
      const dash = { rest: [], last: [6, 4], now: [] }[curve.kind];
      const points = frequencies.map((f, k) => [x(f), y(shown(curve.values[k]))]);
      line(context, points, colour, curve.kind === "now" ? 2.5 : 1.5, dash);
      if (curve.kind === "now") for (const [a, b] of points) dot(context, a, b, colour);
    }
  }

  /** @param {CanvasRenderingContext2D} context @param {{frequencies: number[], x: (f: number) => number, y: (v: number) => number, low: number, high: number, width: number, height: number, style: CSSStyleDeclaration}} at */
  #axes(context, at) {
    const { x, y, low, high, width, height, style } = at;
    const [text, grid] = [style.getPropertyValue("--ink"), style.getPropertyValue("--grid")];
    context.fillStyle = text;
    context.textAlign = "left";
    context.fillText(`${this.title} (${this.unit})`, 4, 14);
    context.textAlign = "right";
    const ticks = this.logarithmic ? decadeTicks(low, high) : round(low, high, 5);
    for (const value of ticks.values) {
      line(
        context,
        [
          [ROOM.left, y(value)],
          [width - ROOM.right, y(value)],
        ],
        grid,
        1,
        [],
      );
      const label = this.logarithmic
        ? Number((10 ** value).toPrecision(2)).toString()
        : value.toFixed(ticks.digits);
      context.fillText(label, ROOM.left - 5, y(value) + 4);
    }
    context.textAlign = "center";
    for (
      let decade = Math.ceil(Math.log10(at.frequencies[0]) - 1e-9);
      10 ** decade <= at.frequencies[at.frequencies.length - 1] * 1.001;
      decade++
    ) {
      line(
        context,
        [
          [x(10 ** decade), ROOM.top],
          [x(10 ** decade), height - ROOM.bottom],
        ],
        grid,
        1,
        [],
      );
      context.fillText(withPrefix(10 ** decade, "Hz"), x(10 ** decade), height - ROOM.bottom + 16);
    }
  }
}

/** Context of a cleared canvas with the resolution of the screen. @param {HTMLCanvasElement} canvas */
export function prepared(canvas) {
  const { width, height } = canvas.getBoundingClientRect();
  const ratio = window.devicePixelRatio || 1;
  const [across, down] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== across || canvas.height !== down)
    Object.assign(canvas, { width: across, height: down });
  const context = canvas.getContext("2d");
  context?.setTransform(ratio, 0, 0, ratio, 0, 0);
  context?.clearRect(0, 0, width, height);
  return context;
}

/** @param {Curve[]} curves @param {(value: number) => number} shown @param {boolean} logarithmic @returns {[number, number]} */
function bounds(curves, shown, logarithmic) {
  const all = curves
    .flatMap((curve) => [...curve.values, ...(curve.low ?? []), ...(curve.high ?? [])])
    .map(shown)
    .filter(Number.isFinite);
  const [low, high] = [Math.min(...all), Math.max(...all)];
  if (!all.length) return [0, 1];
  const least = logarithmic ? 0.2 : Math.max(1e-3 * Math.abs(high), 0.2);
  const room = Math.max(0.06 * (high - low), (least - (high - low)) / 2);
  return [low - room, high + room];
}

/** @param {number} low @param {number} high */
function decadeTicks(low, high) {
  const steps =
    high - low > 1.5 ? [1] : high - low > 0.7 ? [1, 2, 5] : [1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9];
  const values = [];
  for (let decade = Math.floor(low); decade <= high; decade++)
    for (const step of steps) values.push(decade + Math.log10(step));
  return { values: values.filter((value) => value >= low && value <= high), digits: 0 };
}

/** @param {CanvasRenderingContext2D} context @param {number[][]} points @param {string} colour @param {number} width @param {number[]} dash */
export function line(context, points, colour, width, dash) {
  trace(context, points);
  Object.assign(context, { strokeStyle: colour, lineWidth: width });
  context.setLineDash(dash);
  context.stroke();
  context.setLineDash([]);
}

/** @param {CanvasRenderingContext2D} context @param {number[][]} points */
function trace(context, points) {
  context.beginPath();
  for (const [x, y] of points) context.lineTo(x, y);
}

/** @param {CanvasRenderingContext2D} context @param {number[][]} ring @param {string} colour */
function area(context, ring, colour) {
  trace(context, ring);
  context.fillStyle = colour;
  context.fill();
}

/** @param {CanvasRenderingContext2D} context @param {number} x @param {number} y @param {string} colour */
function dot(context, x, y, colour) {
  context.beginPath();
  context.arc(x, y, 2.2, 0, 2 * Math.PI);
  context.fillStyle = colour;
  context.fill();
}
