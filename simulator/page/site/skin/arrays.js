// Arrays of numbers as the page stores them.

/** @typedef {{type: string, base64: string}} Packed */

/** Numbers from base64; float48 lacks the lowest two bytes of a number. @param {Packed} packed @returns {Float64Array | Float32Array} */
export function unpacked(packed) {
  const bytes = Uint8Array.from(atob(packed.base64), (letter) => letter.charCodeAt(0));
  if (packed.type === "float32") return new Float32Array(bytes.buffer);
  const whole = new Uint8Array((bytes.length / 6) * 8);
  for (let k = 0; k < bytes.length; k++) whole[8 * Math.floor(k / 6) + (k % 6) + 2] = bytes[k];
  return new Float64Array(whole.buffer);
}

/** First row of the factors of each cell. @param {number[]} ranks */
export function startsOf(ranks) {
  const starts = [0];
  for (const rank of ranks) starts.push(starts[starts.length - 1] + rank);
  return starts;
}
