// Lines on the skin from above: its outline, pixels, foils, touches, and arrows.

import { line } from "rcskin/charts";
import { rectangle } from "rcskin/outline";

/** @typedef {import("rcskin/field").Plan} Plan */
/** @typedef {import("rcskin/outline").Outline} Outline */
/** @typedef {import("rcskin/outline").Ring} Ring */
/** @typedef {import("rcskin/skin").Touch} Touch */

const BETWEEN = "rgb(255 255 255 / 0.55)";

/** Closed lines as a path of the canvas. @param {Plan} plan @param {Ring[]} rings */
export function traced(plan, rings) {
  const path = new Path2D();
  for (const ring of rings) {
    for (const [k, place] of ring.entries()) {
      if (k) path.lineTo(...plan.seen(...place));
      else path.moveTo(...plan.seen(...place));
    }
    path.closePath();
  }
  return path;
}

/** Draws the lines between pixels, and the numbers of rows and columns. @param {CanvasRenderingContext2D} context @param {Plan} plan @param {Outline} outline @param {CSSStyleDeclaration} style */
export function grid(context, plan, outline, style) {
  const whole = traced(plan, outline.rings);
  context.save();
  context.clip(whole, "evenodd");
  context.strokeStyle = BETWEEN;
  context.lineWidth = 1;
  for (const { row, column } of outline.held)
    context.stroke(traced(plan, outline.around(row, column)));
  context.restore();
  context.strokeStyle = style.getPropertyValue("--soft");
  context.lineWidth = 1;
  context.stroke(whole);
  context.fillStyle = style.getPropertyValue("--ink");
  context.font = `12px ${style.fontFamily}`;
  context.textAlign = "center";
  if (outline.groups) return named(context, plan, outline);
  const { rows, columns } = outline.pixels;
  for (let column = 1; column <= columns; column++) {
    const { x } = outline.box(1, column);
    context.fillText(`${column}`, plan.seen(x, 0)[0], plan.seen(0, 0)[1] + 26);
  }
  for (let row = 1; row <= rows; row++) {
    const { y } = outline.box(row, 1);
    context.fillText(`${row}`, plan.seen(0, 0)[0] - 22, plan.seen(0, y)[1] + 4);
  }
}

/** Writes row and column in each pixel, if pixels are no grid. @param {CanvasRenderingContext2D} context @param {Plan} plan @param {Outline} outline */
function named(context, plan, outline) {
  context.lineWidth = 3;
  for (const { row, column } of outline.held) {
    const [right, down] = plan.seen(...outline.middle(row, column));
    context.strokeStyle = "#000";
    context.strokeText(`${row},${column}`, right, down - 8);
    context.fillStyle = "#fff";
    context.fillText(`${row},${column}`, right, down - 8);
  }
}

/** Draws foils outside the skin's edge, those of the top sheet inside those of the bottom sheet. @param {CanvasRenderingContext2D} context @param {Plan} plan @param {any[]} foils @param {string[]} driven names @param {CSSStyleDeclaration} style */
export function foils(context, plan, foils, driven, style) {
  context.lineCap = "round";
  for (const { name, electrode, pieces } of foils) {
    const off = electrode === "top" ? 4 : 10;
    const colour = style.getPropertyValue(driven.includes(name) ? `--${electrode}` : "--grid");
    for (const [ax, ay, bx, by, right, up] of pieces) {
      const ends = [plan.seen(ax, ay), plan.seen(bx, by)];
      const beside = ends.map(([x, y]) => [x + off * right, y - off * up]);
      line(context, beside, colour, 5, []);
    }
  }
  context.lineCap = "butt";
}

/** Outlines the skin that a touch covers. @param {CanvasRenderingContext2D} context @param {Plan} plan @param {Outline} outline @param {Touch} touch @param {string} inner @param {string} outer @param {number} width */
export function frame(context, plan, outline, touch, inner, outer, width) {
  const { x, y, row, column } = touch;
  const rings =
    outline.groups && row && column
      ? outline.around(row, column)
      : [rectangle(x, y, touch.width, touch.height)];
  const path = traced(plan, rings);
  for (const [colour, extra] of /** @type {[string, number][]} */ ([
    [outer, 2],
    [inner, 0],
  ])) {
    context.strokeStyle = colour;
    context.lineWidth = width + extra;
    context.stroke(path);
  }
}

/** @param {CanvasRenderingContext2D} context @param {[number, number]} from @param {[number, number]} to */
export function arrow(context, from, to) {
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
