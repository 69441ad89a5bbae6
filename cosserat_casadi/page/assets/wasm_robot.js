// The robot solved in this page: the exported C library as WebAssembly, warm-started from where it was.

const CONVERGED = 0;
const UNKNOWN = 1; // Estimated error, over the length, that stands for one which is not known.

class WasmRobot {
  // packed: the module, compressed by gzip, in base64.
  static async open(facts, packed) {
    const bytes = Uint8Array.from(atob(packed), (character) => character.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    const module = await new Response(stream).arrayBuffer();
    const { instance } = await WebAssembly.instantiate(module, {});
    return new WasmRobot(facts, instance.exports);
  }

  constructor(facts, library) {
    this.facts = facts;
    this.library = library;
    this.atEquilibrium = false;
    const last = facts.layout[facts.layout.length - 1];
    this.drawnCount = last.first + last.rows * last.columns;
  }

  // A vector in the memory of the library.
  view(address, count) {
    return new Float64Array(this.library.memory.buffer, address, count);
  }

  // A sentence or a word of the library.
  string(address) {
    const bytes = new Uint8Array(this.library.memory.buffer);
    return new TextDecoder().decode(bytes.subarray(address, bytes.indexOf(0, address)));
  }

  // The equilibrium for these inputs: along the way from the last one, or anew where that leads nowhere.
  async move(inputs) {
    this.view(this.library.inputs(), inputs.length).set(inputs);
    let status = this.atEquilibrium ? this.library.track() : this.library.solve();
    const anew = this.atEquilibrium && status !== CONVERGED;
    if (anew) status = this.library.solve();
    return this.state(status, anew);
  }

  // The same from where a solve begins, whatever was before.
  async reset(inputs) {
    this.view(this.library.inputs(), inputs.length).set(inputs);
    return this.state(this.library.solve(), false);
  }

  state(status, anew) {
    this.atEquilibrium = status === CONVERGED;
    this.library.draw();
    return {
      found: this.atEquilibrium,
      label: this.string(this.library.label(status)),
      text: this.string(this.library.text(status)),
      anew,
      loadFactor: this.library.load_factor(),
      stays: Boolean(this.library.stays && this.library.stays()),
      iterations: this.library.iterations(),
      drawn: this.view(this.library.drawn(), this.drawnCount).slice(),
      contacts: this.contacts(),
    };
  }

  // Where rods or bodies touch obstacles exactly: points, the resultant on what touches, and both in words.
  contacts() {
    const { poses, obstacle_names: obstacles, along_line: alongLine } = this.facts;
    if (!obstacles) return [];
    let address = this.library.drawn() + 8 * this.drawnCount;
    return Array.from({ length: this.library.contacts() }, (_, number) => {
      const [owner, obstacle, isLine, from, to, ...force] = this.view(this.library.contact(number), 8);
      const count = isLine ? alongLine : 1;
      const entries = this.view(address, 3 * count);
      address += 24 * count;
      const points = Array.from({ length: count }, (_, k) => [...entries.slice(3 * k, 3 * k + 3)]);
      const { rod, body } = poses[owner];
      const along = isLine ? ` from X = ${brief(from, 3)} to ${brief(to, 3)}` : ` at X = ${brief(from, 3)}`;
      const newtons = brief(Math.hypot(...force), 3);
      const words = `${rod || body} touches ${obstacles[obstacle]}${body ? "" : along} with ${newtons} N`;
      return { points, force, words: words.replaceAll("_", " ") };
    });
  }

  // Derivatives of all poses by all inputs, [pose][input][7]; null where there are none.
  async derivatives() {
    if (!this.atEquilibrium || this.library.differentiate() !== CONVERGED) return null;
    const count = this.facts.poses.length * this.facts.sliders.length * 7;
    return this.view(this.library.d_poses(), count).slice();
  }

  // Eigenvalues of the second variation; null where stability has no meaning.
  async eigenvalues() {
    const allowed = this.facts.stability;
    if (!allowed || !this.atEquilibrium) return null;
    if (this.library.smallest_eigenvalue) {
      const smallest = this.library.smallest_eigenvalue();
      return Number.isNaN(smallest) ? null : [smallest];
    }
    this.library.linearise();
    const n = this.facts.unknowns;
    const entries = this.view(this.library.jacobian(), n * n);
    return secondVariation((i, j) => entries[i + n * j], allowed);
  }

  // The estimated error of the equilibrium in words, and whether it is within the tolerance; null where none has a meaning.
  async accuracy() {
    const { tolerance } = this.facts;
    const error = this.atEquilibrium && tolerance !== null ? this.library.error_estimate() : -1;
    if (error < 0) return { within: null, text: "", refines: false };
    const within = error <= tolerance;
    const size = error === UNKNOWN ? "The error is not known" : `Estimated error ${brief(Number(error.toPrecision(1)))} of the length`;
    const remedy = within ? "." : `; ${this.facts.remedy}`;
    return { within, text: `${size}, asked ${brief(tolerance)}${remedy}`, refines: false };
  }
}

// A number, of few digits where that is asked for; a small one with its power of ten.
function brief(number, digits) {
  const rounded = digits ? Number(number.toPrecision(digits)) : number;
  return rounded < 0.001 && rounded !== 0 ? rounded.toExponential() : String(rounded);
}

function openRobot(facts) {
  return WasmRobot.open(facts, document.getElementById("module").textContent);
}
