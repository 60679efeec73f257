// Mark of a located touch: a cross, and the ellipse of two standard deviations.

import { line } from "rcskin/charts";
import { Plan } from "rcskin/field";

const CROSS = 7;

/** @param {HTMLCanvasElement} canvas @param {any} data of the page @param {[number, number]} position mm @param {[number, number] | null} deviation mm */
export function drawPlace(canvas, data, position, deviation) {
  const context = canvas.getContext("2d");
  if (!context) return;
  const plan = new Plan(data.skin, canvas);
  const [right, down] = plan.seen(position[0] / 1e3, position[1] / 1e3);
  for (const [colour, width] of /** @type {[string, number][]} */ ([
    ["#000", 5],
    ["#fff", 2.5],
  ])) {
    line(
      context,
      [
        [right - CROSS, down],
        [right + CROSS, down],
      ],
      colour,
      width,
      [],
    );
    line(
      context,
      [
        [right, down - CROSS],
        [right, down + CROSS],
      ],
      colour,
      width,
      [],
    );
    if (!deviation) continue;
    const [across, up] = deviation.map((each) => (2 * plan.scale * each) / 1e3);
    context.beginPath();
    context.ellipse(right, down, across, up, 0, 0, 2 * Math.PI);
    Object.assign(context, { strokeStyle: colour, lineWidth: width });
    context.stroke();
  }
}
