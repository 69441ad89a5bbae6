// Sliders, words and switches of a page, and the object `robot` that scripts talk to.

const REST = 90; // Milliseconds without a new input after which stability is asked for.

class Panel {
  constructor(facts, robot, scenery) {
    this.facts = facts;
    this.robot = robot;
    this.scenery = scenery;
    this.inputs = Float64Array.from(facts.sliders, (slider) => slider.value);
    this.wanted = null;
    this.state = null;
    this.eigenvalues = null;
    // What a robot with a platform moves is the platform.
    this.point = Math.max(facts.poses.findIndex((pose) => pose.body && !pose.unlisted), 0);
    this.rows = [];
    this.waiting = [];
    // Told of every equilibrium that is shown.
    this.listeners = [];
    // Told when sliders, scripts or the button of the scene's own inputs move the robot: nothing leads it elsewhere then.
    this.interrupted = [];
    this.buildSliders();
    this.buildLayers();
    document.getElementById("reset").onclick = () => this.reset();
    document.getElementById("fit").onclick = () => this.scenery.lookAtAll();
    document.getElementById("save").onclick = () => this.scenery.save();
    document.getElementById("scale").textContent = `grid ${quantity(scenery.cell, "m")}`;
    document.getElementById("note").textContent = facts.note || "";
    scenery.controls.addEventListener("change", () => this.placeLabels());
  }

  buildSliders() {
    const form = document.getElementById("sliders");
    form.onsubmit = (event) => event.preventDefault();
    let group = null;
    let last = "";
    this.facts.sliders.forEach((slider, i) => {
      if (slider.input !== last) {
        group = element("fieldset", form);
        const legend = element("legend", group);
        const owner = slider.input.slice(0, slider.input.indexOf("."));
        const colour = this.colourOf(owner);
        if (colour) element("i", legend).style.background = colour;
        legend.append(slider.input.replaceAll("_", " ").replace(".", ": "));
        element("small", legend).textContent = slider.unit === "1" ? "" : slider.unit;
        last = slider.input;
      }
      this.rows.push(this.sliderRow(group, slider, i));
    });
  }

  colourOf(owner) {
    const actuator = this.facts.actuators[owner];
    if (actuator) return actuator.colour;
    const arrows = this.facts.layout.find((entry) => entry.kind === "arrows" && entry.name === owner);
    if (arrows) return this.facts.colours[arrows.sort];
    return this.facts.rods[owner] ? this.facts.rods[owner].colour : null;
  }

  sliderRow(group, slider, i) {
    const row = element("div", group);
    row.className = slider.label ? "slider" : "slider alone";
    const name = `${slider.input} ${slider.label}`.trim();
    if (slider.label) element("label", row).textContent = slider.label;
    const range = element("input", row);
    Object.assign(range, { type: "range", min: slider.least, max: slider.most, step: "any" });
    range.setAttribute("aria-label", `${name}, ${slider.unit}`);
    const number = element("input", row);
    Object.assign(number, { type: "number", step: "any" });
    number.setAttribute("aria-label", `${name} in ${slider.unit}, as a number`);
    const derivative = element("output", row);
    range.oninput = () => this.moveTo(i, range.valueAsNumber);
    number.onchange = () => Number.isFinite(number.valueAsNumber) && this.moveTo(i, number.valueAsNumber);
    const show = (value) => {
      range.value = value;
      if (document.activeElement !== number) number.value = Number(value.toPrecision(5));
    };
    show(slider.value);
    return { show, derivative };
  }

  buildLayers() {
    const field = document.getElementById("layers");
    const layer = (words, checked, change) => {
      const label = element("label", field);
      const box = element("input", label);
      Object.assign(box, { type: "checkbox", checked, onchange: () => change(box.checked) });
      label.append(words);
      return box;
    };
    layer("unloaded shape", true, (on) => this.scenery.show("unloaded", on));
    layer("section axes", true, (on) => this.scenery.show("sections", on));
    layer("loads", true, (on) => this.scenery.show("loads", on));
    this.derivativesBox = layer("derivatives", false, () => this.showDerivatives());
    if (this.facts.obstacles.length) layer("obstacles", true, (on) => this.scenery.show("obstacles", on));
    if (!this.facts.sliders.length || !this.facts.derivatives) this.derivativesBox.parentElement.remove();
    if (this.facts.poses.length > 1) {
      const label = element("label", field);
      label.append("of ");
      const choice = element("select", label);
      this.facts.poses.forEach((pose, i) => {
        if (!pose.unlisted) choice.add(new Option(nameOf(pose), i, false, i === this.point));
      });
      choice.onchange = () => {
        this.point = Number(choice.value);
        this.showReadings();
        this.showDerivatives();
        this.listeners.forEach((listener) => listener());
      };
    }
  }

  moveTo(i, value) {
    const inputs = Float64Array.from(this.wanted || this.inputs);
    inputs[i] = value;
    return this.ask(inputs);
  }

  // Go to inputs and stay there, whatever led the robot before.
  ask(inputs) {
    this.interrupted.forEach((stop) => stop());
    return this.solve(inputs);
  }

  // Ask for an equilibrium; of many wishes that come while one is solved only the last counts.
  solve(inputs) {
    this.wanted = inputs;
    inputs.forEach((value, i) => this.rows[i].show(value));
    const promise = new Promise((resolve) => this.waiting.push(resolve));
    if (!this.busy) this.busy = this.work();
    return promise;
  }

  async work() {
    while (this.wanted) {
      const inputs = this.wanted;
      const waiting = this.waiting.splice(0);
      this.wanted = null;
      try {
        const state = await this.robot.move(inputs);
        if (state.refused) this.say("✕ Refused", state.refused);
        else this.accept(inputs, state);
      } catch (error) {
        this.say("✕ Nobody answers", `The program that solves has ended, or failed: ${error.message}.`);
      }
      waiting.forEach((resolve) => resolve(this.state));
      await new Promise(requestAnimationFrame);
    }
    // A wish that the scene's own inputs have replaced is answered by those.
    this.waiting.splice(0).forEach((resolve) => resolve(this.state));
    this.busy = null;
  }

  accept(inputs, state) {
    this.inputs = inputs;
    this.state = state;
    this.eigenvalues = null;
    this.accuracy = null;
    this.scenery.draw(state.drawn, state.found, state.contacts);
    this.showStatus();
    this.showReadings();
    this.showDerivatives();
    clearTimeout(this.rest);
    this.rest = setTimeout(() => this.judge(), REST);
    this.listeners.forEach((listener) => listener());
  }

  // An equilibrium that someone else has found, with its inputs.
  receive(answer) {
    if (answer.refused) return this.say("✕ Refused", answer.refused);
    const inputs = Float64Array.from(answer.inputs);
    inputs.forEach((value, i) => this.rows[i].show(value));
    return this.accept(inputs, { ...answer, drawn: Float64Array.from(answer.drawn) });
  }

  async judge() {
    const state = this.state;
    const eigenvalues = await this.robot.eigenvalues();
    if (state !== this.state) return;
    this.eigenvalues = eigenvalues;
    this.showVerdict();
    const accuracy = await this.robot.accuracy(this.inputs);
    if (state !== this.state) return;
    this.accuracy = accuracy;
    this.showVerdict();
    if (accuracy.refines) await this.refine(state);
  }

  // Draw the equilibrium on modes that are chosen for the inputs at which the hand rests.
  async refine(state) {
    const refined = await this.robot.refined(this.inputs);
    if (state !== this.state || !refined.drawn) return;
    state.drawn = refined.drawn;
    this.accuracy = refined;
    if (this.elsewhere) return;
    this.scenery.draw(state.drawn, state.found, state.contacts);
    this.showReadings();
    this.showStatus();
  }

  // The verdict waits while something else is said, as of a motion that is played.
  showVerdict() {
    if (!this.elsewhere) this.showStatus();
  }

  async reset() {
    this.interrupted.forEach((stop) => stop());
    const inputs = Float64Array.from(this.facts.sliders, (slider) => slider.value);
    inputs.forEach((value, i) => this.rows[i].show(value));
    this.wanted = null;
    this.accept(inputs, await this.robot.reset(inputs));
  }

  // Outcome and stability, in words and in colour.
  get verdict() {
    const { found, text, anew, loadFactor, stays } = this.state;
    if (!found) {
      const share = loadFactor < 1 ? ` Drawn faintly: the last equilibrium, at ${(100 * loadFactor).toPrecision(2)} % of the load.` : "";
      const last = stays ? " Drawn faintly: the last equilibrium." : "";
      return ["bad", "✕ No equilibrium shown", text + share + last];
    }
    const beginning = this.facts.beginning || "the unloaded one";
    const jump = anew ? ` The robot could not be followed here: it has jumped, and was solved anew from ${beginning}.` : "";
    if (this.state.met === false) return ["warn", "✓ In equilibrium, the point is not reached", text];
    const steps = `${this.state.iterations} Newton ${this.state.iterations === 1 ? "step" : "steps"}.`;
    const rough = this.accuracy && this.accuracy.within === false;
    const accuracy = this.accuracy && this.accuracy.text ? ` ${this.accuracy.text}` : "";
    const kind = anew || rough ? "warn" : "good";
    const missed = rough ? ", beyond the tolerance" : "";
    if (!this.eigenvalues) return [kind, `${rough ? "!" : "✓"} In equilibrium${missed}`, `${text}${accuracy}${jump} ${steps}`];
    const rounding = 1e-10 * Math.max(1, ...this.eigenvalues.map(Math.abs));
    const negative = this.eigenvalues.some((value) => value < -rounding);
    const zero = this.eigenvalues.some((value) => Math.abs(value) <= rounding);
    if (negative) return ["warn", "! In equilibrium, but not stable", `A real robot leaves it at the slightest push: some variation releases energy.${accuracy}${jump}`];
    if (zero) return ["warn", "~ In equilibrium, neutral", `Some variation costs no energy.${accuracy}${jump}`];
    return [kind, `${rough ? "!" : "✓"} In equilibrium, stable${missed}`, `${text}${accuracy}${jump} ${steps}`];
  }

  showStatus() {
    const [kind, head, words] = this.verdict;
    this.say(head, words, kind);
    this.elsewhere = false;
  }

  // Say something that is not the verdict on the equilibrium.
  say(head, words, kind = "warn") {
    this.elsewhere = true;
    const box = document.getElementById("status");
    box.className = kind;
    // A screen reader hears only what is new.
    if (box.firstChild.textContent !== head) box.firstChild.textContent = head;
    box.lastChild.textContent = words;
  }

  showReadings() {
    const { position } = this.pose(this.point);
    const [factor, unit] = this.lengths;
    const numbers = [...position].map((value) => (factor * value).toFixed(2).replace(/^-(0\.00)$/, "$1")).join(", ");
    const contacts = (this.state.contacts || []).map(({ words }) => words);
    const readings = [`${nameOf(this.facts.poses[this.point])} at (${numbers}) ${unit}`, ...contacts];
    document.getElementById("readings").replaceChildren(...readings.flatMap((words) => [words, document.createElement("br")]));
  }

  // What lengths are written in.
  get lengths() {
    return this.scenery.size < 10 ? [1000, "mm"] : [1, "m"];
  }

  async showDerivatives() {
    if (!this.derivativesBox.checked) return this.clearDerivatives();
    const state = this.state;
    const all = await this.robot.derivatives();
    if (state !== this.state) return undefined;
    if (!all) return this.clearDerivatives();
    const count = this.facts.sliders.length;
    const columns = this.facts.sliders.map((_, i) => [...all.subarray(7 * (count * this.point + i), 7 * (count * this.point + i) + 3)]);
    columns.forEach((column, i) => {
      const unit = this.facts.sliders[i].unit;
      const [factor, length] = this.lengths;
      const size = Number((factor * Math.hypot(...column)).toPrecision(3));
      this.rows[i].derivative.textContent = `moves it ${size} ${length} per ${unit === "1" ? "unit" : unit}`;
    });
    this.scenery.drawDerivatives(this.pose(this.point).position, columns);
    this.placeLabels();
    return undefined;
  }

  clearDerivatives() {
    for (const row of this.rows) row.derivative.textContent = "";
    this.scenery.drawDerivatives(null, null);
    this.placeLabels();
  }

  // Names beside the ends of the derivatives' arrows.
  placeLabels() {
    const box = document.getElementById("labels");
    box.textContent = "";
    if (!this.scenery.layers.derivatives.visible) return;
    const taken = [];
    for (const { end, i } of this.scenery.derivativeEnds()) {
      // A name that would cover another is left out.
      if (taken.some((other) => Math.abs(other.x - end.x) < 110 && Math.abs(other.y - end.y) < 20)) continue;
      taken.push(end);
      const { input, label } = this.facts.sliders[i];
      const span = element("span", box);
      span.textContent = `${input.replaceAll("_", " ").replace(".", ": ")} ${label}`.trim();
      span.style.left = `${end.x}px`;
      span.style.top = `${end.y}px`;
    }
  }

  // Position and quaternion of a tip or a body, as they are drawn.
  pose(index) {
    const { rod, body } = this.facts.poses[index];
    const entry = this.facts.layout.find((part) => part.kind === (rod ? "rod" : "body") && part.name === (rod || body));
    const last = entry.first + 7 * (entry.columns - 1);
    return { position: this.state.drawn.slice(last, last + 3), quaternion: this.state.drawn.slice(last + 3, last + 7) };
  }

  // What scripts may do: move inputs by name, read poses and the words of the status.
  get api() {
    const panel = this;
    return {
      get inputs() {
        return Object.fromEntries(panel.facts.sliders.map((slider, i) => [fullName(slider), panel.inputs[i]]));
      },
      get status() {
        return document.getElementById("status").textContent;
      },
      get state() {
        return panel.state;
      },
      get stable() {
        return panel.eigenvalues && panel.eigenvalues.every((value) => value >= -1e-10 * Math.max(1, ...panel.eigenvalues.map(Math.abs)));
      },
      // A number, or a list for a vector: setInput("payload.force", [0, 0, -1]), setInput("payload.force.z", -1).
      setInput(name, value) {
        const inputs = Float64Array.from(panel.wanted || panel.inputs);
        const chosen = panel.facts.sliders.map((slider, i) => [slider, i]).filter(([slider]) => slider.input === name || fullName(slider) === name);
        const values = [value].flat();
        if (chosen.length !== values.length) throw new Error(`${name} has ${chosen.length} numbers, got ${values.length}`);
        chosen.forEach(([slider], k) => (inputs[slider.index] = values[k]));
        return panel.ask(inputs);
      },
      tip(name) {
        const index = panel.facts.poses.findIndex((pose) => name === undefined || pose.rod === name || pose.body === name);
        return [...panel.pose(index).position];
      },
      reset: () => panel.reset(),
      redraw: () => panel.scenery.painter.paintStill(),
    };
  }
}

function fullName(slider) {
  return slider.label ? `${slider.input}.${slider.label}` : slider.input;
}

function nameOf(pose) {
  return pose.rod ? `tip of ${pose.rod.replaceAll("_", " ")}` : pose.body.replaceAll("_", " ");
}

function element(tag, parent) {
  return parent.appendChild(document.createElement(tag));
}

// A length with a prefix that suits it.
function quantity(value, unit) {
  const prefixes = [[1, ""], [1e-3, "m"], [1e-6, "µ"]];
  const [factor, prefix] = prefixes.find(([factor]) => value >= 0.9999 * factor) || [1e-6, "µ"];
  return `${Number((value / factor).toPrecision(4))} ${prefix}${unit}`;
}
