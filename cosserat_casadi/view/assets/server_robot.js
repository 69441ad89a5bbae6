// The robot solved by the program that opened this page.

class ServerRobot {
  async ask(question, asked = {}) {
    // Relative: the path of the page holds the secret without which the program does not answer.
    const answer = await fetch(question, { method: "POST", body: JSON.stringify(asked) });
    if (!answer.ok) throw new Error(`the program answers ${answer.status}`);
    return answer.json();
  }

  async state(question, inputs) {
    const state = await this.ask(question, { inputs: [...inputs] });
    if (state.refused) return state;
    return { ...state, drawn: Float64Array.from(state.drawn, (value) => (value === null ? NaN : value)) };
  }

  move(inputs) {
    return this.state("move", inputs);
  }

  reset(inputs) {
    return this.state("reset", inputs);
  }

  async derivatives() {
    const numbers = await this.ask("derivatives");
    return numbers && Float64Array.from(numbers);
  }

  eigenvalues() {
    return this.ask("eigenvalues");
  }

  // The estimated error, and whether it is within the tolerance.
  accuracy() {
    return this.ask("accuracy");
  }

  // The same inputs on modes that are chosen for them.
  async refined(inputs) {
    const answer = await this.ask("refined", { inputs: [...inputs] });
    return { ...answer, drawn: answer.drawn && Float64Array.from(answer.drawn) };
  }

  // Inputs that bring a tip or a body to a point, as `inverse` finds them.
  reach(pose, position) {
    return this.ask("reach", { pose, position });
  }

  modes() {
    return this.ask("modes");
  }

  motion() {
    return this.ask("motion");
  }
}

async function openRobot() {
  return new ServerRobot();
}
