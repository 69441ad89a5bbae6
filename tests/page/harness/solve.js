// Solves a list of inputs, one after the other, in node as a page does: facts.json inputs.json module.wasm.
const fs = require("fs");
const vm = require("vm");

const [assets, factsFile, inputsFile, moduleFile] = process.argv.slice(2);
for (const script of ["symmetric_eigenvalues.js", "wasm_robot.js"]) vm.runInThisContext(fs.readFileSync(`${assets}/${script}`, "utf8"));
const facts = JSON.parse(fs.readFileSync(factsFile));
const cases = JSON.parse(fs.readFileSync(inputsFile));

async function main() {
  const bytes = fs.readFileSync(moduleFile);
  const { instance, module } = await WebAssembly.instantiate(bytes, {});
  const robot = vm.runInThisContext("(facts, library) => new WasmRobot(facts, library)")(facts, instance.exports);
  const solved = [];
  for (const inputs of cases) {
    const state = await robot.move(inputs);
    const derivatives = await robot.derivatives();
    solved.push({
      ...state,
      drawn: [...state.drawn],
      x: instance.exports.x ? [...robot.view(instance.exports.x(), facts.unknowns)] : null,
      derivatives: derivatives && [...derivatives],
      eigenvalues: await robot.eigenvalues(),
    });
  }
  console.log(JSON.stringify({ imports: WebAssembly.Module.imports(module), solved }));
}

main();
