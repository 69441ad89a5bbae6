// The quality after each of a row of pictures: [milliseconds, …] in, [quality, …] out.
const fs = require("fs");
const vm = require("vm");

const [assets, timesFile] = process.argv.slice(2);
const Pace = vm.runInThisContext(`${fs.readFileSync(`${assets}/frame_pacing.js`, "utf8")}; Pace`);
const pace = new Pace();
const qualities = JSON.parse(fs.readFileSync(timesFile)).map((milliseconds) => {
  pace.took(milliseconds);
  return pace.quality;
});
console.log(JSON.stringify(qualities));
