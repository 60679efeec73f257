// Colours that colour-blind users can distinguish, too.

const VIRIDIS = [
  "#440154",
  "#482878",
  "#3e4989",
  "#31688e",
  "#26828e",
  "#1f9e89",
  "#35b779",
  "#6ece58",
  "#b5de2b",
  "#fde725",
];
const BLUE_TO_ORANGE = [
  "#1f4e8c",
  "#4f8fc0",
  "#b5d3e7",
  "#f4f4f2",
  "#f6c89a",
  "#e08a3c",
  "#9c4a0a",
];

/** @param {string[]} anchors @returns {(part: number) => [number, number, number]} */
function between(anchors) {
  const known = anchors.map((hex) =>
    [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16)),
  );
  return (part) => {
    const place = Math.min(Math.max(part, 0), 1) * (known.length - 1);
    const first = Math.min(Math.floor(place), known.length - 2);
    const mixed = known[first].map(
      (value, k) => value + (place - first) * (known[first + 1][k] - value),
    );
    return [mixed[0], mixed[1], mixed[2]];
  };
}

/** Colour of a fraction from 0 (little) to 1 (much). */
export const sequential = between(VIRIDIS);
/** Colour of a value from -1 over 0 to 1, given as a fraction from 0 to 1. */
export const diverging = between(BLUE_TO_ORANGE);
/** @param {[number, number, number]} colour */
export const css = (colour) => `rgb(${colour.map(Math.round).join(" ")})`;
/** Black or white, whichever has more contrast with a colour: WCAG 2.2. @param {[number, number, number]} colour */
export function ink(colour) {
  const [r, g, b] = colour.map((value) => {
    const part = value / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * r + 0.7152 * g + 0.0722 * b > 0.179 ? "#000" : "#fff";
}
