// Eigenvalues of the second variation for Jacobians read from a file: [{jacobian, allowed}, …] in, eigenvalues out.
const fs = require("fs");
const vm = require("vm");

const [assets, casesFile] = process.argv.slice(2);
vm.runInThisContext(fs.readFileSync(`${assets}/symmetric_eigenvalues.js`, "utf8"));
const cases = JSON.parse(fs.readFileSync(casesFile));
console.log(JSON.stringify(cases.map(({ jacobian, allowed }) => secondVariation((i, j) => jacobian[i][j], allowed))));
