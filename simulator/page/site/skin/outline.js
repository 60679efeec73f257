// Geometry of the skin: its outline, and the pixels that contain a part of it.

/** @typedef {[number, number][]} Ring closed, in m */

export class Outline {
  /** @param {any} data of the page */
  constructor(data) {
    const { plan, skin, pixels } = data;
    this.skin = skin;
    this.pixels = pixels;
    /** @type {Ring[]} */
    this.rings = plan.outline;
    /** Closed lines around each pixel, if pixels are no grid. @type {Ring[][] | null} */
    this.groups = plan.groups;
    /** Middle of the skin in each pixel. @type {[number, number][]} */
    this.middles = plan.middles;
    /** Pixels that have any skin. @type {{row: number, column: number}[]} */
    this.held = plan.held.map((/** @type {number} */ k) => ({
      row: Math.floor(k / pixels.columns) + 1,
      column: (k % pixels.columns) + 1,
    }));
  }

  /** @param {number} row @param {number} column */
  holds(row, column) {
    return this.held.some((each) => each.row === row && each.column === column);
  }

  /** Middle and size of a pixel, m. @param {number} row @param {number} column */
  box(row, column) {
    const [width, height] = [
      this.skin.length / this.pixels.columns,
      this.skin.width / this.pixels.rows,
    ];
    if (this.groups) {
      const [x, y] = this.middle(row, column);
      return { x, y, width, height };
    }
    return { x: (column - 0.5) * width, y: (row - 0.5) * height, width, height };
  }

  /** Middle of the skin in a pixel. @param {number} row @param {number} column */
  middle(row, column) {
    return this.middles[(row - 1) * this.pixels.columns + column - 1];
  }

  /** Lines around a pixel. @param {number} row @param {number} column @returns {Ring[]} */
  around(row, column) {
    if (this.groups) return this.groups[(row - 1) * this.pixels.columns + column - 1];
    const { x, y, width, height } = this.box(row, column);
    return [rectangle(x, y, width, height)];
  }

  /** True if there is skin. @param {number} x @param {number} y */
  has(x, y) {
    return within(this.rings, x, y);
  }

  /** Pixel at a place on the skin. @param {number} x @param {number} y */
  pixelAt(x, y) {
    if (!this.has(x, y)) return null;
    if (this.groups)
      return this.held.find((each) => within(this.around(each.row, each.column), x, y)) ?? null;
    const { rows, columns } = this.pixels;
    const row = Math.min(Math.floor((y / this.skin.width) * rows), rows - 1) + 1;
    const column = Math.min(Math.floor((x / this.skin.length) * columns), columns - 1) + 1;
    return this.holds(row, column) ? { row, column } : null;
  }

  /** Next pixel with skin in a direction; the given pixel if there is none. @param {{row: number, column: number} | null} from @param {number} up @param {number} right */
  next(from, up, right) {
    if (!from) return this.held[0];
    const { rows, columns } = this.pixels;
    for (let step = 1; step <= Math.max(rows, columns); step++) {
      const [row, column] = [from.row + step * up, from.column + step * right];
      if (this.holds(row, column)) return { row, column };
    }
    return from;
  }
}

/** @param {number} x of its middle @param {number} y @param {number} width @param {number} height @returns {Ring} */
export function rectangle(x, y, width, height) {
  const [left, right, low, high] = [x - width / 2, x + width / 2, y - height / 2, y + height / 2];
  return [
    [left, low],
    [right, low],
    [right, high],
    [left, high],
  ];
}

/** True if an odd number of lines lies to the right. Places on the outer edges count as inside. @param {Ring[]} rings @param {number} x @param {number} y */
function within(rings, x, y) {
  let odd = false;
  for (const ring of rings) {
    let [ax, ay] = ring[ring.length - 1];
    for (const [bx, by] of ring) {
      if (ay > y !== by > y && x <= ax + ((y - ay) / (by - ay)) * (bx - ax)) odd = !odd;
      [ax, ay] = [bx, by];
    }
  }
  return odd;
}
