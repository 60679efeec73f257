// Sweeps and potentials by the page's own modules: cases on standard input, answers on standard output.
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const { Skin } = await import(pathToFileURL(`${process.argv[2]}/skin.js`).href);
const { data, cases } = JSON.parse(readFileSync(0, "utf8"));
const skin = new Skin(data);

function answer({ touches: given, cast, at, byFinger }) {
  const touches = byFinger ? given.map((touch) => skin.byFinger(touch)) : given;
  const fingers = touches.map((touch) => touch.finger ?? 0);
  const Z = skin.responses(touches, cast).map((each) => skin.frequencies.map((_, k) => skin.impedance(each, k, cast)));
  if (at === undefined) return { Z };
  const { across } = skin.field(0, touches, at, cast);
  return { Z, fingers, across: { re: [...across.re], im: [...across.im] } };
}

console.log(JSON.stringify(cases.map(answer)));
